"""Nested iteration: the same boundary on coarser grids first, so that the finer ones start near their solution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass

from ...arrays import Array
from ...errors import UnusableValueError
from ...functionals.definition import Functional
from ...grids import Grid
from ..newton.minimize import minimize
from ..problem import Problem
from ..run.progress import Progress
from ..sliding.slide import Slide
from ..untangling.strategies import untangle_regularized
from .prolongation import coarse_start, finer_start, from_boundary, is_transfinite, slid_start

#: A direction with this many cells is not halved further.
_FEWEST_CELLS = 16
#: How well a coarse problem is solved: its solution is only a start for the next.
_TOLERANCE, _STEPS = 1e-2, 30
#: How far the middle of an edge may be from the curve, over its length: as of an arc of 135 degrees.
_CUT = 1 / 3


def worth_nesting(problem: Problem, coordinates: Array) -> bool:
    """Return whether coarse grids can give a better start than the one that was given.

    They depend on the boundary only: a valid start with its own inner nodes, fixed inner nodes or one weight per
    node would be lost.
    """
    inner_fixed = bool(problem.fixed[1:-1, 1:-1].any())
    weight = problem.inputs.weight if problem.inputs is not None else None
    weight_per_node = weight is not None and weight.per_node
    if inner_fixed or weight_per_node or len(coarse_shapes(problem.fixed.shape)) == 1:
        return False
    if not problem.energy(coordinates)[1] > 0:
        return True
    return problem.kernels.backend == "c" and is_transfinite(coordinates)


@dataclass(slots=True)
class Nested:
    """A run over the coarse grids of one boundary.

    Attributes:
        make: binds the functional, its weight, fields and target to a grid.
        functional: what is minimized.
        parameters: of the functional.
        report: receives every step.
        slide: the sliding nodes of the grid itself, if there are some.
        solved: (2, ni, nj), the finest grid that is solved.
        slid: its sliding nodes.
    """

    make: Callable[[Grid], Problem]
    functional: Functional
    parameters: Mapping[str, float] | None
    report: Progress
    slide: Slide | None = None
    solved: Array | None = None
    slid: Slide | None = None

    def solve(self, coordinates: Array) -> None:
        """Solve on all grids coarser than `coordinates` (2, ni, nj), of which the boundary is used.

        Those are left out at whose nodes a field, or a mean over a target's cells, has no value that can be used.
        """
        for shape in coarse_shapes(coordinates.shape[1:])[:-1]:
            start = coarse_start(coordinates, shape)
            with suppress(UnusableValueError):
                problem = self.make(Grid.from_planes(*start))
                if self.slide is None:
                    self._solve_fixed(problem, start)
                else:
                    self._solve_sliding(problem, start, self.slide.on(shape))

    def _solve_fixed(self, problem: Problem, start: Array) -> None:
        self.solved, self.slid = self._solve(problem, self.finer(problem, start)), None

    def _solve_sliding(self, problem: Problem, start: Array, slide: Slide) -> None:
        """Solve on a coarse grid whose boundary nodes slide, if its edges then follow the curves.

        With few nodes the energy may be least where an edge cuts off a bend; that is of no use to finer grids. Then,
        and where the first grid is folded, nodes stay; on the next grid they slide from there.
        """
        slide.place(start)
        if self.solved is None:
            start = from_boundary(start).copy()
        if self.slid is None and (self.solved is not None or problem.folds(start).cells):
            self._solve_fixed(problem, start)
        if self.slid is not None or not slide.cut_sides(start, _CUT):
            problem.slide = slide
            found = self._solve(problem, self.finer(problem, start))
            problem.slide = None
            if not slide.cut_sides(found, _CUT):
                self.solved, self.slid = found, slide
                return
        if self.solved is None or self.solved.shape != start.shape:
            self._solve_fixed(problem, start)

    def finer(self, problem: Problem, coordinates: Array) -> Array:
        """Return the start that the finest solved grid gives on a grid with the boundary of `coordinates`.

        Sliding nodes are spaced as on the solved grid, if they have slid there.
        """
        if self.solved is None:
            return coordinates
        if self.solved.shape == coordinates.shape:
            return self.solved.copy()
        if problem.slide is None or self.slid is None:
            return finer_start(problem, self.solved, coordinates)
        coordinates = coordinates.copy()
        problem.slide.space_as(self.slid, coordinates)
        return slid_start(problem, self.solved, coordinates)

    def _solve(self, problem: Problem, start: Array) -> Array:
        """Return the solution on one coarse grid, or the least folded grid where it has none with so few nodes."""
        shape = (start.shape[1], start.shape[2])
        problem.refresh(start)
        if problem.kernels.barrier and not problem.energy(start)[1] > 0:
            self.report.begin("untangle", shape)
            if not untangle_regularized(problem, self.functional, start, self.parameters, self.report):
                return start
            problem.refresh(start)
        self.report.begin("minimize", shape)
        minimize(problem, start, self.report, tolerance=_TOLERANCE, max_iterations=_STEPS, keep_valid=True)
        return start


def coarse_shapes(shape: tuple[int, ...]) -> list[tuple[int, int]]:
    """Return the shapes of the grids of nested iteration, the coarsest first, ending with `shape`."""
    shapes = [(shape[0], shape[1])]
    while max(shapes[0]) - 1 > _FEWEST_CELLS:
        ni, nj = ((count if count - 1 <= _FEWEST_CELLS else count // 2 + 1) for count in shapes[0])
        shapes.insert(0, (ni, nj))
    return shapes
