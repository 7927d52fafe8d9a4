"""Move nodes toward a density: the functional is minimized with a damped weight, and boundary nodes slide with it.

The weight is damped, by geometric means of the last one and the one of the density, and not the displacement of the
nodes: every grid is then a minimum of the functional, as valid as its barrier makes it, while the mean of two valid
grids may be folded. The damping follows from the last two steps by Aitken's rule (B. M. Irons and R. C. Tuck, "A
version of the Aitken accelerator for computer iteration", 1969; U. Küttler and W. A. Wall 2008 for fields): it grows
where steps agree, and falls where they turn back.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from ..arrays import Array
from ..fields.sampled import grid_field
from ..functionals.definition import Functional
from ..grids import Grid
from ..solvers import energy, optimize
from ..solvers.run.deadline import Deadline
from ..topology import MultiBlock
from .layout_nodes import nodes_of
from .lines import LineSpacing
from .nodes import Nodes
from .sides import SideSpacing
from .weight_exponent import WeightExponent, weight_values

#: The tolerance and the most Newton steps of one minimization: the weight changes after it, so that more is wasted.
_INNER_TOLERANCE, _INNER_STEPS = 1e-2, 30
#: Aitken's rule chooses the damping between these; above 1 the weight is extrapolated.
_LEAST_DAMPING, _MOST_DAMPING = 0.1, 2.0

SomeGrid = TypeVar("SomeGrid", Grid, MultiBlock)


@dataclass(slots=True)
class Mover:
    """How nodes are moved.

    Attributes:
        functional: what is minimized.
        weight_exponent: of the functional.
        given: what else the functional takes, as `optimize` does: `parameters`, `fields` and `target`.
        fixed: mask of the nodes that do not move; of several blocks by name.
        backend: `c`, `numpy` or the default.
        damping: how far the next weight goes to the one of the density; the first one is given, others follow.
        sides: where boundary nodes slide, and how they are spaced.
        deadline: of the adaptation.
        weight: the last weight, at the nodes; at first that under which the start is equidistributed.
        energy: the size of the functional's energy with that.
        failure: why the last minimization did not converge, or nothing.
        residual: of the last move, at the nodes: the logarithm of the density's weight over the weight before.
    """

    functional: Functional
    weight_exponent: WeightExponent
    given: Mapping[str, Any]
    fixed: Any
    backend: str | None
    damping: float
    sides: SideSpacing | LineSpacing
    deadline: Deadline = field(default_factory=Deadline)
    weight: Array | None = None
    energy: float | None = None
    failure: str = ""
    residual: Array | None = None

    def toward(self, grid: SomeGrid, density: Array, moves: int) -> SomeGrid:
        """Return the grid after some moves toward the density at its nodes; interpolated between moves.

        Several blocks are moved once.

        Raises:
            StopRequest: when the time is over.
            KeyboardInterrupt: after Ctrl-C.
        """
        moved: SomeGrid = self._move(grid, density)
        there = None
        if not isinstance(grid, MultiBlock):
            for _ in range(moves - 1):
                there = there or grid_field(grid, density)
                moved = self._move(moved, there(moved.x, moved.y))
        return moved

    def _move(self, start: Any, density: Array) -> Any:  # noqa: ANN401 - a grid of one block or several
        nodes = nodes_of(start)
        if self.weight is None:
            self.weight = weight_values(nodes.at_nodes(1 / nodes.areas), nodes, self.weight_exponent)
        residual = np.log(weight_values(density, nodes, self.weight_exponent) / self.weight)
        size = self._size(start, nodes) if self.sides.curves else 1.0
        self._choose_damping(residual)
        slide = self.sides.toward(start, density, self.damping, size) if self.sides.curves else None
        self.weight = self.weight * np.exp(self.damping * residual)
        solved: Any = optimize(
            start,
            self.functional,
            weight=nodes.weights(self.weight),
            slide=slide,
            fixed=self.fixed,
            tolerance=_INNER_TOLERANCE,
            max_iterations=_INNER_STEPS,
            progress=False,
            time_limit=self.deadline.check(),
            backend=self.backend,
            **self.given,
        )
        if solved.interrupted:
            self.deadline.check()
            raise KeyboardInterrupt
        self.failure = "" if solved.converged else solved.message
        return solved.grid

    def _size(self, grid: Any, nodes: Nodes) -> float:  # noqa: ANN401
        """Return the size of the functional's energy, as it is under the first weight."""
        if self.energy is None:
            assert self.weight is not None
            weight = nodes.weights(self.weight)
            found = abs(energy(grid, self.functional, weight=weight, backend=self.backend, **self.given))
            self.energy = found if 0 < found < np.inf else 1.0
        return self.energy

    def _choose_damping(self, residual: Array) -> None:
        """Set the damping with which the last move would have left the smallest residual."""
        if self.residual is not None:
            change = residual - self.residual
            size = float((change**2).sum())
            if size > 0:
                best = -self.damping * float((self.residual * change).sum()) / size
                self.damping = float(np.clip(best, min(_LEAST_DAMPING, self.damping), _MOST_DAMPING))
        self.residual = residual


def movement(one: Grid | MultiBlock, other: Grid | MultiBlock) -> float:
    """Return the largest distance between a node of one grid and of another, over the size of the first."""
    before, after = (
        np.concatenate([block.planes.reshape(2, -1) for block in _blocks(grid)], axis=1) for grid in (one, other)
    )
    return float(np.hypot(*(after - before)).max() / np.ptp(before, axis=1).max())


def _blocks(grid: Grid | MultiBlock) -> Sequence[Grid]:
    return grid.blocks if isinstance(grid, MultiBlock) else (grid,)
