"""Move nodes towards a density: the boundary slides, and the functional is minimised with a damped weight.

It is the weight that is damped, by geometric means of the last one and the one that is wanted, and not the way of the
nodes: every grid is then a minimum of the functional, as valid as its barrier makes it, where the mean of two valid
grids may be folded.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..functionals.definition import Functional
from ..grids import Grid
from ..runtime import Array, Mask
from ..solvers import Weight, optimize
from ..solvers.sampled import grid_field, nodal
from .equidistribution import cell_areas
from .law import weight_values
from .sides import Side, slide

#: How well a grid is solved for a weight that will change, and with how many Newton steps at most.
_INNER_TOLERANCE, _INNER_STEPS = 1e-2, 30
#: The damping is lowered by this factor when the movement grows, down to the least.
_CALMER, _LEAST_DAMPING = 0.7, 0.1


@dataclass(slots=True)
class Mover:
    """How nodes are moved.

    Attributes:
        functional: what is minimised.
        law: the power of the density that its weight is, and the degree of what that multiplies.
        parameters: of the functional.
        fixed: mask of the nodes that do not move.
        backend: `c`, `numpy` or the default.
        damping: the share of what is wanted in the next weight.
        sides: where boundary nodes slide.
        weight: the last weight (ni, nj); at first that under which the start is equidistributed.
        trouble: why the last minimisation stopped early, or nothing.
    """

    functional: Functional
    law: tuple[float, float]
    parameters: Mapping[str, float] | None
    fixed: Mask
    backend: str | None
    damping: float
    sides: list[Side]
    weight: Array | None = None
    trouble: str = ""

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
        if self.weight is None:
            self.weight = weight_values(nodal(1 / cell_areas(start)), start, self.law)
        grid = slide(self.sides, start, density, self.fixed, self.damping)
        wanted = weight_values(density, grid, self.law)
        self.weight = self.weight ** (1 - self.damping) * wanted**self.damping
        solved = optimize(
            grid,
            self.functional,
            weight=Weight(self.weight),
            fixed=self.fixed,
            parameters=self.parameters,
            tolerance=_INNER_TOLERANCE,
            max_iterations=_INNER_STEPS,
            progress=False,
            backend=self.backend,
        )
        if solved.interrupted:
            raise KeyboardInterrupt
        self.trouble = "" if solved.converged else solved.message
        return solved.grid


def movement(one: Grid, other: Grid) -> float:
    """Return the farthest way of a node from one grid to another, over the size of the first."""
    size = max(float(np.ptp(one.x)), float(np.ptp(one.y)))
    return float(np.hypot(*(other.planes - one.planes)).max()) / size
