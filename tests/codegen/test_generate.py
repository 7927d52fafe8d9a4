"""Writing `generated/`, and the check that it is what would be written."""

from __future__ import annotations

import pytest

from gridgen_sym.codegen import generate
from gridgen_sym.codegen.generate import SHARED, check_generated, write_generated
from gridgen_sym.codegen.source import Source
from gridgen_sym.resources import resource_folder

# ---- all of generated/: that it is what is derived now, `generate --check` tells, with a hash seed of its own ----

#: Lines of all files, of the largest kernel in one language, and of what its kernels share.
MOST_LINES, MOST_OF_A_KERNEL, MOST_SHARED = 16_000, 550, 1600


def test_generated_files_stay_small():
    """What is the same in all kernels is written once, so that a new functional adds its arithmetic and little else."""
    folder = resource_folder("generated")
    lines = {
        path.relative_to(folder).as_posix(): len(path.read_text(encoding="utf-8").splitlines())
        for path in folder.rglob("*.*")
        if "__pycache__" not in path.parts
    }
    assert sum(lines.values()) <= MOST_LINES
    assert max(lines[path] for path in SHARED) <= MOST_SHARED
    assert {path: count for path, count in lines.items() if path not in SHARED and count > MOST_OF_A_KERNEL} == {}


# ---- the files ----


@pytest.fixture
def few_functionals(monkeypatch):
    """Derive only two functionals, and no documents: what is tested here is the files."""
    monkeypatch.setattr(generate, "functionals", lambda **_: ("length", "area"))
    monkeypatch.setattr(generate, "state", lambda: Source("derived_from.txt", "key\n"))
    monkeypatch.setattr(
        generate,
        "render_document",
        lambda functional, equations: Source(f"docs/{functional.name}.md", f"# {functional.name}\n"),
    )


@pytest.fixture
def written(tmp_path, few_functionals):
    changed = write_generated(tmp_path)
    assert {path.relative_to(tmp_path).as_posix() for path in changed} == {
        "c/common.h", "c/loops.h", "numpy/loops.py",
        "c/length.c", "c/area.c", "c/area_frozen.c", "c/area_differentiated.c",
        "numpy/length.py", "numpy/area.py", "numpy/area_frozen.py", "numpy/area_differentiated.py",
        "facts/length.json", "facts/area.json", "facts/area_frozen.json", "facts/area_differentiated.json",
        "docs/length.md", "docs/area.md", "derived_from.txt",
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
    path.write_text(text.replace("corner_energy", "corner_enemy"))
    difference = check_generated(written)
    assert "--- generated/c/length.c (committed)\n+++ generated/c/length.c (derived now)\n" in difference
    assert any(line.startswith("-") and "corner_enemy" in line for line in difference.splitlines())
    assert any(line.startswith("+") and "corner_energy" in line for line in difference.splitlines())
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


@pytest.mark.slow
@pytest.mark.parametrize("name", ["c/gone.c", "c/gone.h", "numpy/gone.py", "facts/gone.json", "docs/gone.md"])
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
