"""CGNS files hold the tree that the standard asks for, with the nodes as they are."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest
from support_files import LAYOUTS, turned

import gridgen_sym as gg
from gridgen_sym.boundary import domain
from gridgen_sym.errors import GridgenError, MissingExtraError
from gridgen_sym.io import read
from gridgen_sym.io.format import Blocks
from gridgen_sym.io.formats import cgns

GRID = domain("swan", 7, 5)


def encoded(blocks):
    return b"".join(cgns.encode(blocks))


def decoded(data):
    return cgns.decode(io.BytesIO(data))


def tree(group):
    """The nodes below one, as {path: (label, type, data)}."""
    found = {}

    def add(path, node):
        if "label" in node.attrs:
            found[path] = (node.attrs["label"], node.attrs["type"], node[" data"][()] if " data" in node else None)

    group.visititems(add)
    return found


def test_the_tree_is_that_of_the_standard(tmp_path):
    h5py = pytest.importorskip("h5py")
    GRID.write(tmp_path / "swan.CGNS")
    with h5py.File(tmp_path / "swan.CGNS") as file:
        nodes = tree(file)
        assert bytes(file[" format"][()]) == b"IEEE_LITTLE_32\0"
        assert file.attrs["label"] == b"Root Node of HDF5 File"
        assert all(group.attrs["name"].decode() == path.split("/")[-1] for path in nodes for group in [file[path]])
        assert [file["Base"].attrs.get_id(key).dtype.itemsize for key in ("name", "label", "type")] == [33, 33, 3]
        assert file["Base/0"].attrs["flags"].tolist() == [1]
    assert {path: (label.decode(), kind.decode()) for path, (label, kind, _) in nodes.items()} == {
        "CGNSLibraryVersion": ("CGNSLibraryVersion_t", "R4"),
        "Base": ("CGNSBase_t", "I4"),
        "Base/0": ("Zone_t", "I4"),
        "Base/0/ZoneType": ("ZoneType_t", "C1"),
        "Base/0/GridCoordinates": ("GridCoordinates_t", "MT"),
        "Base/0/GridCoordinates/CoordinateX": ("DataArray_t", "R8"),
        "Base/0/GridCoordinates/CoordinateY": ("DataArray_t", "R8"),
        "Base/0/Ordinal": ("Ordinal_t", "I4"),
        "Base/0/ZoneBC": ("ZoneBC_t", "MT"),
    } | {
        f"Base/0/ZoneBC/{side}{child}": kinds
        for side in ("bottom", "right", "top", "left")
        for child, kinds in {
            "": ("BC_t", "C1"),
            "/PointRange": ("IndexRange_t", "I4"),
            "/FamilyName": ("FamilyName_t", "C1"),
            "/Ordinal": ("Ordinal_t", "I4"),
        }.items()
    }
    assert nodes["Base/0/ZoneBC/top/PointRange"][2].tolist() == [[1, 5], [7, 5]]
    assert nodes["Base"][2].tolist() == [2, 2]
    assert nodes["Base/0"][2].tolist() == [[7, 5], [6, 4], [0, 0]]  # Nodes, cells: (2, 3) in the order of Fortran.
    assert bytes(nodes["Base/0/ZoneType"][2]) == b"Structured"
    for name, plane in (("X", GRID.x), ("Y", GRID.y)):
        assert np.array_equal(nodes[f"Base/0/GridCoordinates/Coordinate{name}"][2].T, plane)


def test_one_grid_gives_one_file():
    pytest.importorskip("h5py")
    assert encoded(Blocks((GRID,))) == encoded(Blocks((GRID,)))


def test_without_room_for_temporary_files_that_is_told(monkeypatch, tmp_path):
    pytest.importorskip("h5py")

    def full():
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tempfile.TemporaryFile", full)
    with pytest.raises(GridgenError, match=r"folder for temporary files: .*No space left on device; free space there"):
        GRID.write(tmp_path / "swan.cgns")
    assert not list(tmp_path.iterdir())


def test_without_h5py_the_extra_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(MissingExtraError, match=r"gridgen-sym\[io\]"):
        GRID.write(tmp_path / "swan.cgns")
    assert not list(tmp_path.iterdir())


def test_what_is_written_is_read_bit_by_bit(tmp_path):
    pytest.importorskip("h5py")
    GRID.write(tmp_path / "swan.cgns")
    assert read(tmp_path / "swan.cgns") == GRID


def changed(change):
    """A file of ours after a change of its tree."""
    h5py = pytest.importorskip("h5py")
    file = io.BytesIO(encoded(Blocks((GRID,))))
    with h5py.File(file, "r+") as root:
        change(root)
    return file.getvalue()


def put(path, data, **options):
    """Replace the data of a node."""

    def change(root):
        group = root[path]
        if " data" in group:
            del group[" data"]
        group.create_dataset(" data", data=data, **options)

    return change


COORDINATES = "Base/0/GridCoordinates"


def add_z(values):
    def change(root):
        node = root[COORDINATES].create_group("CoordinateZ")
        node.attrs.create("label", np.bytes_("DataArray_t"), dtype="S33")
        node.create_dataset(" data", data=values)

    return change


def test_other_writers_have_single_precision_a_k_plane_and_a_constant_z():
    def change(root):
        for name, plane in (("X", GRID.x), ("Y", GRID.y)):
            put(f"{COORDINATES}/Coordinate{name}", plane.T[None].astype(np.float32), compression="gzip")(root)
        add_z(np.full((1, 5, 7), 2.5))(root)

    (found,) = decoded(changed(change)).grids
    assert np.array_equal(found.planes, GRID.planes.astype(np.float32))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("Base/0/ZoneType", np.frombuffer(b"Unstructured", np.int8)), "is Unstructured; expected Structured"),
        (lambda root: root["Base"].move("0", "../elsewhere"), "no nodes of the type Zone_t"),
        (
            lambda root: root[COORDINATES].move("CoordinateY", "CoordinateR"),
            "coordinates CoordinateX, CoordinateR",
        ),
        (
            put(f"{COORDINATES}/CoordinateX", np.zeros((2, 5, 7))),
            r"X has the shape \(7, 5, 2\); expected \(7, 5\), that of its zone",
        ),
        (put(f"{COORDINATES}/CoordinateX", np.zeros((5, 6))), r"X has the shape \(6, 5\); expected \(7, 5\)"),
        (put(f"{COORDINATES}/CoordinateX", np.full((5, 7), np.nan)), r"node \(0, 0\) is \(nan"),
        (put(f"{COORDINATES}/CoordinateX", np.array([b"x"])), "are no numbers"),
        (add_z(np.arange(35.0).reshape(5, 7)), "its z varies"),
        (add_z(np.full((5, 7), np.inf)), r"that of node \(0, 0\) is inf"),
    ],
)
def test_a_file_with_a_fault(change, message):
    with pytest.raises(GridgenError, match=message):
        decoded(changed(change))


def test_a_link_into_another_file_is_not_followed(tmp_path):
    h5py = pytest.importorskip("h5py")
    GRID.write(tmp_path / "other.cgns")

    def change(root):
        del root["Base/0"]
        root["Base/0"] = h5py.ExternalLink(str(tmp_path / "other.cgns"), "/Base/0")

    with pytest.raises(GridgenError, match="no nodes of the type Zone_t"):
        decoded(changed(change))


def test_data_packed_too_tightly_for_a_grid_are_refused():
    """A file of a few kilobytes that announces eight terabytes."""

    def sparse(root):
        group = root[f"{COORDINATES}/CoordinateX"]
        del group[" data"]
        group.create_dataset(" data", shape=(1 << 20, 1 << 20), dtype="f8", chunks=(1024, 1024))

    with pytest.raises(GridgenError, match="no grid can be packed so tightly"):
        decoded(changed(sparse))


@pytest.mark.parametrize("name", LAYOUTS)
def test_layouts_are_read_as_they_were_written(tmp_path, name):
    """Bit by bit, with names, connections and boundaries, and no file beside it."""
    pytest.importorskip("h5py")
    made, path = LAYOUTS[name](), tmp_path / "file.cgns"
    gg.write(made, path)
    assert [p.name for p in tmp_path.iterdir()] == ["file.cgns"]
    if isinstance(made, gg.Grid):
        assert gg.read(path) == made
        assert gg.read(path, layout=True) == gg.MultiBlock([made])
        return
    back = gg.read(path, layout=True)
    assert back == made
    assert back.boundaries == made.boundaries


def test_the_cut_of_a_grid_is_connected_when_it_is_read_as_a_layout(tmp_path):
    pytest.importorskip("h5py")
    ring = LAYOUTS["ring"]()
    gg.write(ring.blocks[0], tmp_path / "ring.cgns")
    assert gg.read(tmp_path / "ring.cgns") == ring.blocks[0]
    assert gg.read(tmp_path / "ring.cgns", layout=True) == ring
    gg.write(gg.MultiBlock(ring.blocks, []), tmp_path / "ring.cgns")
    assert gg.read(tmp_path / "ring.cgns", layout=True).bonds == ()


def in_zones(change):
    """The file of two blocks, the second of which is turned, after a change of its tree."""
    h5py = pytest.importorskip("h5py")
    made = turned()
    file = io.BytesIO(encoded(Blocks(made.blocks, made.names, made.bonds, made.boundaries)))
    with h5py.File(file, "r+") as root:
        change(root)
    return file.getvalue()


def of_a_layer(root):
    """Make the zones of another writer: three indices, one layer of cells across."""
    for zone in ("a", "b"):
        group = root["Base"][zone]
        put(f"Base/{zone}", np.insert(group[" data"][()], 2, [2, 1, 0], axis=1))(root)
        for name in ("CoordinateX", "CoordinateY"):
            plane = group[f"GridCoordinates/{name}/ data"][()]
            put(f"Base/{zone}/GridCoordinates/{name}", np.stack((plane, plane)))(root)
        z = np.stack((0 * plane, 0 * plane + 0.5))
        node = group["GridCoordinates"].create_group("CoordinateZ")
        node.attrs.create("label", np.bytes_("DataArray_t"), dtype="S33")
        node.create_dataset(" data", data=z)

        def deepen(path, node):
            if node.attrs.get("label") == b"IndexRange_t":
                put(node.name, np.column_stack((node[" data"][()], [1, 2])))(root)

        group.visititems(deepen)


def test_zones_of_a_layer_of_cells(capsys):
    found = decoded(in_zones(of_a_layer))
    made = turned()
    assert (found.grids, found.names, found.bonds, found.boundaries) == (
        made.blocks, made.names, made.bonds, dict(made.boundaries)
    )  # fmt: skip
    assert "the grid is the plane k = 1 of a layer of cells in x and y" in capsys.readouterr().err


CONNECTION = "Base/a/ZoneGridConnectivity/Connection 1"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            put(CONNECTION, np.frombuffer(b"c", np.int8)),
            "the connection Connection 1 of the zone a leads to no zone 'c'",
        ),
        (put(f"{CONNECTION}/PointRange", np.array([[5, 1], [5, 8]], np.int32)), "leaves its 5 x 7 nodes"),
        (put(f"{CONNECTION}/PointRange", np.array([[4, 1], [4, 7]], np.int32)), "is no part of a side"),
        (put(f"{CONNECTION}/PointRange", np.array([[5, 1], [5, 6]], np.int32)), "do not fit: expected as many nodes"),
        (put(f"{CONNECTION}/PointRange", np.array([[5, 7], [5, 1]], np.int32)), "do not fit: expected .* directions?"),
        (put(f"{CONNECTION}/PointRange", np.array([5, 7], np.int32)), r"has the shape \(2,\); expected \(2, 2\)"),
        (put("Base/a", np.array([[5, 7, 0]], np.int32)), r"sizes of the shape \(3, 1\)"),
        (put("Base/a", np.zeros((3, 2), np.int32)), r"has \[0, 0\] nodes"),
    ],
)
def test_faults_of_zones_are_told(change, message):
    with pytest.raises(GridgenError, match=message):
        decoded(in_zones(change))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a" * 33, "1 to 32 bytes"),
        ("a/b", "without slashes"),
        ("a ", "blanks at its ends"),
        ("\ud800", "without slashes"),
        ("", "1 to 32 bytes"),
        ("0", "of one name"),
    ],
)
def test_names_that_cgns_cannot_hold(tmp_path, name, message):
    pytest.importorskip("h5py")
    with pytest.raises(GridgenError, match=message):
        gg.write(gg.MultiBlock([GRID], [], boundaries={name: [(0, "left"), (0, "top")]}), tmp_path / "a.cgns")
    assert not list(tmp_path.iterdir())


def test_a_boundary_with_the_name_of_a_block(tmp_path):
    """The inlet of 'wye' is beside a block of that name; zones and families are named alike in no file."""
    pytest.importorskip("h5py")
    layout = gg.layout("wye", across=4)
    layout.write(tmp_path / "wye.cgns")
    assert gg.read(tmp_path / "wye.cgns") == layout


def below(node, label):
    """The children of a node of pyCGNS's tree with a label, by name."""
    return {child[0]: child for child in node[2] if child[3] == label}


def words(node):
    return node[1].tobytes().decode().rstrip()


@pytest.mark.extras
@pytest.mark.parametrize("name", LAYOUTS)
def test_pycgns_and_vtk_read_what_is_written(tmp_path, name):
    import CGNS.MAP
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOCGNSReader import vtkCGNSReader

    made, path = LAYOUTS[name](), tmp_path / "file.cgns"
    gg.write(made, path)
    layout = made if isinstance(made, gg.MultiBlock) else gg.MultiBlock([made], [])
    (base,) = below(CGNS.MAP.load(str(path))[0], "CGNSBase_t").values()
    zones = below(base, "Zone_t")
    assert sorted(zones) == sorted(layout.names)
    counted = 0
    for number, (block, grid) in enumerate(zip(layout.names, layout.blocks, strict=True)):
        zone = zones[block]
        assert zone[1].T.tolist() == [list(grid.shape), [n - 1 for n in grid.shape], [0, 0]]
        arrays = below(below(zone, "GridCoordinates_t")["GridCoordinates"], "DataArray_t")
        assert np.array_equal(arrays["CoordinateX"][1], grid.x)
        assert np.array_equal(arrays["CoordinateY"][1], grid.y)
        conditions = [bc for group in below(zone, "ZoneBC_t").values() for bc in below(group, "BC_t").values()]
        found = {(words(below(bc, "FamilyName_t")["FamilyName"]), *end_nodes(bc, grid)) for bc in conditions}
        if made is layout:
            assert found == {
                (title, *ends(part, grid))
                for title, parts in made.boundaries.items()
                for part in parts
                if part.block == number
            }
            assert all(words(bc) == ("BCWall" if "wall" in bc[0] else words(bc)) for bc in conditions)
        else:
            assert {title for title, *_ in found} == {"left", "right", "bottom", "top"}
        for group in below(zone, "ZoneGridConnectivity_t").values():
            for node in below(group, "GridConnectivity1to1_t").values():
                counted += 1
                donor = layout[words(node)]
                check_connection(node, grid, donor)
    assert counted == 2 * len(layout.bonds)
    reader = vtkCGNSReader()
    reader.SetFileName(str(path))
    reader.Update()
    blocks = reader.GetOutput().GetBlock(0)
    for number in range(blocks.GetNumberOfBlocks()):
        grid = layout[blocks.GetMetaData(number).Get(blocks.NAME())]
        points = vtk_to_numpy(blocks.GetBlock(number).GetPoints().GetData())
        assert np.array_equal(points[:, 0], grid.x.T.ravel())
        assert np.array_equal(points[:, 1], grid.y.T.ravel())


def end_nodes(node, grid, key="PointRange"):
    """The positions of the first and the last node of a range, of pyCGNS's tree."""
    (i0, i1), (j0, j1) = (below(node, "IndexRange_t")[key][1] - 1).tolist()
    return tuple(grid.xy[i0, j0].tolist()), tuple(grid.xy[i1, j1].tolist())


def ends(part, grid):
    i, j = part.indices(grid.shape)
    return tuple(grid.xy[i[0], j[0]].tolist()), tuple(grid.xy[i[-1], j[-1]].tolist())


def check_connection(node, grid, donor):
    """By the standard: index of the donor = T (index - begin) + begin of the donor, for every node of the range."""
    ranges = below(node, "IndexRange_t")
    begin, end = ranges["PointRange"][1].T
    start, stop = ranges["PointRangeDonor"][1].T
    (transform,) = (child[1] for child in node[2] if child[0] == "Transform")
    matrix = np.zeros((2, 2), dtype=int)
    for axis, along in enumerate(transform.tolist()):
        matrix[abs(along) - 1, axis] = np.sign(along)
    assert round(np.linalg.det(matrix)) == 1  # Both blocks have J > 0.
    assert np.array_equal(matrix @ (end - begin) + start, stop)
    motion = lambda point: point  # noqa: E731
    for periodic in (part for group in below(node, "GridConnectivityProperty_t").values() for part in group[2]):
        arrays = {child[0]: child for child in periodic[2]}
        angle = np.radians(arrays["RotationAngle"][1][0])
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        motion = lambda point, turn=turn, shift=arrays["Translation"][1]: turn @ point + shift  # noqa: E731
    steps = np.abs(end - begin).max()
    for step in range(steps + 1):
        i, j = begin + (end - begin) // steps * step
        k, m = matrix @ (np.array([i, j]) - begin) + start
        assert motion(grid.xy[i - 1, j - 1]) == pytest.approx(donor.xy[k - 1, m - 1], abs=1e-12)
