"""The scripts of `examples/`: the gallery of the documentation runs each; here those whose output a page shows."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

SCRIPTS = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))

PAGE = (Path(__file__).parent.parent / "docs" / "adaptation.md").read_text(encoding="utf-8")
#: What the page on adaptation says that scripts print.
TABLES = dict(re.findall(r"```bash\npython examples/(\S+)\n```\n\n```\n(.*?)```", PAGE, re.DOTALL))
#: The others take longer, and print with the same functions; the gallery runs them all.
QUICK = {"plot_adapt_1_functions.py", "plot_adapt_3_terrain.py"}


def assert_alike(printed, told):
    """Compare lines: words must be the same, numbers may differ by a fifth, as they do from machine to machine."""
    assert len(printed) == len(told)
    for line, expected in zip(printed, told, strict=True):
        words, others = line.split(), expected.split()
        assert len(words) == len(others), f"{line!r} is not {expected!r}"
        for word, other in zip(words, others, strict=True):
            number = re.fullmatch(r"\d+\.\d+(e[+-]\d+)?", other)
            same = float(word) == pytest.approx(float(other), rel=0.2) if number else word == other or other.isdigit()
            assert same, f"{line!r} is not {expected!r}"


def test_there_are_examples_and_each_asserts_what_it_claims():
    assert len(SCRIPTS) >= 15
    assert [one.name for one in SCRIPTS if "assert " not in one.read_text(encoding="utf-8")] == []
    assert len(TABLES) == 3


def test_a_table_that_differs_is_noticed():
    assert_alike(["a 1.10e-02 7"], ["a 1.00e-02 8"])
    for wrong in (["a 1.30e-02 8"], ["b 1.00e-02 8"], ["a 1.00e-02"], []):
        with pytest.raises(AssertionError):
            assert_alike(wrong, ["a 1.00e-02 8"])


@pytest.mark.slow
@pytest.mark.parametrize("script", [one for one in SCRIPTS if one.name in QUICK], ids=lambda script: script.stem)
def test_an_example_prints_what_its_page_says(script, tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    if "import skfem" in script.read_text(encoding="utf-8"):
        pytest.importorskip("skfem")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    written = {path.suffix for path in tmp_path.iterdir()}
    assert written <= {".vts", ".xyz", ".png"}
    assert_alike(capsys.readouterr().out.splitlines(), TABLES[script.name].splitlines())


README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def blocks(language):
    """Return the fenced blocks of the README in a language."""
    parts = README.split("```")[1::2]
    return [part.removeprefix(f"{language}\n") for part in parts if part.startswith(f"{language}\n")]


def test_the_readmes_python_runs(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    ten_lines, own = blocks("python")
    assert max(len(text.strip().splitlines()) for text in (ten_lines, own)) <= 10
    for text in (ten_lines, own):
        exec(compile(text, "README.md", "exec"), {})
    assert (tmp_path / "swan.vts").exists()


def test_the_readme_names_every_command():
    from gridgen_sym.cli import main

    for name in main.commands:
        assert f"gridgen-sym {name}" in README


def test_the_readmes_two_command_lines_are_single_lines():
    install, test = (text.strip() for text in blocks("") if "python3 -m venv" in text)
    assert len(install.splitlines()) == len(test.splitlines()) == 1
    assert "gridgen-sym grid examples/outlines/texas.csv" in install
    assert test.endswith(".venv/bin/pytest -n auto")
    assert README.index("<!-- test command -->") < README.index(test)
