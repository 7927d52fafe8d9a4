"""CGNS grid files (.cgns), written through HDF5: one base, one structured zone, its coordinates.

Every node of the CGNS tree is an HDF5 group with the attributes name, label, type and flags, and its data in the
dataset ' data', whose axes are those of Fortran: reversed.
Source: CGNS Standard Interface Data Structures 4.x, and the mapping "SIDS File Mapping Manual, HDF5" (cgns.github.io).
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import MissingExtraError
from ..grids.grid import Grid

_VERSION = np.array([3.1], dtype=np.float32)  # The oldest one with these nodes: older libraries read it, too.
#: Names of CGNS data types by those of NumPy.
_TYPES = {"i1": "C1", "i4": "I4", "f4": "R4", "f8": "R8"}


def encode(grid: Grid) -> bytes:
    """Return the grid as a CGNS file: a plane zone with the nodes' x and y, i along xi, j along eta.

    Raises:
        MissingExtraError: if h5py is not installed.
    """
    try:
        import h5py
    except ImportError as error:
        raise MissingExtraError("writing a CGNS file", "io", "h5py") from error
    file = io.BytesIO()
    with h5py.File(file, "w", track_order=True) as root:
        _describe(root, "HDF5 MotherNode", "Root Node of HDF5 File", "MT")
        root.create_dataset(" format", data=_text("IEEE_LITTLE_32", 15))
        root.create_dataset(" hdf5version", data=_text(f"HDF5 Version {h5py.version.hdf5_version}", 33))
        _node(root, "CGNSLibraryVersion", "CGNSLibraryVersion_t", _VERSION)
        base = _node(root, "Base", "CGNSBase_t", np.array([2, 2], dtype=np.int32))
        nodes = np.array(grid.shape, dtype=np.int32)
        zone = _node(base, "Zone", "Zone_t", np.stack((nodes, nodes - 1, 0 * nodes)))
        _node(zone, "ZoneType", "ZoneType_t", _text("Structured"))
        coordinates = _node(zone, "GridCoordinates", "GridCoordinates_t")
        _node(coordinates, "CoordinateX", "DataArray_t", grid.x.T)
        _node(coordinates, "CoordinateY", "DataArray_t", grid.y.T)
    return file.getvalue()


def _node(parent: Any, name: str, label: str, data: NDArray[Any] | None = None) -> Any:  # noqa: ANN401 - h5py's groups
    """Add a node to the tree, with its data, if it has any."""
    group = parent.create_group(name, track_order=True)
    _describe(group, name, label, "MT" if data is None else _TYPES[data.dtype.str[1:]])
    group.attrs.create("flags", np.array([1], dtype=np.int32))
    if data is not None:
        group.create_dataset(" data", data=data)
    return group


def _describe(group: Any, name: str, label: str, kind: str) -> None:  # noqa: ANN401
    """Add the attributes that every node has, texts of fixed lengths."""
    for attribute, text, length in (("name", name, 33), ("label", label, 33), ("type", kind, 3)):
        group.attrs.create(attribute, np.bytes_(text), dtype=f"S{length}")


def _text(text: str, length: int = 0) -> NDArray[np.int8]:
    """Return text as CGNS has it: numbers of one byte, filled with zeros up to a length."""
    return np.frombuffer(text.encode("ascii").ljust(length, b"\0"), dtype=np.int8)
