"""Move nodes towards a density: the boundary slides, the functional is minimised, and a part of the way is taken."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..functionals.definition import Functional
from ..grids import Grid, quality
from ..runtime import Array, Mask
from ..solvers import Weight, optimize
from ..solvers.sampled import grid_field
from .law import weight_values
from .sides import Side, slide

#: How well a grid is solved for a weight that will change, and with how many Newton steps at most.
_INNER_TOLERANCE, _INNER_STEPS = 1e-2, 30
#: The damping is lowered by this factor when the movement grows, down to the least.
_CALMER, _LEAST_DAMPING = 0.7, 0.1
_HALVINGS = 12


@dataclass(slots=True)
class Mover:
    """How nodes are moved.

    Attributes:
        functional: what is minimised.
        law: the power of the density that its weight is, and the degree of what that multiplies.
        parameters: of the functional.
        fixed: mask of the nodes that do not move.
        backend: `c`, `numpy` or the default.
        damping: the share of each move that is taken.
        sides: where boundary nodes slide.
    """

    functional: Functional
    law: tuple[float, float]
    parameters: Mapping[str, float] | None
    fixed: Mask
    backend: str | None
    damping: float
    sides: list[Side]

    def towards(self, grid: Grid, density: Array, moves: int) -> Grid:
        """Return the grid after some moves towards the density (ni, nj) at its nodes; interpolated between moves."""
        moved, there = self._move(grid, density), None
        for _ in range(moves - 1):
            there = there or grid_field(grid, density)
            moved = self._move(moved, there(moved.x, moved.y))
        return moved

    def calm(self) -> None:
        """Take a smaller share of the next moves."""
        self.damping = max(_CALMER * self.damping, min(self.damping, _LEAST_DAMPING))

    def _move(self, start: Grid, density: Array) -> Grid:
        grid = slide(self.sides, start, density, self.fixed, self.damping)
        solved = optimize(
            grid,
            self.functional,
            weight=Weight(weight_values(density, grid, self.law)),
            fixed=self.fixed,
            parameters=self.parameters,
            tolerance=_INNER_TOLERANCE,
            max_iterations=_INNER_STEPS,
            progress=False,
            backend=self.backend,
        )
        if solved.interrupted:
            raise KeyboardInterrupt
        step = self.damping * (solved.grid.planes - grid.planes)
        # A mean of two valid grids need not be valid.
        for _ in range(_HALVINGS):
            moved = Grid.from_planes(*(grid.planes + step))
            if quality(moved).valid:
                return moved
            step /= 2
        return grid


def movement(one: Grid, other: Grid) -> float:
    """Return the farthest way of a node from one grid to another, over the size of the first."""
    size = max(float(np.ptp(one.x)), float(np.ptp(one.y)))
    return float(np.hypot(*(other.planes - one.planes)).max()) / size
