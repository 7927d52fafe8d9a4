"""Every script of `examples/` runs, from a folder of its own; each asserts what it claims."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

SCRIPTS = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))


def test_there_are_examples():
    assert len(SCRIPTS) >= 10


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
@pytest.mark.usefixtures("clean_registry")
def test_an_example_runs(script, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    text = script.read_text(encoding="utf-8")
    assert "assert " in text
    if "import skfem" in text:
        pytest.importorskip("skfem")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    written = {path.suffix for path in tmp_path.iterdir()}
    assert written <= {".vts", ".xyz", ".png"}


README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def blocks(language):
    """Return the fenced blocks of the README in a language."""
    parts = README.split("```")[1::2]
    return [part.removeprefix(f"{language}\n") for part in parts if part.startswith(f"{language}\n")]


@pytest.mark.usefixtures("clean_registry")
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
        assert f"| `gridgen-sym {name}" in README


def test_the_readmes_two_command_lines_are_single_lines():
    install, test = (text.strip() for text in blocks("") if "python3 -m venv" in text)
    assert len(install.splitlines()) == len(test.splitlines()) == 1
    assert "gridgen-sym grid examples/outlines/texas.csv" in install
    assert test.endswith(".venv/bin/pytest")
    assert README.index("<!-- test command -->") < README.index(test)
