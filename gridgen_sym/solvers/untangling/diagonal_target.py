"""A diagonal target: the lengths of edges relative to which a barrier is regularized."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Mask
from ...grids import corner_jacobians, folded_corners
from ...runtime.values import Values
from ..folds import Folds


@dataclass(frozen=True, slots=True)
class DiagonalTarget:
    """The inverses V of target matrices W that are diagonal: edges of given lengths, at right angles.

    Attributes:
        values: V, as kernels read it.
        determinants: of V, (4, ni-1, nj-1), corners as in `corner_jacobians`.
    """

    values: Values
    determinants: Array

    @classmethod
    def of_edges(cls, along_xi: Array, along_eta: Array) -> DiagonalTarget:
        """Return the target of some edge lengths, each (4, ni-1, nj-1), positive; corners as in `corner_jacobians`."""
        _, ni, nj = along_xi.shape
        zero = np.zeros_like(along_xi)
        values = Values.of([1 / along_xi, zero, zero, 1 / along_eta], (ni + 1, nj + 1))
        return cls(values, 1 / (along_xi * along_eta))

    def folds(self, coordinates: Array, fixed: Mask) -> Folds:
        """Count the folds that moving the free nodes may repair; their depth is relative to the target."""
        jacobians = self._jacobians(coordinates)
        jacobians[Folds.held_corners(fixed)] = np.inf
        cells = int(np.count_nonzero(folded_corners(jacobians).any(axis=0)))
        return Folds(cells, -float(jacobians.min()))

    def mean_jacobian(self, coordinates: Array) -> float:
        """Return the mean of the absolute Jacobians, relative to the target."""
        return float(np.abs(self._jacobians(coordinates)).mean())

    def _jacobians(self, coordinates: Array) -> Array:
        return np.asarray(corner_jacobians(*coordinates) * self.determinants)
