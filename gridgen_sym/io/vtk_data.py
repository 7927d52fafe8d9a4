"""The numbers of a VTK XML file: ASCII, base64 or appended raw data, perhaps compressed by zlib, in any byte order."""

from __future__ import annotations

import base64
import binascii
import zlib
from dataclasses import dataclass
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..archives import check_packing
from ..arrays import Array
from ..errors import GridgenError, quoted, shortened
from ..parsing import whole_number_in
from .plot3d_numbers import Numbers
from .vtk_parts import DAMAGED
from .windows import Window

_TYPES = {"Float32": "f4", "Float64": "f8"}
_ZLIB = "vtkZLibDataCompressor"


@dataclass(frozen=True, slots=True)
class DataArrays:
    """The data arrays of one file, and what is needed to decode them.

    Attributes:
        root: of the XML.
        appended: the content of <AppendedData>; the offset of an array counts from its beginning.
        count: how many numbers the extent allows; no more is decompressed.
    """

    root: ElementTree.Element
    appended: Window
    count: int

    def values(self, array: ElementTree.Element, content: Window) -> Array:
        """Return the numbers of one <DataArray> with a content, flat."""
        kind, form = array.get("type", ""), array.get("format", "ascii")
        if kind not in _TYPES:
            raise GridgenError(f"its points have the type {quoted(kind)}; expected {' or '.join(_TYPES)}")
        try:
            if form == "ascii":
                numbers = Numbers(content, DAMAGED, None)
                if numbers.count != self.count:
                    raise GridgenError(
                        f"its points have {numbers.count} numbers, and its extent asks for {self.count}; {DAMAGED}"
                    )
                numbers.check_size()
                return numbers.take(self.count)
            data = self._content(array, content, form, self.count * int(_TYPES[kind][1:]))
            return np.frombuffer(data, dtype=self._order() + _TYPES[kind]).astype(np.float64, copy=False)
        except (ValueError, IndexError, OverflowError, binascii.Error, zlib.error) as error:
            if isinstance(error, GridgenError):
                raise
            raise GridgenError(f"its points cannot be decoded ({shortened(error)}); {DAMAGED}") from error

    def _content(self, array: ElementTree.Element, content: Window, form: str, size: int) -> bytes:
        """Return the bytes of one array, of which `size` are expected, decoded and decompressed."""
        if form == "binary":
            return self._unpack(b"".join(content.read().split()), size, encoded=True)
        if form != "appended":
            raise GridgenError(f"its points have the format {quoted(form)}; expected ascii, binary or appended")
        section = self.root.find("AppendedData")
        encoded = section is not None and section.get("encoding") == "base64"
        offset = whole_number_in(array.get("offset", "0"))
        if offset < 0:
            raise ValueError(f"its offset is {offset}")
        part = Window(self.appended.stream, self.appended.begin + offset, self.appended.end)
        # No more is read than the array may have: what is plain has a length before it.
        plain = not encoded and not self.root.get("compressor")
        return self._unpack(part.read(size + 8 if plain else -1), size, encoded=encoded)

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
