"""CGNS grid files (.cgns), through HDF5: one base, one structured zone, its coordinates.

Every node of the CGNS tree is an HDF5 group with the attributes name, label, type and flags, and its data in the
dataset ' data', whose axes are those of Fortran: reversed.
Source: CGNS Standard Interface Data Structures 4.x, and the mapping "SIDS File Mapping Manual, HDF5" (cgns.github.io).
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...archives import check_packing
from ...arrays import Array
from ...errors import GridgenError, MissingExtraError, shortened
from ...grids.grid import Grid
from ..checks import plane_grid
from ..format import Format

_VERSION = np.array([3.1], dtype=np.float32)  # The oldest one with these nodes: older libraries read it, too.
_COORDINATES = ("CoordinateX", "CoordinateY", "CoordinateZ")
_WANTED = "CoordinateX and CoordinateY"
#: Names of CGNS data types by those of NumPy.
_TYPES = {"i1": "C1", "i4": "I4", "f4": "R4", "f8": "R8"}


def encode(grid: Grid) -> bytes:
    """Return the grid as a CGNS file: a plane zone with the nodes' x and y, i along xi, j along eta.

    Raises:
        MissingExtraError: if h5py is not installed.
    """
    h5py = _library("writing")
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


def decode(data: bytes) -> Grid:
    """Return the grid of a CGNS file with one structured zone, which must lie in a plane of constant z.

    Raises:
        GridgenError: for a file that is not CGNS on HDF5 or damaged, several zones, an unstructured one or a volume.
        MissingExtraError: if h5py is not installed.
    """
    h5py = _library("reading")
    if not data.startswith(b"\x89HDF"):
        raise GridgenError("it is not on HDF5, perhaps on the older ADF: convert it by  adf2hdf")
    try:
        with h5py.File(io.BytesIO(data)) as root:
            zone = _only(_only(root, "CGNSBase_t"), "Zone_t")
            kinds = [bytes(_content(node)).decode("ascii") for node in _children(zone, "ZoneType_t")]
            if kinds != ["Structured"]:
                raise GridgenError(f"its zone is {shortened(', '.join(kinds)) or 'of no type'}; expected Structured")
            found = {_name(node): node for node in _children(_only(zone, "GridCoordinates_t"), "DataArray_t")}
            planes = [_plane(found[key]) for key in _COORDINATES if key in found]
            if not {*_COORDINATES[:2]} <= found.keys():
                raise GridgenError(
                    f"it has the coordinates {shortened(', '.join(found)) or 'none'}; expected {_WANTED}"
                )
    except (OSError, ValueError, TypeError, KeyError, RuntimeError, AttributeError, MemoryError) as error:
        if isinstance(error, GridgenError):
            raise
        raise GridgenError(f"its tree is damaged ({shortened(error)}): write it again") from error
    return plane_grid(*planes)


def _library(purpose: str) -> Any:  # noqa: ANN401 - a module
    try:
        import h5py
    except ImportError as error:
        raise MissingExtraError(f"{purpose} a CGNS file", "io", "h5py") from error
    return h5py


def _children(group: Any, label: str) -> list[Any]:  # noqa: ANN401 - h5py's groups
    """Return the nodes with a label directly below one."""
    # A link into another file may lead anywhere.
    inside = [key for key in group if type(group.get(key, getlink=True)).__name__ != "ExternalLink"]
    nodes = [group[key] for key in inside if group.get(key, getclass=True).__name__ == "Group"]
    return [node for node in nodes if bytes(node.attrs.get("label", b"")).rstrip(b"\0 ") == label.encode()]


def _only(group: Any, label: str) -> Any:  # noqa: ANN401
    """Return the one node with a label below another."""
    nodes = _children(group, label)
    if len(nodes) != 1:
        raise GridgenError(f"it has {len(nodes)} nodes of the type {label}; expected 1: write one zone alone")
    return nodes[0]


def _name(node: Any) -> str:  # noqa: ANN401
    return str(node.name).rpartition("/")[2]


def _content(node: Any) -> NDArray[Any]:  # noqa: ANN401
    """Return the data of a node, which must not take more memory than its part of the file allows."""
    data = node[" data"]
    if data.dtype.kind not in "iuf":
        raise GridgenError(f"the data of {_name(node)} are no numbers, but {data.dtype}")
    if data.external or data.is_virtual:
        raise GridgenError(f"the data of {_name(node)} are in another file: write them into one")
    check_packing(data.id.get_storage_size(), data.nbytes, f"the array {_name(node)}")
    content: NDArray[Any] = data[()]
    return content


def _plane(node: Any) -> Array:  # noqa: ANN401
    """Return a coordinate as a plane (ni, nj); a volume of one k plane is one."""
    values = _content(node)
    if values.ndim == 3 and values.shape[0] == 1:
        values = values[0]
    if values.ndim != 2:
        raise GridgenError(f"{_name(node)} has the shape {values.shape[::-1]}; expected (ni, nj): cut out one k plane")
    return values.T.astype(np.float64)


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


FORMAT = Format(
    name="CGNS file",
    suffixes=(".cgns",),
    decode=decode,
    encode=encode,
    binary=True,
    dimensions="a plane, or a volume of one k plane of constant z",
    extra=("io", "h5py"),
    writes="CGNS on HDF5: one structured zone",
    reads="also single precision and compressed arrays",
    test="tests/io/test_cgns.py::test_the_tree_is_that_of_the_standard",
)
