"""Nested iteration over layouts: every second node of all blocks first, so that the whole begins near its solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress

from ...arrays import Array
from ...errors import UnusableValueError
from ...functionals.definition import Functional
from ...topology import MultiBlock
from ...topology.lines import Coarsening, lines_of
from ..multilevel.prolongation import interpolate
from ..newton.minimize import minimize
from ..run.progress import Progress
from .problem import LayoutProblem
from .untangle import untangle_blocks

#: Blocks keep so many cells along each direction; a group of directions with no more cells in any is not coarsened.
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
        """Return a start for a layout: of what the solution on a coarser layout gives the best, or its own nodes."""
        own = problem.exchange.join([grid.planes for grid in layout.blocks])
        coarsening = _coarsening(layout)
        if coarsening is None:
            return own
        coarse, places = layout.coarsened(coarsening), coarsening.places
        with suppress(UnusableValueError):
            coarse_problem = self._make(coarse)
            coarse_problem.slide = None if problem.slide is None else problem.slide.coarsened(coarsening)
            solved = self._solved(coarse, coarse_problem)
            before = coarse_problem.exchange.join([grid.planes for grid in coarse.blocks])

            def prolongations(*, linear: bool) -> list[Array]:
                """Return the layout's own nodes with what has moved, and the solved nodes with the own fixed ones."""
                moved, between = own.copy(), own.copy()
                both = [problem.exchange.views(one) for one in (moved, between)]
                parts = [coarse_problem.exchange.views(one) for one in (solved - before, solved)]
                for place, move, lines in zip(both[0], parts[0], places, strict=True):
                    place += interpolate(move, *lines, linear=linear)
                for place, nodes, lines, fixed in zip(both[1], parts[1], places, problem.held, strict=True):
                    free = fixed == 0
                    place[:, free] = interpolate(nodes, *lines, linear=linear)[:, free]
                starts = [problem.exchange.of_first_copies(one) for one in (moved, between)]
                for one in starts:
                    problem.retract(one)
                return starts

            return _best(problem, own, prolongations)
        return own

    def _solved(self, layout: MultiBlock, problem: LayoutProblem) -> Array:
        """Return the solution on a coarse layout, whose boundary nodes stay if they would leave a bend to one edge."""
        found = self._solve(problem, self.start(layout, problem))
        if problem.slide is None or not problem.slide.caution(found):
            return found
        problem.slide = None
        return self._solve(problem, self.start(layout, problem))

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


def _best(problem: LayoutProblem, own: Array, prolongations: Callable[..., list[Array]]) -> Array:
    """Return of several starts the valid one of least energy, or the least folded of all.

    Cubic interpolation is the better one, and may fold cells beside kinks, where linear interpolation does not.
    """
    for linear in (False, True):
        valid = []
        for start in prolongations(linear=linear):
            problem.refresh(start)
            energy, smallest = problem.energy(start)
            if smallest > 0:
                valid.append((energy, start))
        if valid:
            return min(valid, key=lambda one: one[0])[1]
    return min([own, *prolongations(linear=False)], key=problem.folds)


def _coarsening(layout: MultiBlock) -> Coarsening | None:
    """Return which lines a coarser layout keeps; None where there is none."""
    if layout.node_count < _FEW:
        return None
    lines = lines_of(layout.bonds, tuple(grid.shape for grid in layout.blocks))
    groups = lines.groups(_LEAST, _MOST)
    return lines.coarsening(groups, _LEAST) if groups else None
