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

DAMAGED = "the file may be cut short or damaged: write it again"
_TYPES = {"Float32": "f4", "Float64": "f8"}
_ZLIB = "vtkZLibDataCompressor"


@dataclass(frozen=True, slots=True)
class DataArrays:
    """The data arrays of one file, and what is needed to decode them.

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
            raise GridgenError(f"its points cannot be decoded ({shortened(error)}); {DAMAGED}") from error

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
