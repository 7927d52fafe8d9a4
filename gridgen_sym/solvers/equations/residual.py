"""The discrete Euler–Lagrange equations at the free nodes of a grid."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...arrays import Array
from ...grids import corner_jacobians
from ...runtime import KernelSet, Values
from ..norms import norm_of
from ..problem import Problem
from .control import Controlled


@dataclass(slots=True)
class Equations:
    """Residual and Jacobian as functions of the coordinates, and the best grids that an iteration has seen.

    Attributes:
        problem: kernels, values, fixed nodes and the steps of the logical coordinates.
        controlled: the same with control functions, where there are any.
        best: of all grids (False) and of the valid ones (True): the residual's norm and the coordinates.
    """

    problem: Problem
    controlled: Controlled | None = None
    best: dict[bool, tuple[float, Array]] = field(default_factory=dict)
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
        return self.problem.pin(residual)

    def jacobian(self, coordinates: Array) -> Array:
        """Return the planes (36, ni, nj) of the Jacobian, in memory that the next call writes to again."""
        self._planes = self.kernels.euler_lagrange_jacobian(
            coordinates, self.values(coordinates), self.problem.steps, out=self._planes
        )
        return self._planes

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
