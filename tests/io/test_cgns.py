"""CGNS files hold the tree that the standard asks for, with the nodes as they are."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from gridgen_sym.boundary import domain
from gridgen_sym.errors import GridgenError, MissingExtraError
from gridgen_sym.io import cgns, read

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


def test_it_is_not_read(tmp_path):
    with pytest.raises(GridgenError, match="written, but not read; keep the grid as"):
        read(tmp_path / "swan.cgns")


def test_without_h5py_the_extra_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(MissingExtraError, match=r"gridgen-sym\[io\]"):
        GRID.write(tmp_path / "swan.cgns")
    assert not list(tmp_path.iterdir())
