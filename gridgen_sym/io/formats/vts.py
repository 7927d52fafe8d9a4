"""VTK XML structured grids (.vts): written as ASCII, read as other programs write them too.

Read: ASCII, inline base64, and appended base64 or raw data, uncompressed or compressed by zlib, either byte
    order.
Source: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np

from ...errors import GridgenError, quoted, shortened
from ...grids.grid import Grid
from ...parsing import whole_number_in
from ..checks import plane_grid
from ..format import Format
from ..vtk_data import DAMAGED, DataArrays


def encode(grid: Grid) -> bytes:
    """Return the grid as a VTK XML structured grid in ASCII, in the plane z = 0."""
    ni, nj = grid.shape
    extent = f"0 {ni - 1} 0 {nj - 1} 0 0"
    points = np.stack((grid.x.T.ravel(), grid.y.T.ravel()), axis=-1)  # In VTK the first index runs fastest.
    body = ("%.17g %.17g 0\n" * len(points)) % tuple(points.ravel().tolist())
    return (
        '<?xml version="1.0"?>\n'
        '<VTKFile type="StructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<StructuredGrid WholeExtent="{extent}">\n<Piece Extent="{extent}">\n<Points>\n'
        '<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">\n'
        f"{body}</DataArray>\n</Points>\n</Piece>\n</StructuredGrid>\n</VTKFile>\n"
    ).encode("ascii")


def decode(data: bytes) -> Grid:
    """Return the grid of a VTK XML structured grid of one piece, which must lie in a plane of constant z.

    Raises:
        GridgenError: for broken XML, another type of VTK file, several pieces, a volume, an unknown
            compressor, or data that do not fit the extent.
    """
    xml, appended = _split_appended(data)
    root = xml_root(xml, "StructuredGrid")
    pieces = root.findall("StructuredGrid/Piece")
    if len(pieces) != 1:
        raise GridgenError(f"it has {len(pieces)} pieces; expected 1: merge them first")
    array = pieces[0].find("Points/DataArray")
    if array is None:
        raise GridgenError(f"it has no Points/DataArray; {DAMAGED}")
    ni, nj = _shape(pieces[0].get("Extent", ""))
    values = DataArrays(root, appended, 3 * ni * nj).values(array)
    if values.size != 3 * ni * nj:
        raise GridgenError(f"its extent has {ni} x {nj} points of 3 numbers, but {values.size} came; {DAMAGED}")
    x, y, z = (plane.T for plane in values.reshape(nj, ni, 3).transpose(2, 0, 1))
    return plane_grid(x, y, z)


def xml_root(xml: bytes, kind: str) -> ElementTree.Element:
    """Return the root of a VTK XML file of a kind.

    Raises:
        GridgenError: for broken XML, or another kind.
    """
    if b"<!DOCTYPE" in xml or b"\0" in xml:  # Entities could expand without bound; UTF-16 would hide them.
        raise GridgenError(f"it declares a document type, or is no plain text, which no VTK file does; {DAMAGED}")
    try:
        root = ElementTree.fromstring(xml)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise GridgenError(f"its XML is broken ({error}); {DAMAGED}") from error
    if root.tag != "VTKFile" or root.get("type") != kind:
        raise GridgenError(
            f"its root is <{shortened(root.tag)} type={quoted(root.get('type'))}>; expected a VTKFile of type {kind}"
        )
    return root


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


def _split_appended(data: bytes) -> tuple[bytes, bytes]:
    """Cut the content of <AppendedData>, which may be raw and no XML at all, out of the file."""
    start = data.find(b"<AppendedData")
    mark, end = data.find(b"_", data.find(b">", start)), data.rfind(b"</AppendedData>")
    if start < 0 or not start < mark < end:
        return data, b""
    return data[:mark] + data[end:], data[mark + 1 : end]


FORMAT = Format(
    name="VTK XML structured grid",
    suffixes=(".vts",),
    decode=decode,
    encode=encode,
    dimensions="a plane of constant z",
    writes="ASCII, 17 digits, for ParaView, PyVista, VisIt",
    reads="also binary, inline or appended, plain or compressed by zlib, either byte order; one piece",
    test="tests/io/test_files.py::test_vtk_reads_what_is_written",
)
