"""The page on adaptation: its Python runs, and its tables of monitors and of laws name what there is."""

from __future__ import annotations

import re
from pathlib import Path

from gridgen_sym.adaptation.monitor import _MEASURES

PAGE = (Path(__file__).parents[2] / "docs" / "adaptation.md").read_text(encoding="utf-8")


def test_its_python_runs():
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(blocks) == 4
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "adaptation.md", "exec"), names)
    assert names["on_the_start"].shape == (33, 33)


def test_it_has_every_monitor():
    rows = re.findall(r"^\| `(\w+)`( \(default\))? \|", PAGE, re.MULTILINE)
    assert [name for name, _ in rows] == list(_MEASURES)
    assert [name for name, default in rows if default] == ["curvature"]
