"""Files of several blocks: PLOT3D and VTK, and the neutral map files beside them."""

from __future__ import annotations

import io
import itertools

import numpy as np
import pytest
from click.testing import CliRunner
from layouts import butterfly, cut, kinks, ring
from support import NO_SHARED, SHARED

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.io.format import Blocks
from gridgen_sym.io.formats import plot3d
from gridgen_sym.io.plot3d_writing import written

NASA = SHARED / "nasa"
FILES = sorted(NASA.glob("*.p2dfmt"))
SQUARE = gg.domain("square", 5, 7)
SIDES = ("bottom", "right", "top", "left")
SEVERAL = [".xyz", ".p2dfmt", ".vtm"]
#: Every part of a side, connected and named, of a block with a second one that is turned by a quarter.
NAMES = {"wall": [(0, "bottom", (0, 2)), (0, "left")], "far field": [(0, "bottom", (2, 4)), (1, "top")]}


def encoded(*blocks, words=()):
    return b"".join(written(Blocks(blocks), words))


def decoded(data):
    return plot3d.decode(io.BytesIO(data))


def turned():
    """Two blocks, the second of which lies with its bottom at the right of the first; swapped in the file."""
    right = np.array(SQUARE.planes)
    right[0] += 1
    second = np.ascontiguousarray(right.transpose(0, 2, 1)[:, ::-1])
    return gg.MultiBlock({"a": SQUARE, "b": gg.Grid.from_planes(*second)}, boundaries=NAMES)


def cascade():
    """A passage that is periodic, in part, and turned."""
    bonds = [gg.Connection((0, "top", (1, 3)), (0, "bottom", (1, 3)), translation=(0, -1.0))]
    return gg.MultiBlock([SQUARE], bonds)


def sector():
    return gg.MultiBlock(
        [ring(np.linspace(0, 2 * np.pi / 7, 5), 1.0, 3.0, 9)],
        [gg.Connection((0, "left"), (0, "right"), rotation=-360 / 7)],
    )


LAYOUTS = {
    "turned": turned,
    "cascade": cascade,
    "sector": sector,
    "ring": lambda: gg.MultiBlock([ring(np.linspace(0, 2 * np.pi, 25), 1.0, 2.0, 5)]),
    "pipe": lambda: butterfly(4, 3),
    "cut": lambda: cut(gg.domain("wavy", 9, 9), (0, 4, 8), (0, 2, 8)),
}


def assert_same(one, other):
    assert one.names == other.names
    assert [list(grid.planes.ravel()) for grid in one.blocks] == [list(grid.planes.ravel()) for grid in other.blocks]
    assert one.bonds == other.bonds
    assert one.boundaries == other.boundaries


@pytest.mark.parametrize("suffix", SEVERAL)
@pytest.mark.parametrize("name", LAYOUTS)
def test_what_is_written_is_read(tmp_path, name, suffix):
    layout, path = LAYOUTS[name](), tmp_path / f"file{suffix}"
    layout.write(path)
    assert_same(gg.read(path, layout=True), layout)
    assert (gg.read(path) == layout.blocks[0]) if len(layout) == 1 else isinstance(gg.read(path), gg.MultiBlock)
    layout.write(path)  # Over the first.
    assert_same(gg.read(path, layout=True), layout)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(
        {"file.nmf", path.name, *(["file"] * (suffix == ".vtm"))}
    )


@pytest.mark.parametrize("suffix", [".vts", ".csv", ".npz"])
def test_one_block_with_its_connections_goes_to_every_format(tmp_path, suffix):
    layout = LAYOUTS["ring"]()
    layout.write(tmp_path / f"ring{suffix}")
    assert_same(gg.read(tmp_path / f"ring{suffix}", layout=True), layout)
    with pytest.raises(gg.GridgenError, match=r"holds one block, and here are 2; use one of .*\.xyz, .*\.vtm"):
        turned().write(tmp_path / f"two{suffix}")
    assert not (tmp_path / "two.nmf").exists()


@pytest.mark.parametrize("three", [True, False])
@pytest.mark.parametrize("lines", ["one", "each", "none"])
def test_several_blocks_of_other_writers(three, lines):
    """The sizes stand in one line, or in one for each block, or without lines."""
    blocks = [gg.domain("swan", 5, 4), gg.domain("wavy", 3, 5), gg.domain("zee", 4, 4)]
    text = encoded(*blocks, words=() if three else ("plane",)).decode()
    if lines == "one":
        head, *sizes = text.splitlines()[:4]
        text = "\n".join([head, " ".join(sizes), *text.splitlines()[4:]])
    elif lines == "none":
        text = " ".join(text.split())
    assert decoded(text.encode()).grids == tuple(blocks)
    with pytest.raises(gg.GridgenError, match="do not fit its header"):
        decoded(text.encode().rstrip().rpartition(b"\n" if b"\n" in text.encode() else b" ")[0])


def test_faults_of_several_blocks_are_told():
    blocks = [SQUARE, SQUARE]
    with pytest.raises(gg.GridgenError, match="block 2: it is a surface in space"):
        decoded(encoded(*blocks)[:-2] + b"1\n")
    lines = encoded(*blocks).decode().splitlines()
    wrong = "\n".join([*lines[:8], "x", *lines[9:]]).encode()
    with pytest.raises(gg.GridgenError, match="line 9: could not convert string to float: 'x'"):
        decoded(wrong)


def test_without_a_map_coinciding_nodes_are_connected(tmp_path):
    layout = LAYOUTS["cut"]()
    (tmp_path / "cut.xyz").write_bytes(encoded(*layout.blocks))
    found = gg.read(tmp_path / "cut.xyz")
    assert found.bonds == layout.bonds
    (tmp_path / "three.xyz").write_bytes(encoded(SQUARE, SQUARE, SQUARE))
    with pytest.raises(gg.GridgenError, match=r"cannot connect the blocks of .*three\.xyz: .* edges of sides lie at"):
        gg.read(tmp_path / "three.xyz")


@pytest.mark.skipif(not FILES, reason=NO_SHARED.format("nasa"))
def test_there_are_files_of_nasa():
    assert len(FILES) >= 5


def heights(layout):
    """The first heights at the walls of a file of NASA."""
    found = []
    for part in layout.boundaries["viscous_solid"]:
        assert part.side in ("bottom", "top")
        planes = layout.blocks[part.block].planes[:, part.first : part.last + 1]
        edge = planes[:, :, 1] - planes[:, :, 0] if part.side == "bottom" else planes[:, :, -1] - planes[:, :, -2]
        found.append(np.hypot(*edge))
    return np.concatenate(found)


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in FILES if path.stem != "n4412_225-65"], ids=lambda path: path.stem)
def test_grids_of_nasa_are_smoothed_with_walls_as_one_grid(tmp_path, path):
    layout = gg.read(path, layout=True)
    first = float(np.median(heights(layout)))
    found = gg.optimize(layout, "winslow", walls={"viscous_solid": gg.Wall(first=first, growth=1.2)})
    assert found.converged, found.message
    assert found.quality.valid
    # Nodes at the ends of a wall stay, if they are on a side.
    assert np.abs(heights(found.grid)[1:-1] / first - 1).max() < (0.1 if len(layout) > 1 else 1e-2)
    if len(layout) == 1 and layout.bonds:
        assert kinks(found.grid).max() < 0.1
    found.grid.write(tmp_path / path.name)
    assert_same(gg.read(tmp_path / path.name, layout=True), found.grid)


@pytest.mark.parametrize("path", [pytest.param(path, id=path.stem) for path in FILES])
@pytest.mark.parametrize("suffix", SEVERAL)
def test_grids_of_nasa_are_the_same_after_writing(tmp_path, path, suffix):
    layout = gg.read(path, layout=True)
    layout.write(tmp_path / f"again{suffix}")
    assert_same(gg.read(tmp_path / f"again{suffix}", layout=True), layout)


@pytest.mark.skipif(not FILES, reason=NO_SHARED.format("nasa"))
def test_a_map_keeps_apart_what_coincides():
    """The two sides of a plate without thickness are walls of two blocks."""
    layout = gg.read(NASA / "shear_4levelsdown.p2dfmt")
    connected = [(bond.one.block, bond.one.side, bond.other.block) for bond in layout.bonds]
    assert connected == [(0, "right", 2), (1, "right", 2)]
    walls = {(part.block, part.side) for part in layout.boundaries["viscous_solid"]}
    assert walls == {(0, "top"), (1, "bottom")}
    assert len(gg.MultiBlock(layout.blocks).bonds) == 3
    found = gg.optimize(layout, "winslow", max_iterations=2).grid
    assert np.array_equal(found[0].planes[:, :, -1], layout[0].planes[:, :, -1])
    assert not np.array_equal(found[0].planes[:, -1], layout[0].planes[:, -1])


@pytest.mark.skipif(not FILES, reason=NO_SHARED.format("nasa"))
def test_a_file_of_one_block_is_one_grid_unless_a_layout_is_wanted():
    path = NASA / "n0012_113-33.p2dfmt"
    assert isinstance(gg.read(path), gg.Grid)
    layout = gg.read(path, layout=True)
    (bond,) = layout.bonds
    assert (bond.one.first, bond.one.last, bond.other.first, bond.other.last) == (0, 24, 88, 112)
    assert [(part.side, part.first, part.last) for part in layout.boundaries["viscous_solid"]] == [("bottom", 24, 88)]


MAP = """\
# a comment
2 \\

1  2  5  7
2  2  7  5
'symmetry_y_strong' 1 3  1 5  1 7
"the wall"  1 1  1 2  5 1   # backwards, which does not matter
farfield_riem  2 2  1 2  1 7
'one-to-one' 1 6  1 7  1 2   2 1  1 2  7 1  true \\
'ONE_TO_ONE' 1 3  1 5  1 7   1 4  1 5  1 7  .false.
"""


def read_with(tmp_path, text):
    right = np.array(SQUARE.planes)
    right[0] += 1
    second = gg.Grid.from_planes(*np.ascontiguousarray(right.transpose(0, 2, 1)[:, ::-1]))
    (tmp_path / "two.p2dfmt").write_bytes(encoded(SQUARE, second, words=("plane",)))
    (tmp_path / "two.nmf").write_text(text)
    return gg.read(tmp_path / "two.p2dfmt")


def test_maps_as_other_programs_write_them(tmp_path):
    found = read_with(tmp_path, MAP)
    assert found.bonds == turned().bonds
    assert {name: [(p.block, p.side, p.first, p.last) for p in parts] for name, parts in found.boundaries.items()} == {
        "the wall": [(0, "bottom", 0, 4)],
        "farfield_riem": [(1, "top", 0, 6)],
    }


def test_maps_in_other_directions(tmp_path):
    """The plane may be that of i and j, of i and k, or of j and k; Construct2D counts the sides of a plane."""
    expected = turned().bonds
    for text in (
        "2\n1 5 7 2\n2 7 5 2\none-to-one 1 4 1 7 1 2  2 5 1 2 7 1 true\nwall 1 5 1 2 1 3",
        "2\n1 5 7 1\n2 7 5 1\none-to-one 1 4 1 7 1 1  2 5 1 1 7 1 true\nwall 1 5 1 1 1 3",
        "2\n1 5 1 7\n2 7 1 5\none-to-one 1 4 1 1 1 7  2 1 7 1 1 1 true\nwall 1 1 1 3 1 1",
        "2\n1 5 7 1\n2 7 5 1\nONE_TO_ONE 1 2 1 7 1 1  2 3 7 1 1 1 FALSE\nwall 1 3 1 3 1 1",
    ):
        found = read_with(tmp_path, text)
        assert found.bonds == expected
        assert [(p.block, p.side, p.first, p.last) for p in found.boundaries["wall"]] == [(0, "bottom", 0, 2)]


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("2 \\\n", "3\n", "line 2: expected 2, the number of blocks of the grid file; came 3"),
        ("2 \\\n", "two\n", "line 2: expected the number of blocks; came 'two'"),
        ("1  2  5  7", "1  2  5  8", "line 4: expected 1 and the sizes of block 1, 5 x 7 nodes .* came 1 2 5 8"),
        ("2  2  7  5", "3  2  7  5", "line 5: expected 2 and the sizes of block 2, 7 x 5 nodes .* came 3 2 7 5"),
        ("2 2  1 2  1 7", "2 7  1 2  1 7", "line 8: expected a face from 1 to 6; came 7"),
        ("2 2  1 2  1 7", "3 2  1 2  1 7", "line 8: expected a block from 1 to 2; came 3"),
        ("2 2  1 2  1 7", "2 2  1 2  1 8", "line 8: expected two different nodes of face 2 of block 2, from 1 to"),
        ("2 2  1 2  1 7", "2 2  1 2  0 7", "came 0 to 7"),
        ("2 2  1 2  1 7", "2 2  1 1  1 7", "line 8: expected face 2 of block 2 in its whole depth, from 1 to 2; came"),
        ("2 2  1 2  1 7", "2 2  1 2  1", "line 8: expected the name of a boundary and 6 numbers: block, face, S1"),
        ("2 2  1 2  1 7", "2 2  1 2  a b", "line 8: expected the name of .* and 6 numbers.* came '2 2 1 2 a b'"),
        ("2 2  1 2  1 7", "2 1  1 2  1 7", "line 8: bottom of block 1, nodes 0 to 6 cannot be the boundary"),
        ("true", "false", "line 9: expected swap true, since the ranges along the sides are one the first and one the"),
        ("true", "perhaps", "line 9: expected one-to-one, twice block, face, S1, E1, S2, E2, and whether they swap"),
        ("1 2  7 1", "1 2  1 7", "line 9: right and bottom of two blocks .* run in opposite directions; came the same"),
        ("1 2  7 1", "1 2  6 1", "line 9: expected as many nodes on either side; came 7 and 6"),
        ("2 1  1 2  7 1", "2 2  1 2  1 7", r"line 9: connected nodes must be at one place, but node .* of block 1"),
        ("1 4  1 5", "1 5  1 5", "line 10: expected face 5 of block 1 in its whole depth"),
        ("# a comment\n", "# gridgen-sym: block 3 is named \"x\"\n", "line 1: expected a block from 1 to 2"),
        ("# a comment\n", f"# gridgen-sym: block {'9' * 5000} is named \"x\"\n", "line 1: expected a block from"),
        (MAP, "# nothing", "it has no lines but comments"),
        (MAP, "2\n1 2 5 7\n", "line 2: the file ends after it; expected a line with the sizes of each of 2 blocks"),
    ],
)  # fmt: skip
def test_faults_of_maps_are_told_with_their_lines(tmp_path, old, new, told):
    assert old in MAP
    with pytest.raises(gg.GridgenError, match=r"cannot read .*two\.nmf as a neutral map file: (?s:.*)" + told):
        read_with(tmp_path, MAP.replace(old, new))


@pytest.mark.parametrize("name", ["", "a\nb", 'it\'s "both"', "One_To_One"])
def test_names_that_a_map_cannot_hold_are_told_before_anything_is_written(tmp_path, name):
    layout = gg.MultiBlock([SQUARE], boundaries={name: [(0, "bottom")]})
    with pytest.raises(gg.GridgenError, match="cannot hold the boundary name"):
        layout.write(tmp_path / "grid.p2dfmt")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["", " a", "a\nb", "a\0b", "\u2028a", "\ud800"])
def test_names_of_blocks_come_back_or_are_refused_before_anything_is_written(tmp_path, name):
    layout = gg.MultiBlock({name: SQUARE}, boundaries={"all": [(0, side) for side in SIDES]})
    for suffix in (".vtm", ".tec", ".msh", ".mesh"):
        with pytest.raises(gg.GridgenError, match="cannot hold the block name"):
            layout.write(tmp_path / f"grid{suffix}")
    assert not list(tmp_path.iterdir())
    layout.write(tmp_path / "grid.xyz")
    assert gg.read(tmp_path / "grid.xyz", layout=True).names == (name,)


def test_a_map_beside_a_new_grid_is_told(tmp_path, capsys):
    turned().write(tmp_path / "a.xyz")
    assert not capsys.readouterr().err
    SQUARE.write(tmp_path / "a.xyz")
    assert "a.nmf lies beside and is kept" in capsys.readouterr().err


def test_conversion_keeps_what_a_file_of_one_block_tells(tmp_path):
    around = ring(np.linspace(0, 2 * np.pi, 9), 1.0, 3.0, 5)
    layout = gg.MultiBlock([around], [gg.Connection((0, "left"), (0, "right"))], boundaries={"far field": [(0, "top")]})
    paths = [tmp_path / name for name in ("a.p2dfmt", "b.vts", "c.npz", "d.tec")]
    layout.write(paths[0])
    for source, target in itertools.pairwise(paths):
        assert CliRunner().invoke(main, ["convert", str(source), str(target)]).exit_code == 0
    found = gg.read(paths[-1], layout=True)
    assert (found.bonds, found.boundaries) == (layout.bonds, layout.boundaries)
    (tmp_path / "d.nmf").unlink()
    CliRunner().invoke(main, ["convert", str(paths[-1]), str(tmp_path / "e.vts")])
    assert not (tmp_path / "e.nmf").exists()


def test_a_folder_with_other_files_is_not_replaced(tmp_path):
    layout, folder = turned(), tmp_path / "two"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    with pytest.raises(gg.GridgenError, match=r"it also holds 'notes\.txt'"):
        layout.write(tmp_path / "two.vtm")
    assert (folder / "notes.txt").read_text() == "mine"
    assert [p.name for p in tmp_path.iterdir()] == ["two"]


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("vtkMultiBlockDataSet", "StructuredGrid", "expected a VTKFile of type vtkMultiBlockDataSet"),
        ("block_1.vts", "block_1.vtu", r"its block 1 is in the file 'two/block_1\.vtu'; expected a structured grid"),
        ("block_1.vts", "block_7.vts", r"cannot read .*block_7\.vts: there is no such file"),
        ('name="b"', 'name="a"', "two of its blocks have the name 'a'"),
        ("DataSet index", "Other index", "it has no blocks"),
    ],
)
def test_faults_of_multi_block_files_of_vtk_are_told(tmp_path, old, new, told):
    turned().write(tmp_path / "two.vtm")
    text = (tmp_path / "two.vtm").read_text()
    assert old in text
    (tmp_path / "two.vtm").write_text(text.replace(old, new))
    with pytest.raises(gg.GridgenError, match=told):
        gg.read(tmp_path / "two.vtm")


def test_what_is_no_grid_cannot_be_written(tmp_path):
    with pytest.raises(gg.GridgenError, match="expected a Grid, came ndarray"):
        gg.write(SQUARE.xy, tmp_path / "x.xyz")


@pytest.mark.extras
@pytest.mark.parametrize("form", ["", "binary"])
@pytest.mark.parametrize("name", LAYOUTS)
def test_vtk_reads_several_blocks(tmp_path, name, form):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataReader

    layout = LAYOUTS[name]()
    gg.write(layout, tmp_path / "file.vtm", form=form)
    reader = vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(tmp_path / "file.vtm"))
    reader.Update()
    found = reader.GetOutput()
    assert found.GetNumberOfBlocks() == len(layout)
    for number, (title, grid) in enumerate(zip(layout.names, layout.blocks, strict=True)):
        assert found.GetMetaData(number).Get(found.NAME()) == title
        block = found.GetBlock(number)
        assert block.GetExtent() == (0, grid.shape[0] - 1, 0, grid.shape[1] - 1, 0, 0)
        points = vtk_to_numpy(block.GetPoints().GetData())
        assert np.array_equal(points[:, 0], grid.x.T.ravel())
        assert np.array_equal(points[:, 1], grid.y.T.ravel())
        assert not points[:, 2].any()


def test_a_map_that_is_cut_short_is_told(tmp_path, capsys):
    gg.layout("wye", across=4).write(tmp_path / "wye.p2dfmt")
    whole = (tmp_path / "wye.nmf").read_text(encoding="utf-8").splitlines(keepends=True)
    gg.read(tmp_path / "wye.p2dfmt")
    assert not capsys.readouterr().err
    (tmp_path / "wye.nmf").write_text("".join(whole[:12]), encoding="utf-8")
    assert not gg.read(tmp_path / "wye.p2dfmt").bonds
    assert "they are not connected (9 in all); see whether the map is complete" in capsys.readouterr().err
