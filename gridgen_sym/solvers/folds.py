"""How badly a grid is folded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array, Mask
from ..grids import corner_jacobians, folded_corners

#: Folds are counted among so many nodes at once, whose Jacobians stay in the processor's cache.
_NUMBERS = 4096
#: So many rows of cells are sampled for the mean of all.
_SOME_ROWS = 32
#: Relative to the largest: below it, rounding may decide the sign of a Jacobian.
_DOUBTFUL = 1e-12


@dataclass(frozen=True, slots=True, order=True)
class Folds:
    """How badly a grid is folded; the smaller of two is the better one.

    Attributes:
        cells: with a corner where J <= 0 (or is not a number).
        depth: minus the smallest Jacobian.
    """

    cells: int
    depth: float

    @classmethod
    def of(cls, coordinates: Array, fixed: Mask | None = None, rows: Array | None = None) -> Folds:
        """Count the folds of a grid.

        Args:
            coordinates: (2, ni, nj).
            fixed: (ni, nj), non-zero at nodes that do not move; then only folds count that moving others may repair.
            rows: (ni - 1,), the smallest Jacobian of each row of cells, where that is known: where it is clearly
                positive nothing is computed.
        """
        looked_at = np.ones(coordinates.shape[1] - 1, dtype=bool)
        cells, smallest = 0, np.inf
        if rows is not None:
            looked_at = ~(rows > _DOUBTFUL * np.abs(rows).max())
            smallest = float(rows.min(initial=np.inf, where=~looked_at))
        for block in _blocks(looked_at, max(1, _NUMBERS // coordinates.shape[2])):
            jacobians = corner_jacobians(coordinates[0, block], coordinates[1, block])
            if fixed is not None:
                jacobians[cls.held_corners(fixed[block])] = np.inf
            cells += int(np.count_nonzero(folded_corners(jacobians).any(axis=0)))
            smallest = min(smallest, float(jacobians.min()))
        return cls(cells, -smallest)

    @staticmethod
    def held_corners(fixed: Mask) -> npt.NDArray[np.bool_]:
        """Return, as `corner_jacobians` orders them, the corners whose three nodes are all fixed: their J is given."""
        held = fixed != 0
        nodes = held[:-1, :-1], held[1:, :-1], held[1:, 1:], held[:-1, 1:]
        return np.stack([nodes[k - 1] & nodes[k] & nodes[(k + 1) % 4] for k in range(4)])


def mean_jacobian(coordinates: Array) -> float:
    """Return the mean of the absolute Jacobians of the corners of (2, ni, nj) coordinates; of a large grid, of some."""
    _, ni, nj = coordinates.shape
    rows = np.zeros(ni - 1, dtype=bool)
    rows[:: max(1, ni // _SOME_ROWS) if ni * nj > _NUMBERS else 1] = True
    blocks = _blocks(rows, max(1, _NUMBERS // nj))
    total = sum(float(np.abs(corner_jacobians(*coordinates[:, block])).sum()) for block in blocks)
    return total / float(4 * np.count_nonzero(rows) * (nj - 1))


def _blocks(looked_at: npt.NDArray[np.bool_], most: int) -> Iterator[slice]:
    """Return the rows of nodes of neighboring rows of cells that are looked at, at most so many of these at once."""
    rows = np.flatnonzero(looked_at)
    for run in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
        for first in run[::most].tolist():
            yield slice(first, min(first + most, int(run[-1]) + 1) + 1)
