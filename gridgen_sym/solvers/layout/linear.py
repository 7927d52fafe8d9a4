"""The linear systems of several blocks: a sparse factorization, or conjugate gradients with multigrid over blocks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
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
#: Where the square of height over length of cells across a connection is less, single precision may fail.
_THIN = 1e-4


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
    """Multigrid; where single precision fails at very thin cells across connections, in double precision from then on.

    Columns of thin cells move with a node on a connection, held by couplings that are smaller than the largest ones by
    the square of the aspect ratio: beyond some thousands single precision does not resolve them. Where double precision
    does not, either, a factorization takes over, unless there are too many nodes.
    """

    def __init__(self, make: Callable[..., LayoutMultigrid], direct: Callable[[], LayoutDirectSolver]) -> None:
        """Begin with single precision; `make` makes a multigrid, `direct` the last resort."""
        self._now: LayoutMultigrid | LayoutDirectSolver = make()
        self._precise: LayoutMultigrid | None = None
        self._make, self._make_direct, self._planes = make, direct, list[Array]()

    def set_operator(self, planes: list[Array]) -> bool:
        """Take the Hessians of the blocks."""
        self._planes = planes
        return self._now.set_operator(planes)

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve; `right` is consistent, one array of all blocks."""
        now, found = self._now, self._now.solve(right, tolerance)
        if _is_good(found) or isinstance(now, LayoutDirectSolver) or now.levels[0].crossing.weakest > _THIN:
            return found
        if now is not self._precise:
            self._precise = self._precise or self._make(precise=True)
            if not self._precise.set_operator(self._planes):
                return found
            again = self._precise.solve(right, tolerance)
            if _is_good(again):
                self._now = self._precise
                return again
            if not again.positive:  # It is the Hessian that is not.
                return found
            found = again
        return found if right.size > _LARGEST else self._solve_directly(right, tolerance, found)

    def _solve_directly(self, right: Array, tolerance: float, found: Solution) -> Solution:
        direct = self._make_direct()
        if not direct.set_operator(self._planes):
            return found
        self._now = direct
        return direct.solve(right, tolerance)


def _is_good(found: Solution) -> bool:
    return found.positive and found.iterations < _MANY


def layout_solver(
    exchange: Exchange, copies: Copies, fixed: Sequence[Mask], bonds: Sequence[Bond], backend: str
) -> LinearSolver:
    """Return the solver for the Hessians of blocks: multigrid where C can be compiled, else direct."""

    def direct() -> LayoutDirectSolver:
        return LayoutDirectSolver(exchange, copies, fixed)

    if backend == "c":
        return LayoutIterativeSolver(partial(LayoutMultigrid, exchange, copies, fixed, bonds), direct)
    return direct()
