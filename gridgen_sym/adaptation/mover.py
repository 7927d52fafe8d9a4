"""Move nodes toward a density: the boundary slides, and the functional is minimized with a damped weight.

It is the weight that is damped, by geometric means of the last one and the one that is wanted, and not the way of the
nodes: every grid is then a minimum of the functional, as valid as its barrier makes it, where the mean of two valid
grids may be folded. How much is taken follows from the last two steps by Aitken's rule (B. M. Irons and R. C. Tuck, "A
version of the Aitken accelerator for computer iteration", 1969; U. Küttler and W. A. Wall 2008 for fields): more than
the first share where steps agree, less where they turn back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array, Mask
from ..fields import Weight
from ..fields.sampled import grid_field, nodal
from ..functionals.definition import Functional
from ..grids import Grid
from ..solvers import optimize
from ..solvers.run.deadline import Deadline
from .equidistribution import cell_areas
from .law import weight_values
from .sides import Side, slide

#: How well a grid is solved for a weight that will change, and with how many Newton steps at most.
_INNER_TOLERANCE, _INNER_STEPS = 1e-2, 30
#: Between these Aitken's rule chooses the damping: above 1 the weight goes farther than is wanted.
_LEAST_DAMPING, _MOST_DAMPING = 0.1, 2.0


@dataclass(slots=True)
class Mover:
    """How nodes are moved.

    Attributes:
        functional: what is minimized.
        law: the power of the density that its weight is, and the degree of what that multiplies.
        parameters: of the functional.
        fixed: mask of the nodes that do not move.
        backend: `c`, `numpy` or the default.
        damping: the share of what is wanted in the next weight; the first one is given, others follow.
        sides: where boundary nodes slide.
        deadline: of the adaptation.
        weight: the last weight (ni, nj); at first that under which the start is equidistributed.
        trouble: why the last minimization stopped early, or nothing.
        lack: (ni, nj), the logarithm of what was wanted over the weight before, in the last move.
    """

    functional: Functional
    law: tuple[float, float]
    parameters: Mapping[str, float] | None
    fixed: Mask
    backend: str | None
    damping: float
    sides: list[Side]
    deadline: Deadline = field(default_factory=Deadline)
    weight: Array | None = None
    trouble: str = ""
    lack: Array | None = None

    def toward(self, grid: Grid, density: Array, moves: int) -> Grid:
        """Return the grid after some moves toward the density (ni, nj) at its nodes; interpolated between moves.

        Raises:
            StopRequest: when the time is over.
            KeyboardInterrupt: after Ctrl-C.
        """
        moved, there = self._move(grid, density), None
        for _ in range(moves - 1):
            there = there or grid_field(grid, density)
            moved = self._move(moved, there(moved.x, moved.y))
        return moved

    def _move(self, start: Grid, density: Array) -> Grid:
        if self.weight is None:
            self.weight = weight_values(nodal(1 / cell_areas(start)), start, self.law)
        grid = slide(self.sides, start, density, self.fixed, min(self.damping, 1.0))
        lack = np.log(weight_values(density, grid, self.law) / self.weight)
        self._choose_damping(lack)
        self.weight = self.weight * np.exp(self.damping * lack)
        solved = optimize(
            grid,
            self.functional,
            weight=Weight(self.weight),
            fixed=self.fixed,
            parameters=self.parameters,
            tolerance=_INNER_TOLERANCE,
            max_iterations=_INNER_STEPS,
            progress=False,
            time_limit=self.deadline.check(),
            backend=self.backend,
        )
        if solved.interrupted:
            self.deadline.check()
            raise KeyboardInterrupt
        self.trouble = "" if solved.converged else solved.message
        return solved.grid

    def _choose_damping(self, lack: Array) -> None:
        """Set the share that would have left the least of the lack, had the last move taken it."""
        if self.lack is not None:
            change = lack - self.lack
            size = float((change**2).sum())
            if size > 0:
                best = -self.damping * float((self.lack * change).sum()) / size
                self.damping = float(np.clip(best, min(_LEAST_DAMPING, self.damping), _MOST_DAMPING))
        self.lack = lack


def movement(one: Grid, other: Grid) -> float:
    """Return the farthest way of a node from one grid to another, over the size of the first."""
    size = max(float(np.ptp(one.x)), float(np.ptp(one.y)))
    return float(np.hypot(*(other.planes - one.planes)).max()) / size
