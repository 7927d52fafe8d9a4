"""The levels of a grid: their choice, their memory, and their setup for a stencil."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ....arrays import Array, Mask
from ....runtime import HESSIAN_PLANES, JACOBIAN_PLANES, threads_for
from .library import Level, Stencil, load_library

#: A direction with this many nodes is not halved further.
_COARSEST = 4
#: A direction whose couplings are weaker than this part of the other's is not halved.
_WEAK = 0.25
#: Rows that are processed together, or sampled for all.
_ROWS = 64
#: Rows begin at multiples of this many numbers. Of long rows these are odd multiples, of twice as many, so that rows do
#: not fall into the same cache lines.
_ALIGNMENT, _LONG = 8, 128
#: Rows of the margin before the first one, two so that a column before its first node exists, and after the last.
MARGIN = (2, 1)


class _Layout(NamedTuple):
    """The positions of entries among the planes of a stencil.

    Attributes:
        planes, pivots: the number of entries of a node, and of the inverse of a pivot.
        center: the entry xx of a node's block with itself.
        couplings: the entries xx and yy of the block with the next node along xi, and of that along eta.
    """

    planes: int
    pivots: int
    center: int
    couplings: tuple[tuple[int, int], tuple[int, int]]


_LAYOUTS: dict[Stencil, _Layout] = {
    "symmetric": _Layout(HESSIAN_PLANES, 3, 0, ((3, 6), (7, 10))),
    "general": _Layout(JACOBIAN_PLANES, 4, 16, ((28, 31), (20, 23))),
}


@dataclass(frozen=True, slots=True)
class LevelArrays:
    """The memory of one level, in single precision: (ni, number of entries, stride) each.

    All are views of arrays with a margin of zeros, and of fixed nodes in the mask: see `MARGIN`.
    """

    fixed: Mask
    operator: Any
    pivots_i: Any
    pivots_j: Any
    right: Any
    solution: Any
    work: Any

    @classmethod
    def allocate(cls, fixed: Mask, layout: _Layout) -> LevelArrays:
        """Allocate for the nodes of a mask."""
        ni, nj = fixed.shape
        stride = stride_of(nj + 1)
        rows = ni + sum(MARGIN)
        counts = layout.planes, layout.pivots, layout.pivots, 2, 2, 2
        # One row more: what is multiplied by the margin's zeros is read from there.
        arrays = (np.zeros((rows + 1, count, stride), dtype=np.float32)[MARGIN[0] : -MARGIN[1] - 1] for count in counts)
        return cls(np.pad(fixed, 1, constant_values=1)[1:-1, 1:-1], *arrays)

    def level(self) -> Level:
        """Return it as the compiled code sees it."""
        mask, stride = self.fixed, self.operator.shape[2]
        arrays = self.operator, self.pivots_i, self.pivots_j, self.right, self.solution, self.work, mask
        pointers = (array.ctypes.data for array in arrays)
        spans = *_span(mask, 0), *_span(mask, 1)
        return Level(*mask.shape, stride, threads_for(mask.size), *pointers, *spans, None, None)

    @property
    def vector_size(self) -> int:
        """How many numbers a vector has, with its margin."""
        return int((self.right.shape[0] + sum(MARGIN)) * self.right[0].size)


def stride_of(count: int) -> int:
    """Return the numbers from row to row for so many columns."""
    if count <= _LONG:
        return -(-count // _ALIGNMENT) * _ALIGNMENT
    return (-(-count // (2 * _ALIGNMENT)) | 1) * 2 * _ALIGNMENT


def _coupling_sizes(level: LevelArrays, layout: _Layout) -> tuple[float, float]:
    """Return the mean size of the couplings of neighbors along xi and along eta."""
    ni, nj = level.fixed.shape
    some = slice(None, None, max(1, ni // _ROWS))  # On a large grid a sample of rows is enough.
    rows, columns = (
        float(sum(np.abs(level.operator[some, entry, :nj]).mean() for entry in pair)) for pair in layout.couplings
    )
    return rows, columns


def _span(mask: Mask, axis: int) -> tuple[int, int]:
    """Return the first and the last, plus one, of the rows or columns with nodes that are not fixed: a side or not."""
    count = mask.shape[axis]
    first, last = (bool(mask.take(at, axis).all()) for at in (0, count - 1))
    return int(first), count - int(last)


class Hierarchy:
    """The levels of one grid: planned and allocated for the first stencil, set up anew for every one.

    Attributes:
        stencil: its kind.
        library: the compiled part.
        arrays, levels: the memory of every level, the finest first, and the levels as the compiled part sees them.
        size: what the finest operator was divided by.
    """

    stencil: Stencil

    def __init__(self, fixed: Mask) -> None:
        """Keep the fixed nodes."""
        self.library = load_library(self.stencil)
        self.arrays: list[LevelArrays] = []
        self.levels: Any = None
        self.size = 1.0
        self._fixed = np.ascontiguousarray(fixed)
        self._layout = _LAYOUTS[self.stencil]
        self._rows = np.empty(0, dtype=np.float32)

    def set_operator(self, planes: Array) -> bool:
        """Take the planes of a stencil.

        Returns:
            Whether the diagonal blocks of all levels are usable: regular, and positive definite if symmetric. Only
            then may `solve` be called.
        """
        self.size = _mean_size(planes[self._layout.center])
        if not 0 < self.size < np.inf:
            return False
        if self.levels is None:
            self._plan(planes)
        else:
            self.library.take_planes(ctypes.byref(self.levels[0]), planes.ctypes.data, 1 / self.size)
            for fine, coarse in pairwise(self.levels):
                self._coarsen(fine, coarse)
        return not any(self.library.factor(ctypes.byref(level)) for level in self.levels)

    def _plan(self, planes: Array) -> None:
        """Choose and set up the levels: a direction is halved unless its couplings are the far weaker ones."""
        self.arrays = [LevelArrays.allocate(self._fixed, self._layout)]
        levels = [self.arrays[0].level()]
        self._rows = np.zeros(levels[0].threads * self.arrays[0].operator[0].size, dtype=np.float32)
        self.library.take_planes(ctypes.byref(levels[0]), planes.ctypes.data, 1 / self.size)
        while max(self.arrays[-1].fixed.shape) > _COARSEST:
            fine = self.arrays[-1]
            self.arrays.append(LevelArrays.allocate(_coarse_mask(fine.fixed, self._directions(fine)), self._layout))
            levels.append(self.arrays[-1].level())
            self._coarsen(*levels[-2:])
        self.levels = (Level * len(levels))(*levels)

    def _directions(self, level: LevelArrays) -> tuple[bool, bool]:
        """Return which directions of a level to halve, rows and columns."""
        rows, columns = _coupling_sizes(level, self._layout)
        large = tuple(count > _COARSEST for count in level.fixed.shape)
        wanted = rows > _WEAK * columns, columns > _WEAK * rows
        halved = large[0] and wanted[0], large[1] and wanted[1]
        return halved if any(halved) else (large[0], large[1])

    def _coarsen(self, fine: Level, coarse: Level) -> None:
        """Set Galerkin's operator of a level from the one above."""
        self.library.coarsen(ctypes.byref(fine), ctypes.byref(coarse), self._rows.ctypes.data)


def _mean_size(plane: Array) -> float:
    """Return the mean of absolute values, few rows at once: fresh memory for a whole plane takes far longer."""
    blocks = (plane[begin : begin + _ROWS] for begin in range(0, len(plane), _ROWS))
    return sum(float(np.abs(block).sum()) for block in blocks) / plane.size


def _coarse_mask(fixed: Mask, halved: tuple[bool, bool]) -> Mask:
    """Return the mask of fixed nodes with every second row, column or both, and the last ones."""
    rows, columns = (
        [*range(0, count - 1, 2), count - 1] if half else list(range(count))
        for count, half in zip(fixed.shape, halved, strict=True)
    )
    return np.ascontiguousarray(fixed[np.ix_(rows, columns)])
