"""The linear systems of several blocks: a sparse factorization, or conjugate gradients with multigrid over blocks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...arrays import Array, Mask
from ...topology.copies import Bond, Copies
from ..linear.factorization import factorize
from ..linear.solution import LinearSolver, Solution
from .exchange import Exchange
from .multigrid import LayoutMultigrid
from .sparse import LayoutMatrix

#: So many steps of conjugate gradients are a failure, and so many numbers can be factorized in some seconds.
_MANY, _LARGEST = 40, 800_000


class LayoutDirectSolver:
    """SciPy's sparse LU factorization."""

    def __init__(self, exchange: Exchange, copies: Copies, fixed: Sequence[Mask]) -> None:
        """Number the unknowns."""
        self._exchange, self._matrix = exchange, LayoutMatrix(copies, fixed)
        self._factors: Any = None

    def set_operator(self, planes: list[Array]) -> bool:
        """Factorize; a singular matrix cannot be solved with."""
        self._factors = factorize(self._matrix.assemble(planes))
        return self._factors is not None

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve; `right` is consistent, one array of all blocks."""
        vector = self._matrix.vector(self._exchange.distributed(right))
        solution = self._factors.solve(vector)
        positive = bool(np.isfinite(solution).all() and solution @ vector > 0)
        field = np.zeros(self._exchange.size)
        self._matrix.spread(solution, field)
        return Solution(field, 0, 0.0, positive)


class LayoutIterativeSolver:
    """Multigrid, and where it fails at very thin cells across connections a factorization from then on.

    Columns of thin cells move with a node on a connection, held by couplings that are smaller than the largest ones by
    the square of the aspect ratio: beyond some thousands single precision does not resolve them.
    """

    def __init__(self, multigrid: LayoutMultigrid, direct: Callable[[], LayoutDirectSolver]) -> None:
        """Begin with multigrid; `direct` makes the other solver."""
        self._multigrid, self._make_direct = multigrid, direct
        self._direct: LayoutDirectSolver | None = None
        self._planes: list[Array] = []

    def set_operator(self, planes: list[Array]) -> bool:
        """Take the Hessians of the blocks."""
        self._planes = planes
        return (self._direct or self._multigrid).set_operator(planes)

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve; `right` is consistent, one array of all blocks."""
        if self._direct is not None:
            return self._direct.solve(right, tolerance)
        found = self._multigrid.solve(right, tolerance)
        if (found.positive and found.iterations < _MANY) or not self._may_switch(right):
            return found
        direct = self._make_direct()
        if not direct.set_operator(self._planes):
            return found
        self._direct = direct
        return direct.solve(right, tolerance)

    def _may_switch(self, right: Array) -> bool:
        return right.size <= _LARGEST and self._multigrid.levels[0].crossing.count > 0


def layout_solver(
    exchange: Exchange, copies: Copies, fixed: Sequence[Mask], bonds: Sequence[Bond], backend: str
) -> LinearSolver:
    """Return the solver for the Hessians of blocks: multigrid where C can be compiled, else direct."""

    def direct() -> LayoutDirectSolver:
        return LayoutDirectSolver(exchange, copies, fixed)

    if backend == "c":
        return LayoutIterativeSolver(LayoutMultigrid(exchange, copies, fixed, bonds), direct)
    return direct()
