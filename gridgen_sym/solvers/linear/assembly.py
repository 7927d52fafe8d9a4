"""Sparse matrices of stencils of nine nodes: their compressed columns by arithmetic, compiled or in NumPy."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...runtime import open_library, threads_for

#: The neighbors of a node, itself included, in the order of the array.
NEIGHBORS = tuple((di, dj) for di in (-1, 0, 1) for dj in (-1, 0, 1))
Indices = npt.NDArray[np.signedinteger[Any]]
_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64


class Sources(NamedTuple):
    """Where the entries of a column are among the planes of a stencil.

    Attributes:
        planes: (9, 2, 2), the plane by neighbor, component of the column and component of the row.
        at_neighbor: (9,), whether it is read at the neighbor, whose row it is, or at the node of the column.
    """

    planes: npt.NDArray[np.int64]
    at_neighbor: npt.NDArray[np.bool_]


def assemble(planes: Array, fixed: Mask, sources: Sources, *, compiled: bool, wide: bool | None = None) -> Any:  # noqa: ANN401
    """Return the matrix (CSC) over the free nodes; unknown 2 k + c is component c of the k-th free node.

    Args:
        planes: the stencil, (planes, ni, nj).
        fixed: the mask of nodes without unknowns, (ni, nj).
        sources: where entries are among the planes.
        compiled: by C, else by NumPy.
        wide: whether rows are numbered in 64 bits; by default where 32 bits do not suffice for all entries.
    """
    from scipy import sparse

    if wide is None:
        wide = 36 * fixed.size > np.iinfo(np.int32).max
    numbers = np.full((fixed.shape[0] + 2, fixed.shape[1] + 2), -1, dtype=np.int64 if wide else np.int32)
    free = fixed == 0
    count = int(np.count_nonzero(free))
    numbers[1:-1, 1:-1][free] = np.arange(count, dtype=numbers.dtype)
    columns = _compiled_columns if compiled else _columns
    values, rows, ends = columns(np.ascontiguousarray(planes, dtype=np.float64), numbers, count, sources)
    matrix = sparse.csc_matrix((values, rows, ends), shape=(2 * count, 2 * count))
    matrix.has_canonical_format = True
    return matrix


def _columns(planes: Array, numbers: Indices, count: int, sources: Sources) -> tuple[Array, Indices, Indices]:
    """Return the values and rows of all columns, and where each ends, in NumPy."""
    width, (i, j) = planes.shape[2], np.nonzero(numbers[1:-1, 1:-1] >= 0)
    beside = np.stack([numbers[i + 1 + di, j + 1 + dj] for di, dj in NEIGHBORS], axis=1)
    rows, values = (np.empty((count, 2, 9, 2), dtype=kind) for kind in (numbers.dtype, np.float64))
    rows[...] = 2 * beside[:, None, :, None] + np.arange(2, dtype=numbers.dtype)
    flat, present = planes.reshape(len(planes), -1), beside >= 0
    for neighbor, (di, dj) in enumerate(NEIGHBORS):
        at = i * width + j
        if sources.at_neighbor[neighbor]:
            at = np.where(present[:, neighbor], at + di * width + dj, 0)
        for column, row in np.ndindex(2, 2):
            values[:, column, neighbor, row] = flat[sources.planes[neighbor, column, row], at]
    ends = np.zeros(2 * count + 1, dtype=numbers.dtype)
    np.cumsum(np.repeat(2 * present.sum(axis=1), 2), out=ends[1:])
    kept = np.broadcast_to(present[:, None, :, None], rows.shape)
    return values[kept], rows[kept], ends


def _compiled_columns(planes: Array, numbers: Indices, count: int, sources: Sources) -> tuple[Array, Indices, Indices]:
    """Return the same, compiled."""
    _, ni, nj = planes.shape
    library = _library(numbers.dtype.itemsize)
    shifts = np.array([di * nj + dj for di, dj in NEIGHBORS])
    places = np.ascontiguousarray(
        sources.planes * (ni * nj) + np.where(sources.at_neighbor, shifts, 0)[:, None, None], dtype=np.int64
    )
    ends = np.empty(2 * count + 1, dtype=numbers.dtype)
    library.count_entries(ni, nj, numbers.ctypes.data, ends.ctypes.data)
    rows, values = np.empty(int(ends[-1]), dtype=numbers.dtype), np.empty(int(ends[-1]))
    arrays = numbers, ends, planes, places, rows, values
    library.fill_entries(ni, nj, threads_for(ni * nj), *(array.ctypes.data for array in arrays))
    return values, rows, ends


@lru_cache(maxsize=2)
def _library(size: int) -> ctypes.CDLL:
    """Compile and load for row numbers of so many bytes."""
    text = (Path(__file__).parent / "assembly.c").read_text(encoding="utf-8")
    library = open_library("assembly", f"#include <stdint.h>\ntypedef int{8 * size}_t Index;\n{text}")
    library.count_entries.argtypes = [_INTEGER, _INTEGER, _POINTER, _POINTER]
    library.fill_entries.argtypes = [_INTEGER] * 3 + [_POINTER] * 6
    library.count_entries.restype = library.fill_entries.restype = None
    return library
