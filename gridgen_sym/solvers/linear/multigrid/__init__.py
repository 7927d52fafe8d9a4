"""Krylov methods preconditioned by a geometric multigrid cycle, on the stencils of any ni x nj grid.

Coarse grids keep every second node and the last one. Where couplings along one direction are far weaker, as on
stretched grids, only the other direction is halved, until they are alike. Lines of nodes are relaxed, so that cells may
be stretched. The compiled part, the C files here, is independent of the functional.
"""

from __future__ import annotations

import ctypes

import numpy as np

from ....arrays import Array
from ..solution import Solution
from .hierarchy import Hierarchy

_MOST_ITERATIONS = 200


class _Krylov(Hierarchy):
    """A Krylov method on the finest level of a hierarchy.

    Attributes:
        vectors, sums: how many vectors, and how many numbers per row, its compiled part works with.
    """

    vectors: int
    sums: int

    def set_operator(self, planes: Array) -> bool:
        """Take the planes of a stencil, as a hierarchy does; their memory is then what `solve` works in.

        They are the largest array of all and are no longer needed. Fresh memory costs more time than the arithmetic.
        """
        if not super().set_operator(planes):
            return False
        work, field = self.vectors * self.arrays[0].vector_size + self.sums * planes.shape[1], planes[:2]
        block = planes.ravel() if planes.size >= field.size + work else np.empty(field.size + work)
        self._solution, self._work = block[: field.size].reshape(field.shape), block[field.size :]
        return True

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a right-hand side (2, ni, nj) that is zero at fixed nodes, to a relative residual."""
        solution, reduction = self._solution, ctypes.c_double(0.0)
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
