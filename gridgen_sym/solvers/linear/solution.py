"""What every linear solver is, and what it returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from ...arrays import Array


@dataclass(frozen=True, slots=True)
class Solution:
    """What a linear solver found.

    Attributes:
        vector: of the shape of the coordinates, zero at fixed nodes.
        iterations: number of products with the operator; 0 for a direct solver.
        reduction: of the residual's norm.
        positive: whether the operator, and what it is preconditioned by, was positive along every direction that was
            met; else `vector` is the last of these.
    """

    vector: Array
    iterations: int
    reduction: float
    positive: bool


class LinearSolver(Protocol):
    """Solves with a stencil over the free nodes, given by its planes: of a Hessian, or of a Jacobian."""

    def set_operator(self, planes: Any) -> bool:  # noqa: ANN401
        """Take a stencil (contiguous planes, or those of each block); return whether it can solve.

        Its memory is the solver's until the next.

        The solutions, too, may be in that memory.
        """
        ...

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a right-hand side, zero at fixed nodes, of the coordinates' shape, to a relative residual."""
        ...
