"""Linear systems with sliding nodes: the grid within a ring of fixed nodes, so that its boundary has unknowns."""

from __future__ import annotations

import numpy as np

from ...arrays import Array, Mask
from ..linear.solution import LinearSolver, Solution
from ..linear.systems import hessian_solver

#: The ring has at least the width of the grid over this.
_PART = 16


class RingedSolver:
    """A solver for Hessians whose boundary nodes have unknowns, too."""

    def __init__(self, mask: Mask, backend: str) -> None:
        """Keep the mask (ni, nj) of nodes without unknowns."""
        self._ring = _width(mask.shape) if backend == "c" else 0
        self._inner: LinearSolver = hessian_solver(np.pad(mask, self._ring, constant_values=1), backend)
        inside = slice(self._ring, -self._ring or None)
        self._within = np.s_[:, inside, inside]

    def set_operator(self, planes: Array) -> bool:
        """Take a stencil; see `LinearSolver`."""
        return self._inner.set_operator(self._padded(planes))

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve; see `LinearSolver`."""
        found = self._inner.solve(self._padded(right), tolerance)
        vector = np.ascontiguousarray(found.vector[self._within])
        return Solution(vector, found.iterations, found.reduction, found.positive)

    def _padded(self, field: Array) -> Array:
        return np.pad(field, ((0, 0), *((self._ring,) * 2,) * 2)) if self._ring else field


def _width(shape: tuple[int, ...]) -> int:
    """Return the width of the ring, a power of two.

    Coarse grids keep every second node: the sides are among them on so many levels, and corrections along them are seen
    there. A wider ring costs more than it brings.
    """
    return int(2 ** max(0, int(np.log2(max(min(shape) / _PART, 1)))))
