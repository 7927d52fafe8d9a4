"""Parts of files, which are read without what stands before and after them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import BinaryIO

#: Bytes that are searched at once.
_PIECE = 1 << 20


@dataclass(slots=True)
class Window:
    """A part of a file, read as if it were one.

    Attributes:
        stream: the file.
        begin: where the next byte is.
        end: where the part ends.
    """

    stream: BinaryIO
    begin: int
    end: int

    def read(self, count: int = -1) -> bytes:
        """Return the next bytes; all for a negative count."""
        left = max(0, self.end - self.begin)
        self.stream.seek(self.begin)
        data = self.stream.read(left if count < 0 else min(count, left))
        self.begin += len(data)
        return data


def find(stream: BinaryIO, sign: bytes, begin: int) -> int:
    """Return where a sign stands in a file for the first time from a place on; -1 where it does not."""
    stream.seek(begin)
    rest = b""
    while data := stream.read(_PIECE):
        piece = rest + data
        at = piece.find(sign)
        if at >= 0:
            return begin + at
        rest = piece[len(piece) - len(sign) + 1 :]
        begin += len(piece) - len(rest)
    return -1
