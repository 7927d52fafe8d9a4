"""NumPy archives (.npz): the array xy, or the arrays x and y."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from ...archives import read_arrays
from ...grids.grid import Grid
from ..format import Format

_EXPECTED = "expected the array 'xy' (ni, nj, 2), or 'x' and 'y' (ni, nj)"
_PIECE = 1 << 20


def encode(grid: Grid) -> Iterator[bytes]:
    """Return the pieces of a NumPy archive with the one array ``xy``, shape (ni, nj, 2)."""
    stream = io.BytesIO()
    np.savez(stream, xy=grid.xy)
    stream.seek(0)
    while piece := stream.read(_PIECE):
        yield piece


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
