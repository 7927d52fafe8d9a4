"""Turn generated NumPy into callable functions."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ...codegen.backend import Function
from ...codegen.facts import KernelFacts
from ...resources import resource_folder


def load(facts: KernelFacts, source: str) -> Mapping[str, Function]:
    """Return the loops of `loops.py`, bound to the arithmetic of one functional."""
    arithmetic = SimpleNamespace(facts=facts, **load_module(f"{facts.name}.py", source))
    loops = _loops(resource_folder("generated") / "numpy" / "loops.py")
    return {name: partial(loops[name], arithmetic) for name in facts.functions}


def load_module(path: Path | str, text: str) -> dict[str, Any]:
    """Return the names of a generated NumPy module; it is run from its text, so nothing is written beside it."""
    names: dict[str, Any] = {"__name__": "gridgen_sym_generated", "__file__": str(path)}
    exec(compile(text, str(path), "exec"), names)
    return {name: value for name, value in names.items() if not name.startswith("__")}


@lru_cache(maxsize=1)
def _loops(path: Path) -> dict[str, Any]:
    return load_module(path, path.read_text(encoding="utf-8"))
