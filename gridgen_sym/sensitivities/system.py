"""The linear systems of derivatives of a grid, solved nearly to rounding.

The solver's multigrid works in single precision, and stores the Hessian so. Its solutions are refined with products in
double precision; where values are held while nodes move the system is not symmetric, and the Hessian preconditions it.
"""

from __future__ import annotations

import inspect
from contextlib import suppress

import numpy as np

from ..arrays import Array
from ..errors import GridgenError
from ..solvers.linear.solution import LinearSolver
from .unknowns import Unknowns

#: The relative residual of one solve in single precision, whose rounding leaves some thousandths on fine grids.
_ONCE = 3e-3
#: The best relative residual that is asked for, and the worst that is accepted where rounding lets it be no better.
_BEST, _ACCEPTED = 1e-12, 1e-8
#: Refinements, each of which must reduce the residual by this factor; else a Krylov method takes over.
_REFINEMENTS, _REDUCES = 12, 0.25
#: How often a Krylov method restarts.
_RESTARTS = 10


class System:
    """The derivative of the gradient in the unknowns at a minimum, and its transpose."""

    def __init__(self, unknowns: Unknowns, tolerance: float) -> None:
        """Set up the solver.

        Args:
            unknowns: the nodes that move.
            tolerance: relative residual of solutions.

        Raises:
            GridgenError: where the Hessian is singular, or not positive.
        """
        self.unknowns, self._tolerance = unknowns, max(tolerance, _BEST)
        self._accepted = max(10 * self._tolerance, _ACCEPTED)
        self._symmetric = all(block.symmetric for block in unknowns.blocks)
        self._makers = unknowns.solvers()
        self._solver = self._next_solver()

    def _next_solver(self) -> LinearSolver:
        """Return the next solver that takes the Hessian."""
        while self._makers:
            solver = self._makers.pop(0)()
            if solver.set_operator(self.unknowns.hessian()):
                return solver
        raise _singular()

    def product(self, field: Array, *, transposed: bool) -> Array:
        """Return the system's product with a consistent field."""
        unknowns = self.unknowns
        parts = [
            block.transposed(view) if transposed else block.product(view)
            for block, view in zip(unknowns.blocks, unknowns.views(field), strict=True)
        ]
        return unknowns.collect(unknowns.join(parts)) + unknowns.bends(field)

    def solve(self, right: Array, *, transposed: bool) -> Array:
        """Solve for a consistent field.

        Raises:
            GridgenError: where the Hessian is singular, or not positive.
        """
        size = _norm(right)
        if not size > 0:
            return np.zeros_like(right)
        if not np.isfinite(size):
            raise GridgenError("a derivative of the grid is asked for along numbers that are not finite: check them")
        while True:
            with suppress(_NotPositiveError):
                found = self._refined(right, size) if self._symmetric else None
                found = self._krylov(right, size, transposed=transposed) if found is None else found
                if found is not None:
                    return found
            self._solver = self._next_solver()  # Raises where there is no other.

    def _step(self, right: Array, tolerance: float) -> Array:
        step = self.unknowns.solve(self._solver, right, tolerance)
        if step is None:
            raise _NotPositiveError
        return step

    def _refined(self, right: Array, size: float) -> Array | None:
        """Return the solution of the symmetric system by iterative refinement; None where that does not converge."""
        found, rest, before = np.zeros_like(right), right, size
        for _ in range(_REFINEMENTS):
            trial = found + self._step(rest, max(_ONCE, 0.5 * self._tolerance * size / before))
            rest = right - self.product(trial, transposed=False)
            norm = _norm(rest)
            if not norm < before:
                break
            found, slow, before = trial, norm > _REDUCES * before, norm
            if norm <= self._tolerance * size or slow:
                break
        return found if before <= self._accepted * size else None

    def _krylov(self, right: Array, size: float, *, transposed: bool) -> Array | None:
        """Return the solution by a flexible Krylov method (GCROT), preconditioned by solves with the Hessian."""
        from scipy.sparse.linalg import LinearOperator, gcrotmk

        def precondition(vector: Array) -> Array:
            return self._step(vector, _ONCE) if vector.any() else vector

        def multiply(vector: Array) -> Array:
            return self.product(vector, transposed=transposed)

        shape = (right.size, right.size)
        system, inverse = (LinearOperator(shape, function, dtype=float) for function in (multiply, precondition))
        tolerance = "rtol" if "rtol" in inspect.signature(gcrotmk).parameters else "tol"
        found, _ = gcrotmk(system, right, M=inverse, atol=0.0, maxiter=_RESTARTS, **{tolerance: self._tolerance})
        return found if _norm(right - multiply(found)) <= self._accepted * size else None


class _NotPositiveError(Exception):
    """A solver has met a direction along which the Hessian, or what preconditions it, is not positive."""


def _norm(field: Array) -> float:
    """Return the norm, not by BLAS, whose threads would keep spinning where those of kernels work."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(np.einsum("n,n->", field, field)))


def _singular() -> GridgenError:
    return GridgenError(
        "the grid has no derivatives: the Hessian of the energy at it is singular, or not positive, so that it is no "
        "isolated minimum. Nodes that slide on a ring may turn, and functionals that are not elliptic leave nodes "
        "free; hold some nodes, or take a functional that is elliptic"
    )
