"""NumPy archives (.npz): the array xy, or the arrays x and y."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from ...archives import read_arrays
from ...grids.grid import Grid
from ..format import Format

_EXPECTED = "expected the array 'xy' (ni, nj, 2), or 'x' and 'y' (ni, nj)"
_PIECE = 1 << 20


def encode(grid: Grid) -> Iterator[bytes]:
    """Return the pieces of a NumPy archive with the one array ``xy``, shape (ni, nj, 2)."""
    sink, shape = _Sink([]), (*grid.shape, 2)
    step = max(1, _PIECE // (16 * shape[1]))
    # A ZipInfo has the date 1980: one grid gives one file.
    with (
        zipfile.ZipFile(sink, "w") as archive,
        archive.open(zipfile.ZipInfo("xy.npy"), "w", force_zip64=True) as member,
    ):
        np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": shape})
        for begin in range(0, shape[0], step):
            rows = np.stack([plane[begin : begin + step] for plane in grid.planes], axis=-1)
            member.write(rows.astype("<f8", copy=False).tobytes())
            yield from sink.taken()
    yield from sink.taken()


@dataclass(slots=True)
class _Sink:
    """A file that keeps what is written until it is taken."""

    parts: list[bytes]

    def write(self, data: bytes) -> int:
        """Keep data."""
        self.parts.append(bytes(data))
        return len(data)

    def flush(self) -> None:
        """Do nothing: nothing is held back."""

    def close(self) -> None:
        """Do nothing: what is kept stays."""

    def taken(self) -> list[bytes]:
        """Return what has been written since the last time."""
        taken, self.parts = self.parts, []
        return taken


def decode(stream: BinaryIO) -> Grid:
    """Return the grid of a NumPy archive with the array ``xy``, shape (ni, nj, 2), or ``x`` and ``y``, (ni, nj).

    Raises:
        GridgenError: if the archive is damaged, holds Python objects, has no such arrays, or is packed so tightly that
            it can hold no grid.
    """
    arrays = read_arrays(stream, (("xy",), ("x", "y")), _EXPECTED)
    return Grid(arrays["xy"]) if "xy" in arrays else Grid.from_planes(arrays["x"], arrays["y"])


FORMAT = Format(
    name="NumPy archive",
    suffixes=(".npz",),
    decode=decode,
    encode=encode,
    binary=True,
    streamed=True,
    writes="the array `xy` of shape (ni, nj, 2)",
    reads="also `x` and `y` of shape (ni, nj), and compressed archives",
    test="tests/io/test_files.py::test_npz_of_other_writers",
)
