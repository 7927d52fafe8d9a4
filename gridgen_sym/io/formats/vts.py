"""VTK XML structured grids (.vts): written as text or binary, read as other programs write them too.

Read: ASCII, inline base64, and appended base64 or raw data, uncompressed or compressed by zlib, either byte
    order.
Source: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import BinaryIO

import numpy as np

from ...arrays import Array
from ...errors import GridgenError, quoted
from ...grids.grid import Grid
from ...parsing import whole_number_in
from ..checks import plane_grid
from ..format import Format
from ..vtk_data import DataArrays
from ..vtk_parts import DAMAGED, parts_of, xml_root

#: Points of a piece that is written.
_PIECE = 1 << 15
#: Words for the form of a file.
FORMS = {"ascii": "text, 17 digits", "binary": "appended raw data, little-endian"}


def encode(grid: Grid, words: Collection[str] = ()) -> Iterator[bytes]:
    """Return the pieces of a VTK XML structured grid in the plane z = 0; the word `binary` appends raw data."""
    ni, nj = grid.shape
    extent = f"0 {ni - 1} 0 {nj - 1} 0 0"
    binary = "binary" in words
    yield (
        '<?xml version="1.0"?>\n'
        '<VTKFile type="StructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<StructuredGrid WholeExtent="{extent}">\n<Piece Extent="{extent}">\n<Points>\n'
        '<DataArray type="Float64" Name="Points" NumberOfComponents="3" '
        + ('format="appended" offset="0">' if binary else 'format="ascii">\n')
    ).encode("ascii")
    if not binary:
        for points in _points(grid):
            yield ("%.17g %.17g 0\n" * len(points) % tuple(points.ravel().tolist())).encode("ascii")
    yield b"</DataArray>\n</Points>\n</Piece>\n</StructuredGrid>\n"
    if binary:
        yield b'<AppendedData encoding="raw">\n_' + np.array(24 * ni * nj, dtype="<u8").tobytes()
        step = max(1, _PIECE // ni)
        points = np.zeros((step, ni, 3), dtype="<f8")
        for begin in range(0, nj, step):
            count = min(step, nj - begin)
            for axis in range(2):
                points[:count, :, axis] = grid.planes[axis, :, begin : begin + count].T
            yield points[:count].tobytes()
        yield b"\n</AppendedData>\n"
    yield b"</VTKFile>\n"


def _points(grid: Grid) -> Iterator[Array]:
    """Yield the nodes, some rows (n, 2) at once: in VTK the first index runs fastest."""
    ni, nj = grid.shape
    step = max(1, _PIECE // ni)
    for begin in range(0, nj, step):
        rows = grid.planes[:, :, begin : begin + step]
        yield np.ascontiguousarray(rows.transpose(2, 1, 0)).reshape(-1, 2)


def decode(stream: BinaryIO, words: Collection[str] = ()) -> Grid:
    """Return the grid of a VTK XML structured grid of one piece, which must lie in a plane of constant z.

    Args:
        stream: the file.
        words: ignored: a file says itself what it is.

    Raises:
        GridgenError: for broken XML, another type of VTK file, several pieces, a volume, an unknown
            compressor, or data that do not fit the extent.
    """
    parts = parts_of(stream)
    root = xml_root(parts.xml, "StructuredGrid")
    pieces = root.findall("StructuredGrid/Piece")
    if len(pieces) != 1:
        raise GridgenError(f"it has {len(pieces)} pieces; expected 1: merge them first")
    array = pieces[0].find("Points/DataArray")
    if array is None:
        raise GridgenError(f"it has no Points/DataArray; {DAMAGED}")
    places = [index for index, one in enumerate(root.iter("DataArray")) if one is array]
    if places[0] >= len(parts.arrays):
        raise GridgenError(f"its data arrays have no end; {DAMAGED}")
    ni, nj = _shape(pieces[0].get("Extent", ""))
    values = DataArrays(root, parts.appended, 3 * ni * nj).values(array, parts.arrays[places[0]])
    if values.size != 3 * ni * nj:
        raise GridgenError(f"its extent has {ni} x {nj} points of 3 numbers, but {values.size} came; {DAMAGED}")
    x, y, z = (plane.T for plane in values.reshape(nj, ni, 3).transpose(2, 0, 1))
    return plane_grid(x, y, z)


def _shape(extent: str) -> tuple[int, int]:
    """Return the numbers of nodes from an extent of six numbers, flat along k."""
    try:
        i0, i1, j0, j1, k0, k1 = (whole_number_in(word) for word in extent.split())
    except ValueError as error:
        raise GridgenError(f"the extent of its piece is {quoted(extent)}; expected six whole numbers") from error
    if k0 != k1 or i1 < i0 or j1 < j0:
        raise GridgenError(
            f"the extent of its piece is {quoted(extent)}; expected a grid in i and j with a one k plane"
        )
    return i1 - i0 + 1, j1 - j0 + 1


FORMAT = Format(
    name="VTK XML structured grid",
    suffixes=(".vts",),
    decode=decode,
    encode=encode,
    streamed=True,
    forms=FORMS,
    dimensions="a plane of constant z",
    writes="text, 17 digits, for ParaView, PyVista, VisIt; binary by the words below",
    reads="also binary, inline or appended, plain or compressed by zlib, either byte order; one piece",
    test="tests/io/test_files.py::test_vtk_reads_what_is_written",
)
