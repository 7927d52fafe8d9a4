"""Krylov methods preconditioned by a geometric multigrid cycle, on the stencils of any ni x nj grid.

Coarse grids keep every second node and the last one. Where couplings along one direction are far weaker, as on
stretched grids, only the other direction is halved, until they are alike. Lines of nodes are relaxed, so that cells may
be stretched. The compiled part, the C files here, knows no functional.
"""

from __future__ import annotations

import ctypes

import numpy as np

from ...runtime import Array, Mask
from ..linear import Solution
from .hierarchy import Hierarchy

_MOST_ITERATIONS = 200


class _Krylov(Hierarchy):
    """A Krylov method on the finest level of a hierarchy.

    Attributes:
        vectors, sums: how many vectors, and how many numbers per row, its compiled part works with.
    """

    vectors: int
    sums: int

    def __init__(self, fixed: Mask) -> None:
        """Allocate for a grid with these fixed nodes (its boundary among them)."""
        super().__init__(fixed)
        self._work = np.zeros(0)

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a right-hand side (2, ni, nj) that is zero at fixed nodes, to a relative residual."""
        if not self._work.size:
            self._work = np.zeros(self.vectors * self.arrays[0].right.size + self.sums * right.shape[1])
        solution, reduction = np.empty_like(right), ctypes.c_double(0.0)
        iterations = self.library.solve(
            self.levels,
            len(self.levels),
            np.ascontiguousarray(right).ctypes.data,
            solution.ctypes.data,
            self._work.ctypes.data,
            tolerance,
            _MOST_ITERATIONS,
            1 / self.size,
            ctypes.byref(reduction),
        )
        return Solution(solution, abs(iterations), reduction.value, iterations >= 0 and bool(reduction.value < 1))


class Multigrid(_Krylov):
    """Conjugate gradients for the stored half (19, ni, nj) of a Hessian."""

    stencil, vectors, sums = "symmetric", 4, 3


class GeneralMultigrid(_Krylov):
    """BiCGStab for the 36 planes of the Euler-Lagrange Jacobian."""

    stencil, vectors, sums = "general", 6, 2
