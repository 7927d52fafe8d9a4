"""Nested iteration over layouts: every second node of all blocks first, so that the whole begins near its solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress

import numpy as np

from ...arrays import Array
from ...errors import UnusableValueError
from ...functionals.definition import Functional
from ...topology import MultiBlock
from ...topology.directions import direction_groups, halvable_groups
from ..multilevel.prolongation import resample
from ..newton.minimize import minimize
from ..run.progress import Progress
from .problem import LayoutProblem
from .untangle import untangle_blocks

#: Blocks keep so many cells along each direction; a group of directions with no more cells in any is not halved.
_LEAST, _MOST = 2, 4
#: Layouts with fewer nodes are solved without coarser ones.
_FEW = 600
#: How well a coarse problem is solved: its solution is only a start for the next.
_TOLERANCE, _STEPS = 1e-2, 30


class NestedLayouts:
    """A run over the coarse layouts of a grid of several blocks."""

    def __init__(
        self,
        make: Callable[[MultiBlock], LayoutProblem],
        functional: Functional,
        parameters: Mapping[str, float] | None,
        report: Progress,
    ) -> None:
        """Keep what binds the functional to a layout."""
        self._make, self._functional, self._parameters, self._report = make, functional, parameters, report

    def start(self, layout: MultiBlock, problem: LayoutProblem) -> Array:
        """Return a start for a layout: its own coordinates, plus how the solution on a coarser layout differs there."""
        own = problem.exchange.join([grid.planes for grid in layout.blocks])
        halved = _halved(layout)
        if halved is None:
            return own
        coarse = layout.coarsened(halved)
        with suppress(UnusableValueError):
            coarse_problem = self._make(coarse)
            solved = self._solve(coarse_problem, self.start(coarse, coarse_problem))
            before = coarse_problem.exchange.join([grid.planes for grid in coarse.blocks])
            moves = coarse_problem.exchange.views(solved - before)
            for place, move in zip(problem.exchange.views(own), moves, strict=True):
                place += resample(move, place.shape[1:], linear=False)
            return self._better(problem, layout, problem.exchange.of_first_copies(own))
        return problem.exchange.join([grid.planes for grid in layout.blocks])

    def _better(self, problem: LayoutProblem, layout: MultiBlock, found: Array) -> Array:
        """Return the less folded of the layout's own grid and another; of two valid ones the second."""
        own = problem.exchange.join([grid.planes for grid in layout.blocks])
        return own if problem.folds(own) < problem.folds(found) and problem.folds(found).cells else found

    def _solve(self, problem: LayoutProblem, start: Array) -> Array:
        problem.refresh(start)
        shape = (problem.exchange.size // 2, 1)
        if problem.kernels.barrier and not problem.energy(start)[1] > 0:
            self._report.begin("untangle", shape)
            if not untangle_blocks(problem, self._functional, start, self._parameters, self._report):
                return start
        self._report.begin("minimize", shape)
        minimize(problem, start, self._report, tolerance=_TOLERANCE, max_iterations=_STEPS, keep_valid=True)
        return start


def _halved(layout: MultiBlock) -> list[tuple[bool, bool]] | None:
    """Return for each block which directions are halved; None where none is."""
    if layout.node_count < _FEW:
        return None
    shapes = [grid.shape for grid in layout.blocks]
    groups = direction_groups(layout.bonds, len(layout))
    halvable = halvable_groups(layout.bonds, groups, shapes, _LEAST, _MOST)
    halved = [(xi in halvable, eta in halvable) for xi, eta in groups]
    return halved if np.any(halved) else None
