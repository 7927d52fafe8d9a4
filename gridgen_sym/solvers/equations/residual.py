"""The discrete Euler–Lagrange equations at the free nodes of a grid."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ...arrays import Array
from ...grids import corner_jacobians
from ...runtime import KernelSet, Values
from ..norms import norm_of, shortest_edges
from ..problem import Problem
from .control import Controlled

#: The planes of the Jacobian that couple a node with itself.
_OWN = slice(16, 20)


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

    @property
    def kernels(self) -> KernelSet:
        """The kernels of the equations."""
        return self.controlled.kernels if self.controlled else self.problem.kernels

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

    def remember(self, coordinates: Array, norm: float) -> float:
        """Keep the grid if it is the best so far, or the best valid one; return its smallest Jacobian."""
        smallest = float(corner_jacobians(coordinates[0], coordinates[1]).min())
        for valid in {False, smallest > 0}:
            if valid not in self.best or norm < self.best[valid][0]:
                self.best[valid] = norm, coordinates.copy()
        return smallest
