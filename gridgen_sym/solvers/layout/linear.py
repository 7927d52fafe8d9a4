"""The linear systems of several blocks: a sparse factorization, or conjugate gradients with multigrid over blocks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...arrays import Array, Mask
from ...topology.copies import Bond, Copies
from ..linear.solution import LinearSolver, Solution
from .exchange import Exchange
from .sparse import LayoutMatrix


class LayoutDirectSolver:
    """SciPy's sparse LU factorization."""

    def __init__(self, exchange: Exchange, copies: Copies, fixed: Sequence[Mask]) -> None:
        """Number the unknowns."""
        self._exchange, self._matrix = exchange, LayoutMatrix(copies, fixed)
        self._factors: Any = None

    def set_operator(self, planes: list[Array]) -> bool:
        """Factorize; a singular matrix cannot be solved with."""
        from scipy.sparse.linalg import splu

        matrix = self._matrix.assemble(planes)
        if not np.isfinite(matrix.data).all():
            return False
        try:
            self._factors = splu(matrix)
        except RuntimeError:
            return False
        return True

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve; `right` is consistent, one array of all blocks."""
        vector = self._matrix.vector(self._exchange.distributed(right))
        solution = self._factors.solve(vector)
        positive = bool(np.isfinite(solution).all() and solution @ vector > 0)
        field = np.zeros(self._exchange.size)
        self._matrix.spread(solution, field)
        return Solution(field, 0, 0.0, positive)


def layout_solver(
    exchange: Exchange, copies: Copies, fixed: Sequence[Mask], bonds: Sequence[Bond], backend: str
) -> LinearSolver:
    """Return the solver for the Hessians of blocks: multigrid where C can be compiled, else direct."""
    if backend == "c":
        from .multigrid import LayoutMultigrid

        return LayoutMultigrid(exchange, copies, fixed, bonds)
    return LayoutDirectSolver(exchange, copies, fixed)
