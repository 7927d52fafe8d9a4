"""The numbers in a section of a Gmsh file, as words of a text or as bytes, one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import GridgenError

Indices = NDArray[np.int64]


class Numbers(Protocol):
    """Numbers that are taken from the front."""

    def integers(self, count: int) -> Indices:
        """Return the next integers."""
        ...

    def tags(self, count: int) -> Indices:
        """Return the next tags or counts, which take more bytes."""
        ...

    def reals(self, count: int) -> Array:
        """Return the next real numbers."""
        ...

    def rows(self, count: int, reals: int) -> tuple[Indices, Array]:
        """Return the next rows: for each an integer, and real numbers, (count, reals)."""
        ...


@dataclass(slots=True)
class Words:
    """The numbers of a text."""

    words: list[bytes]
    at: int = 0

    def integers(self, count: int) -> Indices:
        """Return the next integers."""
        return np.array([int(word) for word in self._next(count)], dtype=np.int64)

    def tags(self, count: int) -> Indices:
        """Return the next tags or counts."""
        return self.integers(count)

    def reals(self, count: int) -> Array:
        """Return the next real numbers."""
        return np.array(self._next(count), dtype=np.float64)

    def rows(self, count: int, reals: int) -> tuple[Indices, Array]:
        """Return the next rows: for each an integer, and real numbers, (count, reals)."""
        table = self.reals(count * (1 + reals)).reshape(count, 1 + reals)
        return table[:, 0].astype(np.int64), table[:, 1:]

    def _next(self, count: int) -> list[bytes]:
        found = self.words[self.at : self.at + count] if count >= 0 else []
        if len(found) != count:
            raise GridgenError("it is cut short: a section has fewer numbers than it announces")
        self.at += count
        return found


@dataclass(slots=True)
class Bytes:
    """The numbers in binary data.

    Attributes:
        data: the bytes.
        order: `<` where the lowest byte is the first, `>` where it is the last.
        at: how many bytes are read.
    """

    data: bytes
    order: str
    at: int = 0

    def integers(self, count: int) -> Indices:
        """Return the next integers, of four bytes."""
        return self._next("i4", count).astype(np.int64)

    def tags(self, count: int) -> Indices:
        """Return the next tags or counts, of eight bytes."""
        return self._next("i8", count).astype(np.int64)

    def reals(self, count: int) -> Array:
        """Return the next real numbers."""
        return self._next("f8", count).astype(np.float64)

    def rows(self, count: int, reals: int) -> tuple[Indices, Array]:
        """Return the next rows: for each an integer, and real numbers, (count, reals)."""
        found = self._next([("integer", "i4"), ("reals", "f8", (reals,))], count)
        return found["integer"].astype(np.int64), found["reals"].astype(np.float64)

    def _next(self, kind: Any, count: int) -> NDArray[Any]:  # noqa: ANN401 - what NumPy takes
        dtype = np.dtype(kind).newbyteorder(self.order)
        size = dtype.itemsize * count
        if not 0 <= size <= len(self.data) - self.at:
            raise GridgenError("it is cut short: a section has fewer bytes than it announces")
        found = np.frombuffer(self.data, dtype, count, self.at)
        self.at += size
        return found
