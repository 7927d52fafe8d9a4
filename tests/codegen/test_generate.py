"""Writing `generated/`, and the check that it is what would be written."""

from __future__ import annotations

import pytest

from gridgen_sym.codegen import generate
from gridgen_sym.codegen.generate import check_generated, write_generated
from gridgen_sym.codegen.kernel import Source


@pytest.fixture(autouse=True)
def few_functionals(monkeypatch):
    """Derive only two functionals, and no documents: what is tested here is the files."""
    monkeypatch.setattr(generate, "functionals", lambda: ("length", "area"))
    monkeypatch.setattr(
        generate, "render_document", lambda functional: Source(f"docs/{functional.name}.md", f"# {functional.name}\n")
    )


@pytest.fixture
def written(tmp_path):
    changed = write_generated(tmp_path)
    assert {path.relative_to(tmp_path).as_posix() for path in changed} == {
        "c/length.c", "c/area.c", "c/area_frozen.c", "c/area_differentiated.c",
        "numpy/length.py", "numpy/area.py", "numpy/area_frozen.py", "numpy/area_differentiated.py",
        "docs/length.md", "docs/area.md",
    }  # fmt: skip
    return tmp_path


def test_a_folder_just_written_passes_and_is_not_written_again(written):
    assert check_generated(written) == ""
    times = {path: path.stat().st_mtime_ns for path in written.rglob("*.*")}
    assert write_generated(written) == []
    assert times == {path: path.stat().st_mtime_ns for path in written.rglob("*.*")}


def test_an_edited_file_is_shown_as_a_diff_and_written_again(written):
    path = written / "c" / "length.c"
    text = path.read_text()
    path.write_text(text.replace("length_energy", "length_enemy"))
    difference = check_generated(written)
    assert "--- generated/c/length.c (committed)\n+++ generated/c/length.c (derived now)\n" in difference
    assert any(line.startswith("-") and "length_enemy" in line for line in difference.splitlines())
    assert any(line.startswith("+") and "length_energy" in line for line in difference.splitlines())
    assert "area" not in difference
    assert write_generated(written) == [path]
    assert path.read_text() == text


def test_a_missing_file_is_shown_as_a_diff_and_written_again(written):
    path = written / "numpy" / "area.py"
    path.unlink()
    difference = check_generated(written)
    assert "+++ generated/numpy/area.py (derived now)" in difference
    assert not [line for line in difference.splitlines() if line.startswith("-") and not line.startswith("---")]
    assert write_generated(written) == [path]


@pytest.mark.parametrize("name", ["c/long_gone.c", "numpy/long_gone.py", "docs/long_gone.md"])
def test_a_stale_file_is_shown_as_a_diff_and_removed(written, name):
    path = written / name
    path.write_text("once\n")
    difference = check_generated(written)
    assert f"--- generated/{name} (committed)" in difference
    assert "-once" in difference
    assert write_generated(written) == [path]
    assert not path.exists()
    assert check_generated(written) == ""


def test_a_readme_is_kept(written):
    path = written / "c" / "README.md"
    path.write_text("written by hand\n")
    assert check_generated(written) == ""
    assert write_generated(written) == []
    assert path.exists()
