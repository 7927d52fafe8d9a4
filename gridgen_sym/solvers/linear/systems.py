"""Choose the solver of the linear systems of Newton's method: multigrid, or a sparse factorization."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...arrays import Array, Mask
from .factorization import factorize
from .solution import LinearSolver, Solution
from .sparse import assemble_hessian, assemble_jacobian, to_field, to_vector


class DirectSolver:
    """SciPy's sparse LU factorization: for the NumPy backend, where nothing is compiled."""

    def __init__(self, fixed: Mask, assemble: Callable[[Array, Mask], Any]) -> None:
        """Keep the mask of fixed nodes, and what makes a sparse matrix of planes."""
        self._fixed, self._assemble = fixed, assemble
        self._factors: Any = None

    def set_operator(self, planes: Array) -> bool:
        """Factorize; a singular matrix cannot be solved with."""
        self._factors = factorize(self._assemble(planes, self._fixed))
        return self._factors is not None

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve; the curvature along the solution shows whether the operator is positive there."""
        vector = to_vector(right, self._fixed)
        solution = self._factors.solve(vector)
        positive = bool(np.isfinite(solution).all() and solution @ vector > 0)
        return Solution(to_field(solution, self._fixed), 0, 0.0, positive)


def hessian_solver(fixed: Mask, backend: str) -> LinearSolver:
    """Return the solver for Hessians (19 planes): multigrid where C can be compiled, else direct."""
    if backend == "c":
        from .multigrid import Multigrid

        return Multigrid(fixed)
    return DirectSolver(fixed, assemble_hessian)


def jacobian_solver(fixed: Mask, backend: str) -> LinearSolver:
    """Return the solver for Jacobians of the Euler-Lagrange equations (36 planes), likewise."""
    if backend == "c":
        from .multigrid import GeneralMultigrid

        return GeneralMultigrid(fixed)
    return DirectSolver(fixed, assemble_jacobian)
