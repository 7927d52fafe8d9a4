"""CGNS grid files (.cgns), through HDF5: one base, a structured zone for each block, boundaries and connections."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from typing import IO, Any, BinaryIO

import numpy as np

from ...boundary.sides import Sides
from ...errors import GridgenError, quoted, shortened
from ...messages import report
from ..cgns_parts import (
    Zone,
    add_boundaries,
    add_connections,
    boundaries_in,
    connections_in,
    families,
    joined,
    whole_side,
)
from ..cgns_tree import LONGEST_NAME, add, begin, children, content, integers, library, name_of, only, text, words_of
from ..format import Blocks, Format
from ..plot3d_planes import Plane, plane_of

_COORDINATES = ("CoordinateX", "CoordinateY", "CoordinateZ")
_WANTED = "CoordinateX and CoordinateY"
_PIECE = 1 << 20
#: What damaged files raise in h5py.
_FAULTS = (OSError, ValueError, TypeError, KeyError, RuntimeError, AttributeError, MemoryError, IndexError)


def encode(blocks: Blocks) -> Iterator[bytes]:
    """Return the pieces of a CGNS file: a plane zone for each block, i along xi, j along eta.

    Names of boundaries are those of families; the type of each is what its name says, as `wall`. One that has the name
    of a block has no family, since zones and families have different names. A grid alone has its sides as boundaries.

    Raises:
        GridgenError: for names that a node of CGNS cannot have.
        MissingExtraError: if h5py is not installed.
    """
    h5py = library("writing")
    _check_names(blocks)
    try:
        # In a file, not in memory: that is faster, and the numbers are not there once more.
        file = tempfile.TemporaryFile()  # noqa: SIM115 - it is closed after its last piece
        with h5py.File(file, "w", track_order=True) as root:
            _fill(root, blocks, h5py.version.hdf5_version)
    except OSError as error:
        raise GridgenError(
            f"cannot make a CGNS file in the folder for temporary files: {error}; free space there, or set TMPDIR"
        ) from error
    return _pieces(file)


def _fill(root: Any, blocks: Blocks, version: str) -> None:  # noqa: ANN401 - h5py's groups
    """Write the tree of some blocks."""
    begin(root, version)
    base = add(root, "Base", "CGNSBase_t", integers(2, 2))
    for name in families(blocks):
        add(base, name, "Family_t")
    for number, (name, grid) in enumerate(blocks.described):
        nodes = np.array(grid.shape, dtype=np.int32)
        zone = add(base, name, "Zone_t", np.stack((nodes, nodes - 1, 0 * nodes)))
        add(zone, "ZoneType", "ZoneType_t", text("Structured"))
        coordinates = add(zone, "GridCoordinates", "GridCoordinates_t")
        add(coordinates, "CoordinateX", "DataArray_t", grid.x.T)
        add(coordinates, "CoordinateY", "DataArray_t", grid.y.T)
        add(zone, "Ordinal", "Ordinal_t", integers(number + 1))
        add_boundaries(zone, blocks, number)
        add_connections(zone, blocks, number)


def _pieces(file: IO[bytes]) -> Iterator[bytes]:
    with file:
        file.seek(0)
        while piece := file.read(_PIECE):
            yield piece


def _check_names(blocks: Blocks) -> None:
    """Refuse names that a node of CGNS cannot have, and several parts beside one block where no family holds them."""
    names = [name for name, _ in blocks.described]
    for what, name in [("block", name) for name in names] + [("boundary", name) for name in blocks.boundaries]:
        printed = name.isprintable() and name == name.strip() and "/" not in name and name != "."
        if not printed or not 0 < len(name.encode("utf-8")) <= LONGEST_NAME:
            raise GridgenError(
                f"a CGNS file cannot hold the {what} name {quoted(name)}: take one of 1 to {LONGEST_NAME} bytes, "
                "without slashes and line breaks, and without blanks at its ends"
            )
        beside = [part.block for part in blocks.boundaries[name]] if what == "boundary" and name in names else []
        if len(set(beside)) < len(beside):
            raise GridgenError(
                f"a CGNS file cannot hold a block and a boundary of one name, {quoted(name)}, with several parts on "
                "one block: rename one"
            )


def decode(stream: BinaryIO) -> Blocks:
    """Return the blocks of a CGNS file with structured zones, each of which must be plane, or one layer of cells.

    Raises:
        GridgenError: for a file that is not CGNS on HDF5 or damaged, unstructured zones, volumes, and connections that
            do not fit.
        MissingExtraError: if h5py is not installed.
    """
    h5py = library("reading")
    if stream.read(4) != b"\x89HDF":
        raise GridgenError("it is not on HDF5, perhaps on the older ADF: convert it by  adf2hdf")
    stream.seek(0)
    try:
        with h5py.File(stream) as root:
            return _blocks(root)
    except _FAULTS as error:
        if isinstance(error, GridgenError):
            raise
        raise GridgenError(f"its tree is damaged ({shortened(error)}): write it again") from error


def _blocks(root: Any) -> Blocks:  # noqa: ANN401
    nodes = children(only(root, "CGNSBase_t"), "Zone_t")
    if not nodes:
        raise GridgenError("it has no nodes of the type Zone_t; expected one for each block")
    planes = [_plane(node) for node in nodes]
    for remark in dict.fromkeys(plane.remark for _, plane in planes if plane.remark):
        report(remark)
    zones = [
        Zone(number, name_of(node), sizes, tuple(axis for axis in range(3) if axis != plane.across)[:2])  # type: ignore[arg-type]
        for number, (node, (sizes, plane)) in enumerate(zip(nodes, planes, strict=True))
    ]
    found = [pair for node, zone in zip(nodes, zones, strict=True) for pair in boundaries_in(node, zone)]
    boundaries: dict[str, tuple[Any, ...]] = {}
    for _, name, part in sorted(found, key=lambda pair: pair[0]):
        boundaries[name] = (*boundaries.get(name, ()), part)
    bonds = [connections_in(node, zone, zones) for node, zone in zip(nodes, zones, strict=True)]
    said = [pair for pairs in bonds if pairs for pair in pairs]
    grids = tuple(plane.grid for _, plane in planes)
    sides = {side: (whole_side(0, side, grids[0].shape),) for side in Sides._fields}
    if len(grids) == 1 and boundaries == sides and bonds == [None]:
        boundaries = {}  # Of a grid alone, in which a cut is not connected yet.
    return Blocks(
        grids,
        tuple(zone.name for zone in zones),
        None if all(pairs is None for pairs in bonds) else joined(said),
        boundaries,
    )


def _plane(zone: Any) -> tuple[tuple[int, ...], Plane]:  # noqa: ANN401
    """Return the numbers of nodes of a zone along its indices, and its plane."""
    kinds = [words_of(node) for node in children(zone, "ZoneType_t")]
    if kinds != ["Structured"]:
        kind = shortened(", ".join(kinds)) or "of no type"
        raise GridgenError(f"its zone {name_of(zone)} is {kind}; expected Structured")
    found = {name_of(node): node for node in children(only(zone, "GridCoordinates_t"), "DataArray_t")}
    if not {*_COORDINATES[:2]} <= found.keys():
        raise GridgenError(f"it has the coordinates {shortened(', '.join(found)) or 'none'}; expected {_WANTED}")
    values = [(key, content(found[key])) for key in _COORDINATES if key in found]
    sizes = _sizes(zone)
    space = (sizes[0], sizes[1], sizes[2] if len(sizes) == 3 else 1)
    for key, array in values:
        if array.shape[::-1] not in (sizes, space):
            raise GridgenError(f"{key} has the shape {array.shape[::-1]}; expected {sizes}, that of its zone")
    return sizes, plane_of([array.ravel() for _, array in values], space, len(values), holes=False)


def _sizes(zone: Any) -> tuple[int, ...]:  # noqa: ANN401
    """Return the numbers of nodes of a zone along its two or three indices."""
    numbers = content(zone)
    if numbers.ndim != 2 or numbers.shape[0] != 3 or numbers.shape[1] not in (2, 3) or numbers.dtype.kind not in "iu":
        raise GridgenError(f"its zone {name_of(zone)} has sizes of the shape {numbers.shape[::-1]}; expected (2, 3)")
    if numbers[0].min() < 1:
        raise GridgenError(
            f"its zone {name_of(zone)} has {numbers[0].tolist()} nodes; expected at least 1 of each index"
        )
    return tuple(numbers[0].tolist())


FORMAT = Format(
    name="CGNS file",
    suffixes=(".cgns",),
    decode=decode,
    encode=encode,
    streamed=True,
    several=True,
    names=True,
    binary=True,
    dimensions="as a PLOT3D grid",
    extra=("io", "h5py"),
    writes="CGNS on HDF5: a structured zone for each block; `ZoneBC_t` with names (families) and types, "
    "`GridConnectivity1to1_t`, also periodic",
    reads="also single precision, compressed arrays, and layers of one cell",
    test="tests/io/test_cgns.py::test_pycgns_and_vtk_read_what_is_written",
)
