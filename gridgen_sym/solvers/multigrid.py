"""Conjugate gradients preconditioned by a geometric multigrid cycle, on the stored Hessian of any ni x nj grid.

Coarse grids keep every second node and the last one; each direction is halved as long as it has more than four
nodes, so that grids of any shape work. The compiled part is `multigrid.c`, which knows no functional.
"""

from __future__ import annotations

import ctypes
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ..runtime import Array, Mask, compile_library, thread_count
from .linear import Solution

_PLANES = 19
#: A direction with this many nodes is not halved further.
_COARSEST = 4
_MOST_ITERATIONS = 200
_NODES_PER_THREAD = 16384


class _Level(ctypes.Structure):
    """One level, as `multigrid.c` declares it."""

    _fields_ = (
        ("ni", ctypes.c_int64),
        ("nj", ctypes.c_int64),
        ("threads", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("operator", "inverse", "right", "solution", "residual", "fixed")),
    )


class Multigrid:
    """The levels of one grid: their memory is kept and their operators are set up anew for every Hessian."""

    def __init__(self, fixed: Mask) -> None:
        """Allocate the levels for a grid with these fixed nodes (its boundary among them)."""
        self._masks = _coarse_masks(fixed)
        self._library = _library()
        threads = thread_count()
        self._levels = (_Level * len(self._masks))()
        self._arrays: list[tuple[Any, ...]] = []
        for level, mask in zip(self._levels, self._masks, strict=True):
            ni, nj = mask.shape
            operator = np.empty((_PLANES, ni, nj), dtype=np.float32)
            inverse = np.empty((3, ni, nj), dtype=np.float32)
            vectors = [np.zeros((2, ni, nj), dtype=np.float32) for _ in range(3)]
            self._arrays.append((operator, inverse, *vectors))
            level.ni, level.nj, level.threads = ni, nj, max(1, min(threads, ni * nj // _NODES_PER_THREAD))
            level.operator, level.inverse = operator.ctypes.data, inverse.ctypes.data
            level.right, level.solution, level.residual = (vector.ctypes.data for vector in vectors)
            level.fixed = mask.ctypes.data
        self._work = np.empty(8 * fixed.size + fixed.shape[0])
        self._operator: Array | None = None

    def set_operator(self, planes: Array) -> bool:
        """Take the stored half (19, ni, nj) of a Hessian, in which couplings with fixed nodes are cut in place.

        Returns:
            Whether the diagonal blocks of all levels are positive definite; only then may `solve` be called.
        """
        ni, nj = self._masks[0].shape
        self._library.decouple(ni, nj, planes.ctypes.data, self._masks[0].ctypes.data)
        self._operator = planes
        size = float(np.abs(planes[0]).mean() + np.abs(planes[2]).mean())
        if not 0 < size < np.inf:
            return False
        finest = self._arrays[0][0]
        self._library.to_single(planes.size, planes.ctypes.data, finest.ctypes.data, 1 / size, self._levels[0].threads)
        for number, level in enumerate(self._levels):
            if number:
                self._coarsen(number)
            if self._library.invert_diagonal(ctypes.byref(level)):
                return False
        return True

    def _coarsen(self, number: int) -> None:
        """Set up Galerkin's operator of a level from the one above, one direction at a time."""
        fine, coarse = self._arrays[number - 1][0], self._arrays[number][0]
        (_, fine_ni, fine_nj), (_, ni, nj) = fine.shape, coarse.shape
        threads = self._levels[number - 1].threads
        rows = fine
        if ni != fine_ni:
            rows = coarse if nj == fine_nj else np.empty((_PLANES, ni, fine_nj), dtype=np.float32)
            self._library.coarsen_rows(fine_ni, fine_nj, fine.ctypes.data, ni, rows.ctypes.data, threads)
        if nj != fine_nj:
            self._library.coarsen_columns(ni, fine_nj, rows.ctypes.data, nj, coarse.ctypes.data, threads)

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a right-hand side (2, ni, nj) that is zero at fixed nodes, to a relative residual."""
        assert self._operator is not None
        solution, reduction = np.empty_like(right), ctypes.c_double(0.0)
        iterations = self._library.conjugate_gradients(
            self._levels,
            len(self._levels),
            self._operator.ctypes.data,
            np.ascontiguousarray(right).ctypes.data,
            solution.ctypes.data,
            self._work.ctypes.data,
            tolerance,
            _MOST_ITERATIONS,
            ctypes.byref(reduction),
        )
        return Solution(solution, abs(iterations), reduction.value, iterations > 0)


def _coarse_masks(fixed: Mask) -> list[Mask]:
    """Return the masks of fixed nodes of all levels, the finest first."""
    masks = [np.ascontiguousarray(fixed)]
    while max(masks[-1].shape) > _COARSEST:
        rows, columns = (
            [*range(0, count - 1, 2), count - 1] if count > _COARSEST else list(range(count))
            for count in masks[-1].shape
        )
        masks.append(np.ascontiguousarray(masks[-1][np.ix_(rows, columns)]))
    return masks


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    source = Path(__file__).with_suffix(".c").read_text(encoding="utf-8")
    library = ctypes.CDLL(str(compile_library("multigrid", source)))
    pointer, integer, number = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
    for name, kinds in {
        "decouple": [integer, integer, pointer, pointer],
        "to_single": [integer, pointer, pointer, number, integer],
        "coarsen_rows": [integer, integer, pointer, integer, pointer, integer],
        "coarsen_columns": [integer, integer, pointer, integer, pointer, integer],
        "invert_diagonal": [pointer],
        "conjugate_gradients": [pointer, integer, pointer, pointer, pointer, pointer, number, integer, pointer],
    }.items():
        function = getattr(library, name)
        function.argtypes = kinds
        function.restype = integer if name in ("invert_diagonal", "conjugate_gradients") else None
    return library
