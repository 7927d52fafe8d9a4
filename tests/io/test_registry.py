"""The registry of formats: what a format says of itself holds, and every file is a grid or one clear error."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from derived_pages.files_page import with_table

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.io import formats, holds_grid, known_formats, known_suffixes
from gridgen_sym.io.format import Format

FORMATS = known_formats()
ROOT = Path(__file__).parents[2]
#: A format whose package is not one of the tests' own is tried with the extras.
PARAMETERS = {
    name: pytest.param(name, marks=pytest.mark.extras if form.extra and form.extra[0] != "io" else ())
    for name, form in FORMATS.items()
}
each_format = pytest.mark.parametrize("name", PARAMETERS.values())
SWAN = gg.domain("swan", 5, 4)
AWAY = gg.Grid.from_planes(*(gg.domain("square", 4, 4).planes + 10))
TWO = gg.MultiBlock({"a": SWAN, "b": AWAY}, [], boundaries={"wall": [("a", "bottom", (1, 3))]})


@each_format
def test_what_a_format_says_of_itself(name):
    form = FORMATS[name]
    assert isinstance(form, Format)
    assert form.decode or form.encode
    assert all(re.fullmatch(r"\.[a-z0-9]+", suffix) for suffix in form.suffixes)
    file, _, test = form.test.partition("::")
    assert f"def {test}(" in (ROOT / file).read_text()


def test_every_file_in_the_folder_is_a_format():
    files = {path.stem for path in Path(formats.__file__).parent.glob("*.py")} - {"__init__"}
    assert {*FORMATS} == files
    assert {".vts", ".xyz", ".p2dfmt", ".csv", ".npz", ".cgns", ".vtm"} <= {*known_suffixes()}


@pytest.mark.parametrize("name", [PARAMETERS[name] for name, form in FORMATS.items() if form.encode and form.decode])
def test_what_is_written_is_read(tmp_path, name):
    form = FORMATS[name]
    for suffix in form.suffixes:
        path = tmp_path / f"grid{suffix.upper()}"
        gg.write(SWAN, path, form=name)
        assert gg.read(path, form=name) == SWAN
        if form.several:
            gg.write(TWO, path, form=name)
            back = gg.read(path, form=name)
            assert back == TWO
            assert (tmp_path / "grid.nmf").exists() is not form.names
        else:
            with pytest.raises(gg.GridgenError, match="holds one block, and here are 2; use one of"):
                gg.write(TWO, path, form=name)


def test_a_format_is_found_by_listing(tmp_path, monkeypatch):
    """A file that is put there is read and written, is in the list, and its errors name the path."""
    (tmp_path / "formats").mkdir()
    (tmp_path / "formats" / "reversed.py").write_text(
        "import io\n"
        "from gridgen_sym.io.format import Format\n"
        "from gridgen_sym.io.formats import table\n"
        "decode = lambda data: table.decode(io.BytesIO(data[::-1]))\n"
        "encode = lambda grid: b''.join(table.encode(grid))[::-1]\n"
        "FORMAT = Format(name='reversed table', suffixes=('.vsc',), decode=decode, encode=encode)\n"
    )
    monkeypatch.setattr(formats, "__path__", [*formats.__path__, str(tmp_path / "formats")])
    monkeypatch.setattr("gridgen_sym.io.registry.known_formats", known_formats.__wrapped__)
    monkeypatch.setattr("gridgen_sym.io.known_formats", known_formats.__wrapped__)
    gg.write(SWAN, tmp_path / "grid.vsc")
    assert (tmp_path / "grid.vsc").read_bytes().endswith(b"y,x,j,i")
    assert gg.read(tmp_path / "grid.vsc") == SWAN
    assert "reversed: reversed table" in CliRunner().invoke(main, ["formats"]).output
    (tmp_path / "grid.vsc").write_bytes(b"y,x,j")
    with pytest.raises(gg.GridgenError, match=r"cannot read .*grid\.vsc as a reversed table: line 1 is 'j,x,y'"):
        gg.read(tmp_path / "grid.vsc")


def test_forms_select_formats_and_variants(tmp_path):
    gg.write(SWAN, tmp_path / "grid.old", form="plot3d")
    assert gg.read(tmp_path / "grid.old", form="plot3d") == SWAN
    with pytest.raises(gg.GridgenError, match=r"the suffix '\.old' is unknown; use one of"):
        gg.read(tmp_path / "grid.old")
    with pytest.raises(gg.GridgenError, match="a file has one format; came vts and npz"):
        gg.read(tmp_path / "grid.old", form="vts npz")
    with pytest.raises(gg.GridgenError, match="unknown form 'big' of a NumPy archive: its forms are none; formats are"):
        gg.write(SWAN, tmp_path / "grid.npz", form="big")


def test_one_suffix_may_be_that_of_several_formats(tmp_path, monkeypatch):
    """The first writes; what recognizes a file reads it."""

    def made(word):
        return Format(
            name=f"file of {word}", suffixes=(".two",), decode=lambda data: SWAN if data.startswith(word) else None,
            encode=lambda grid: word, recognizes=lambda start: start.startswith(word),
        )  # fmt: skip

    monkeypatch.setattr("gridgen_sym.io.registry.known_formats", lambda: {w: made(w.encode()) for w in ("one", "two")})
    gg.write(SWAN, tmp_path / "grid.two")
    assert (tmp_path / "grid.two").read_bytes() == b"one"
    gg.write(SWAN, tmp_path / "grid.two", form="two")
    assert gg.read(tmp_path / "grid.two") == SWAN
    assert holds_grid(tmp_path / "grid.two")
    (tmp_path / "grid.two").write_bytes(b"points of an outline")
    assert not holds_grid(tmp_path / "grid.two")


def test_the_page_of_files_has_the_table_of_formats():
    page = (ROOT / "docs" / "reference" / "files.md").read_text(encoding="utf-8")
    assert page == with_table(page), "run: python docs/_ext/derived_pages/files_page.py"
    assert all(f"`{suffix}`" in page for suffix in (*known_suffixes(), *known_suffixes(written=True)))


def test_convert_and_the_list(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    TWO.write("two.xyz")
    done = CliRunner().invoke(main, ["convert", "two.xyz", "two.vtm"])
    assert done.exit_code == 0
    assert done.output.endswith("wrote two.vtm: 2 blocks of 5 x 4, 4 x 4 nodes\n")
    assert gg.read("two.vtm") == TWO
    assert CliRunner().invoke(main, ["convert", "two.xyz", "two.any", "--to", "p3d"]).exit_code == 2
    done = CliRunner().invoke(main, ["convert", "two.xyz", "two.csv"])
    assert done.exit_code == 2
    assert "holds one block, and here are 2" in done.output
    listed = CliRunner().invoke(main, ["formats"]).output
    assert all(f"{name}: {form.name}" in listed for name, form in FORMATS.items())
