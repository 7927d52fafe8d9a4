"""The unknowns of a minimum: the nodes that move, of one block or of several, and the linear systems in them.

Fields are flat arrays, of one block (2, ni, nj) and of several as `Exchange` joins them. A field is *consistent* where
all copies of a node have the same vector; a system takes consistent fields to consistent fields.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from ..arrays import Array
from ..solvers.layout.linear import LayoutDirectSolver
from ..solvers.layout.problem import LayoutProblem
from ..solvers.linear.solution import LinearSolver
from ..solvers.linear.sparse import assemble_hessian
from ..solvers.linear.systems import DirectSolver
from .block import BlockDerivatives


class Unknowns(Protocol):
    """The nodes that move."""

    @property
    def blocks(self) -> Sequence[BlockDerivatives]:
        """The derivatives of every block."""

    def views(self, field: Array) -> list[Array]:
        """Return the blocks of a field, (2, ni, nj) each, in its memory."""

    def join(self, blocks: Sequence[Array]) -> Array:
        """Return a field of blocks (2, ni, nj)."""

    def collect(self, field: Array) -> Array:
        """Sum a field over copies, and return what of it unknowns feel, consistent: zero at nodes that stay."""

    def bends(self, field: Array) -> Array:
        """Return what the bends of curves add to the product of the system with a field."""

    def solve(self, solver: LinearSolver, right: Array, tolerance: float) -> Array | None:
        """Solve with the Hessian that a solver has; None where that is not positive."""

    def hessian(self) -> Any:  # noqa: ANN401
        """Return the Hessian as solvers take it."""

    def solvers(self) -> list[Callable[[], LinearSolver]]:
        """Return what makes solvers of systems with it: the solver's own first, then a factorization."""


class BlockUnknowns:
    """Those of one block, whose boundary nodes may slide."""

    def __init__(self, block: BlockDerivatives) -> None:
        """Take the block."""
        self.blocks: Sequence[BlockDerivatives] = (block,)
        self._problem, self._shape = block.problem, block.coordinates.shape
        slide = self._problem.slide
        # Along the curve, per length; `tangential` makes it a vector.
        self._curvature = None if slide is None else slide.curvature(block.gradient(), semidefinite=False)

    def views(self, field: Array) -> list[Array]:
        """Return the one block."""
        return [field.reshape(self._shape)]

    def join(self, blocks: Sequence[Array]) -> Array:
        """Return the one block as a field."""
        return np.ascontiguousarray(blocks[0]).ravel()

    def collect(self, field: Array) -> Array:
        """Return a field that is tangential at sliding nodes, and zero at those that stay."""
        return self._problem.pin(field.reshape(self._shape).copy()).ravel()

    def bends(self, field: Array) -> Array:
        """Return the field along curves, times their curvature."""
        found, slide = np.zeros(self._shape), self._problem.slide
        if slide is not None and self._curvature is not None:
            found[:, *slide.nodes] = self._curvature * slide.tangential(field.reshape(self._shape))
        return found.ravel()

    def solve(self, solver: LinearSolver, right: Array, tolerance: float) -> Array | None:
        """Solve with the Hessian that a solver has; None where that is not positive."""
        solution = solver.solve(right.reshape(self._shape), tolerance)
        return self.collect(solution.vector) if solution.positive else None

    def hessian(self) -> Array:
        """Return the stored half, (19, ni, nj)."""
        return self._problem.hessian(self.blocks[0].coordinates)

    def solvers(self) -> list[Callable[[], LinearSolver]]:
        """Return multigrid, where C can be compiled, and the factorization."""
        return [self._problem.solver, lambda: DirectSolver(self._problem.held, assemble_hessian)]


class LayoutUnknowns:
    """Those of several blocks."""

    def __init__(self, problem: LayoutProblem, blocks: Sequence[BlockDerivatives]) -> None:
        """Take the blocks and what joins them."""
        self.blocks: Sequence[BlockDerivatives] = tuple(blocks)
        self._problem, self._exchange = problem, problem.exchange
        self._held = self._exchange.join([np.stack((mask, mask)) for mask in problem.fixed]) != 0
        slide = problem.slide
        self._curvature = None if slide is None else slide.curvature(self.gradient())

    def gradient(self) -> Array:
        """Return the gradient in all nodes of all blocks, distributed."""
        return self.join([block.gradient() for block in self.blocks])

    def views(self, field: Array) -> list[Array]:
        """Return the blocks of a field."""
        return self._exchange.views(field)

    def join(self, blocks: Sequence[Array]) -> Array:
        """Return a field of blocks."""
        return self._exchange.join(blocks)

    def collect(self, field: Array) -> Array:
        """Return the sums over copies, tangential at nodes that slide, zero at nodes that stay."""
        slide, found = self._problem.slide, field.copy()
        if slide is None:
            found[self._held] = 0.0
            return self._exchange.make_consistent(found)
        self._exchange.make_consistent(found)
        along = self._tangential(found)
        found[self._held] = 0.0
        slide.spread(along, found)
        return found

    def _tangential(self, field: Array) -> Array:
        """Return the tangential part of a consistent field at the nodes that slide."""
        slide = self._problem.slide
        assert slide is not None
        return slide.slide.tangential(slide.first_copies(field))

    def bends(self, field: Array) -> Array:
        """Return the field along curves, times their curvature."""
        found, slide = np.zeros_like(field), self._problem.slide
        if slide is not None and self._curvature is not None:
            slide.spread(self._curvature * self._tangential(field), found)
        return found

    def solve(self, solver: LinearSolver, right: Array, tolerance: float) -> Array | None:
        """Solve with the Hessian that a solver has; None where that is not positive."""
        solution = solver.solve(right, tolerance)
        if not solution.positive:
            return None
        found, slide = solution.vector.copy(), self._problem.slide
        if slide is not None:
            slide.spread(self._tangential(found), found)
        return found

    def hessian(self) -> list[Array]:
        """Return the stored halves of the blocks."""
        return self._problem.hessian(self.join([block.coordinates for block in self.blocks]))

    def solvers(self) -> list[Callable[[], LinearSolver]]:
        """Return multigrid, where C can be compiled, and the factorization."""
        problem = self._problem
        return [problem.solver, lambda: LayoutDirectSolver(self._exchange, problem.copies, problem.held)]
