"""The discrete Euler–Lagrange equations at the free nodes of a grid."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...arrays import Array
from ...grids import corner_jacobians
from ...runtime import KernelSet, Values
from ..linear.solution import LinearSolver
from ..linear.sparse import assemble_jacobian, to_field, to_vector
from ..linear.systems import jacobian_solver
from ..norms import norm_of, shortest_edges
from ..problem import Problem
from .control import Controlled

#: The planes of the Jacobian that couple a node with itself.
_OWN = slice(16, 20)
#: Relative residual of the linear solves.
_FORCING = 1e-3


@dataclass(slots=True)
class Equations:
    """Residual and Jacobian as functions of the coordinates, and the best grids that an iteration has seen.

    Attributes:
        problem: kernels, values, fixed nodes and the steps of the logical coordinates.
        controlled: the same with control functions, where there are any.
        best: of all grids (False) and of the valid ones (True): the residual's norm and the coordinates.
        scale: (ni, nj), by which the equations of every node are multiplied; None for no scale.
    """

    problem: Problem
    controlled: Controlled | None = None
    best: dict[bool, tuple[float, Array]] = field(default_factory=dict)
    scale: Array | None = None
    _planes: Array | None = None
    _solver: LinearSolver | None = None

    @property
    def kernels(self) -> KernelSet:
        """The kernels of the equations."""
        return self.controlled.kernels if self.controlled else self.problem.kernels

    @property
    def barrier(self) -> bool:
        """Whether the energy is infinite where J = 0."""
        return self.problem.kernels.barrier

    @property
    def equation_type(self) -> str:
        """`elliptic`, or what the equations are instead."""
        return self.problem.kernels.equation_type

    def values(self, coordinates: Array) -> Values | None:
        """Return what the kernels are given at coordinates."""
        given = self.problem.values(coordinates)
        return self.controlled.values(given) if self.controlled else given

    def residual(self, coordinates: Array) -> Array:
        """Return the residual (2, ni, nj), zero at fixed nodes."""
        residual = self.kernels.euler_lagrange_residual(coordinates, self.values(coordinates), self.problem.steps)
        if self.scale is not None:
            residual *= self.scale
        return self.problem.pin(residual)

    def residual_with(self, coordinates: Array, control: tuple[float, float]) -> Array:
        """Return the residual (2, ni, nj) with other control functions, numbers, at fixed nodes too."""
        assert self.controlled is not None
        planes = np.empty_like(self.controlled.planes)
        planes[0], planes[1] = control
        given = replace(self.controlled, planes=planes).values(self.problem.values(coordinates))
        return self.kernels.euler_lagrange_residual(coordinates, given, self.problem.steps)

    def jacobian(self, coordinates: Array) -> Array:
        """Return the planes (36, ni, nj) of the Jacobian, in memory that the next call writes to again."""
        self._planes = self.kernels.euler_lagrange_jacobian(
            coordinates, self.values(coordinates), self.problem.steps, out=self._planes
        )
        if self.scale is not None:
            self._planes *= self.scale
        return self._planes

    def measure_locally(self, coordinates: Array) -> None:
        """Scale the equations so that a residual of 1 is about a move by the length of the shortest edge at the node.

        Else those of the longest edges alone decide where cells are of very different size.
        """
        self.scale = None
        own = self.jacobian(coordinates)[_OWN]
        size = np.sqrt((own * own).sum(axis=0)) * shortest_edges(coordinates)
        self.scale = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0)

    def round_off(self, coordinates: Array) -> float:
        """Return the norm below which a residual cannot be distinguished from zero."""
        rows = np.zeros_like(coordinates[:1])
        for plane in self.jacobian(coordinates):
            rows[0] += np.abs(plane)
        size = float(np.abs(coordinates).max())
        return 10 * float(np.finfo(float).eps) * size * norm_of(self.problem.pin(rows))

    def norm(self, residual: Array) -> float:
        """Return the norm of a residual."""
        return norm_of(residual)

    def smallest(self, coordinates: Array) -> float:
        """Return the smallest Jacobian."""
        return float(corner_jacobians(coordinates[0], coordinates[1]).min())

    def refresh(self, coordinates: Array) -> None:
        """Evaluate what is held while the nodes move."""
        self.problem.refresh(coordinates)

    def direction(self, coordinates: Array, residual: Array) -> Array:
        """Return Newton's step; NaN where the Jacobian is singular."""
        if self._solver is None:
            self._solver = jacobian_solver(self.problem.fixed, self.problem.kernels.backend)
        usable = self._solver.set_operator(self.jacobian(coordinates))
        return self._solver.solve(-residual, _FORCING).vector if usable else np.full_like(residual, np.nan)

    @property
    def width(self) -> int:
        """About how many nodes lie along a line across the grid."""
        return int(max(self.problem.fixed.shape))

    def sweep(self, coordinates: Array, factor: float) -> None:
        """Relax all nodes once, in place, in four colors."""
        problem = self.problem
        for color in range(4):
            self.kernels.euler_lagrange_relaxation(
                coordinates, self.values(coordinates), problem.fixed, color, factor, problem.steps
            )

    def linearized(self, coordinates: Array, residual: Array) -> tuple[Any, Array]:
        """Return the Jacobian as a sparse matrix, and the residual as a vector of unknowns."""
        fixed, compiled = self.problem.fixed, self.problem.kernels.backend == "c"
        return assemble_jacobian(self.jacobian(coordinates), fixed, compiled=compiled), to_vector(residual, fixed)

    def field(self, vector: Array) -> Array:
        """Return a vector of unknowns as a step of the coordinates."""
        return to_field(vector, self.problem.fixed)

    def remember(self, coordinates: Array, norm: float) -> float:
        """Keep the grid if it is the best so far, or the best valid one; return its smallest Jacobian."""
        return keep_best(self.best, coordinates, norm, self.smallest(coordinates))


def keep_best(best: dict[bool, tuple[float, Array]], coordinates: Array, norm: float, smallest: float) -> float:
    """Keep a grid if it is the best so far (False), or the best valid one (True); return its smallest Jacobian."""
    for valid in {False, smallest > 0}:
        if valid not in best or norm < best[valid][0]:
            best[valid] = norm, coordinates.copy()
    return smallest
