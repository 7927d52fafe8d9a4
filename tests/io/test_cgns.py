"""CGNS files hold the tree that the standard asks for, with the nodes as they are."""

from __future__ import annotations

import contextlib
import io
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gridgen_sym.boundary import domain
from gridgen_sym.errors import GridgenError, MissingExtraError
from gridgen_sym.grids import Grid
from gridgen_sym.io import read
from gridgen_sym.io.formats import cgns

GRID = domain("swan", 7, 5)


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
        assert file["Base/Zone"].attrs["flags"].tolist() == [1]
    assert {path: (label.decode(), kind.decode()) for path, (label, kind, _) in nodes.items()} == {
        "CGNSLibraryVersion": ("CGNSLibraryVersion_t", "R4"),
        "Base": ("CGNSBase_t", "I4"),
        "Base/Zone": ("Zone_t", "I4"),
        "Base/Zone/ZoneType": ("ZoneType_t", "C1"),
        "Base/Zone/GridCoordinates": ("GridCoordinates_t", "MT"),
        "Base/Zone/GridCoordinates/CoordinateX": ("DataArray_t", "R8"),
        "Base/Zone/GridCoordinates/CoordinateY": ("DataArray_t", "R8"),
    }
    assert nodes["Base"][2].tolist() == [2, 2]
    assert nodes["Base/Zone"][2].tolist() == [[7, 5], [6, 4], [0, 0]]  # Nodes, cells: (2, 3) in the order of Fortran.
    assert bytes(nodes["Base/Zone/ZoneType"][2]) == b"Structured"
    for name, plane in (("X", GRID.x), ("Y", GRID.y)):
        assert np.array_equal(nodes[f"Base/Zone/GridCoordinates/Coordinate{name}"][2].T, plane)


def test_one_grid_gives_one_file():
    pytest.importorskip("h5py")
    assert cgns.encode(GRID) == cgns.encode(GRID)


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
    file = io.BytesIO(cgns.encode(GRID))
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


COORDINATES = "Base/Zone/GridCoordinates"


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

    found = cgns.decode(changed(change))
    assert np.array_equal(found.planes, GRID.planes.astype(np.float32))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (put("Base/Zone/ZoneType", np.frombuffer(b"Unstructured", np.int8)), "is Unstructured; expected Structured"),
        (lambda root: root.copy("Base/Zone", root["Base"], "Zone2"), "2 nodes of the type Zone_t; expected 1"),
        (lambda root: root["Base"].move("Zone", "../elsewhere"), "0 nodes of the type Zone_t"),
        (
            lambda root: root[COORDINATES].move("CoordinateY", "CoordinateR"),
            "coordinates CoordinateX, CoordinateR",
        ),
        (put(f"{COORDINATES}/CoordinateX", np.zeros((2, 5, 7))), r"shape \(7, 5, 2\); expected \(ni, nj\)"),
        (put(f"{COORDINATES}/CoordinateX", np.zeros((5, 6))), "one shape"),
        (put(f"{COORDINATES}/CoordinateX", np.full((5, 7), np.nan)), r"node \(0, 0\) is \(nan"),
        (put(f"{COORDINATES}/CoordinateX", np.array([b"x"])), "are no numbers"),
        (add_z(np.arange(35.0).reshape(5, 7)), "its z varies"),
        (add_z(np.full((5, 7), np.inf)), r"that of node \(0, 0\) is inf"),
    ],
)
def test_a_file_with_a_fault(change, message):
    with pytest.raises(GridgenError, match=message):
        cgns.decode(changed(change))


def test_a_link_into_another_file_is_not_followed(tmp_path):
    h5py = pytest.importorskip("h5py")
    GRID.write(tmp_path / "other.cgns")

    def change(root):
        del root["Base/Zone"]
        root["Base/Zone"] = h5py.ExternalLink(str(tmp_path / "other.cgns"), "/Base/Zone")

    with pytest.raises(GridgenError, match="0 nodes of the type Zone_t"):
        cgns.decode(changed(change))


@settings(max_examples=100)
@given(place=st.floats(0, 1, exclude_max=True), cut=st.booleans(), byte=st.integers(0, 255))
def test_a_damaged_file_is_a_grid_or_an_error(place, cut, byte):
    pytest.importorskip("h5py")
    data = bytearray(cgns.encode(GRID))
    k = int(place * len(data))
    if cut:
        del data[k:]
    else:
        data[k] = byte
    with contextlib.suppress(GridgenError):  # Any other error, or warning, fails the test.
        assert isinstance(cgns.decode(bytes(data)), Grid)


def test_data_packed_too_tightly_for_a_grid_are_refused():
    """A file of a few kilobytes that announces eight terabytes."""

    def sparse(root):
        group = root[f"{COORDINATES}/CoordinateX"]
        del group[" data"]
        group.create_dataset(" data", shape=(1 << 20, 1 << 20), dtype="f8", chunks=(1024, 1024))

    with pytest.raises(GridgenError, match="no grid can be packed so tightly"):
        cgns.decode(changed(sparse))
