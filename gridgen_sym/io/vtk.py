"""VTK XML structured grids (.vts): written as ASCII, read as other programs write them too.

Read: ASCII, inline base64, and appended base64 or raw data, uncompressed or compressed by zlib, either byte
    order.
Source: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import dataclass
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import GridgenError, quoted, shortened
from ..grids.grid import Grid
from ..parsing import whole_number_in
from .checks import check_packing, plane_grid

_TYPES = {"Float32": "f4", "Float64": "f8"}
_ZLIB = "vtkZLibDataCompressor"
_DAMAGED = "the file may be cut short or damaged: write it again"


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
    if b"<!DOCTYPE" in xml or b"\0" in xml:  # Entities could be written out without end; UTF-16 would hide them.
        raise GridgenError(f"it declares a document type, or is no plain text, which no VTK file does; {_DAMAGED}")
    try:
        root = ElementTree.fromstring(xml)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise GridgenError(f"its XML is broken ({error}); {_DAMAGED}") from error
    if root.tag != "VTKFile" or root.get("type") != "StructuredGrid":
        raise GridgenError(
            f"its root is <{shortened(root.tag)} type={quoted(root.get('type'))}>; expected a VTKFile of type "
            "StructuredGrid"
        )
    pieces = root.findall("StructuredGrid/Piece")
    if len(pieces) != 1:
        raise GridgenError(f"it has {len(pieces)} pieces; expected 1: merge them first")
    array = pieces[0].find("Points/DataArray")
    if array is None:
        raise GridgenError(f"it has no Points/DataArray; {_DAMAGED}")
    ni, nj = _shape(pieces[0].get("Extent", ""))
    values = _Source(root, appended, 3 * ni * nj).values(array)
    if values.size != 3 * ni * nj:
        raise GridgenError(f"its extent has {ni} x {nj} points of 3 numbers, but {values.size} came; {_DAMAGED}")
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


def _split_appended(data: bytes) -> tuple[bytes, bytes]:
    """Cut the content of <AppendedData>, which may be raw and no XML at all, out of the file."""
    start = data.find(b"<AppendedData")
    mark, end = data.find(b"_", data.find(b">", start)), data.rfind(b"</AppendedData>")
    if start < 0 or not start < mark < end:
        return data, b""
    return data[:mark] + data[end:], data[mark + 1 : end]


@dataclass(frozen=True, slots=True)
class _Source:
    """What is needed to decode the data arrays of one file.

    Attributes:
        root: of the XML.
        appended: the content of <AppendedData>.
        count: how many numbers the extent allows; no more is decompressed.
    """

    root: ElementTree.Element
    appended: bytes
    count: int

    def values(self, array: ElementTree.Element) -> Array:
        """Return the numbers of one <DataArray>, flat."""
        kind, form = array.get("type", ""), array.get("format", "ascii")
        if kind not in _TYPES:
            raise GridgenError(f"its points have the type {quoted(kind)}; expected {' or '.join(_TYPES)}")
        try:
            if form == "ascii":
                return _ascii(array.text or "")
            content = self._content(array, form, self.count * int(_TYPES[kind][1:]))
            return np.frombuffer(content, dtype=self._order() + _TYPES[kind]).astype(np.float64)
        except (ValueError, IndexError, OverflowError, binascii.Error, zlib.error) as error:
            if isinstance(error, GridgenError):
                raise
            raise GridgenError(f"its points cannot be decoded ({shortened(error)}); {_DAMAGED}") from error

    def _content(self, array: ElementTree.Element, form: str, size: int) -> bytes:
        """Return the bytes of one array, of which `size` are expected, decoded and decompressed."""
        if form == "binary":
            return self._unpack(b"".join((array.text or "").encode().split()), size, encoded=True)
        if form != "appended":
            raise GridgenError(f"its points have the format {quoted(form)}; expected ascii, binary or appended")
        section = self.root.find("AppendedData")
        encoded = section is not None and section.get("encoding") == "base64"
        return self._unpack(self.appended[whole_number_in(array.get("offset", "0")) :], size, encoded=encoded)

    def _unpack(self, stream: bytes, expected: int, *, encoded: bool) -> bytes:
        """Take off VTK's header of lengths, base64 and compression, for `expected` bytes."""
        word = np.dtype(self._order() + ("u8" if self.root.get("header_type") == "UInt64" else "u4"))
        compressor = self.root.get("compressor", "")
        if not compressor:
            (size,) = self._header(stream, word, 1, encoded).tolist()
            return self._body(stream, word.itemsize, size, encoded)
        if compressor != _ZLIB:
            raise GridgenError(f"its compressor is {quoted(compressor)}; expected {_ZLIB}, none, or ASCII: save it so")
        (blocks,) = self._header(stream, word, 1, encoded).tolist()
        if blocks * word.itemsize > len(stream):
            raise ValueError(f"{blocks} compressed blocks announced in {len(stream)} bytes")
        sizes = self._header(stream, word, 3 + blocks, encoded)[3:].tolist()
        packed = self._body(stream, word.itemsize * (3 + blocks), sum(sizes), encoded)
        ends = np.cumsum([0, *sizes]).tolist()
        check_packing(len(packed), expected, "what its blocks hold")
        return _decompressed([packed[a:b] for a, b in pairwise(ends)], expected)

    def _header(
        self, stream: bytes, word: np.dtype[np.unsignedinteger], count: int, encoded: bool
    ) -> NDArray[np.uint64]:
        """Return the first `count` words of the header."""
        size = count * word.itemsize
        head = _base64(stream[: _encoded_size(size)]) if encoded else stream
        return np.frombuffer(head[:size], dtype=word, count=count).astype(np.uint64)

    def _body(self, stream: bytes, skip: int, size: int, encoded: bool) -> bytes:
        """Return `size` bytes after a header of `skip` bytes, padded where it was encoded by itself."""
        if encoded:
            padded = stream[: _encoded_size(skip)]
            if padded.endswith(b"=") or skip % 3 == 0:
                stream, skip = stream[len(padded) :], 0
            stream = _base64(stream[: _encoded_size(skip + size)])
        if len(stream) < skip + size:
            raise ValueError(f"{size} bytes announced, {len(stream) - skip} came")
        return stream[skip : skip + size]

    def _order(self) -> str:
        """Return NumPy's sign for the file's byte order."""
        return ">" if self.root.get("byte_order") == "BigEndian" else "<"


def _ascii(text: str) -> Array:
    """Return the numbers of a text."""
    if "_" in text:  # NumPy takes 1_0 for ten.
        raise ValueError(f"{quoted(next(word for word in text.split() if '_' in word))} is not a number")
    return np.array(text.split(), dtype=np.float64)


def _decompressed(blocks: list[bytes], expected: int) -> bytes:
    """Return what blocks hold, of which no more is decompressed than shows that there is too much."""
    parts, left = [], expected
    for block in blocks:
        stream = zlib.decompressobj()
        parts.append(stream.decompress(block, left + 1))
        left -= len(parts[-1])
        if left < 0:
            raise ValueError(f"its blocks hold more than the {expected} bytes that its extent allows")
        if not stream.eof:
            raise ValueError("a compressed block is not whole")
    return b"".join(parts)


def _encoded_size(size: int) -> int:
    """Return how many characters base64 needs for `size` bytes."""
    return 4 * ((size + 2) // 3)


def _base64(text: bytes) -> bytes:
    """Decode base64 strictly."""
    return base64.b64decode(text, validate=True)
