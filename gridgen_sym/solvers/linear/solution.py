"""What every linear solver is, and what it returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ...arrays import Array


@dataclass(frozen=True, slots=True)
class Solution:
    """What a linear solver found.

    Attributes:
        vector: (2, ni, nj), zero at fixed nodes.
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

    def set_operator(self, planes: Array) -> bool:
        """Take a stencil (contiguous planes), whose memory is the solver's until the next; return whether it can solve.

        The solutions, too, may be in that memory.
        """
        ...

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a right-hand side (2, ni, nj) that is zero at fixed nodes, to a relative residual."""
        ...
