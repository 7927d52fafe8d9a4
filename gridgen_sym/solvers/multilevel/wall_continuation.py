"""Grids with walls: continuation of the target from a start's own cells, on coarse grids of the same boundary first.

At t = 0 the target is the lengths and angles of the start's own corners, so that the start is the minimum; lengths then
pass geometrically, and angles linearly, to what the walls ask for at t = 1. On the coarsest grid that takes some dozens
of Newton steps; a finer grid starts from the coarser one, interpolated in the fractions of the walls' laws, and needs a
few.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...boundary.sides import Sides
from ...boundary.wall import Wall
from ...fields.target import Target
from ...fields.wall_cells import WallCells, corrected, own_cells, wall_cells
from ...functionals.registry import functional as find_functional
from ...grids import Grid, corner_jacobians
from ..binding import make_problem
from ..linear.solution import LinearSolver
from ..minimization import Run
from ..newton.minimize import minimize
from ..problem import Problem
from ..run.progress import Progress
from ..run.status import Outcome
from ..untangling.strategies import untangle_regularized
from .nested import coarse_shapes, worth_nesting
from .prolongation import coarse_start
from .wall_prolongation import finer_grid

#: How well the problems on the way are solved, in how many steps at most.
_TOLERANCE, _STEPS = 1e-1, 30
#: The same of the grid whose heights are measured first: corrections are for those of the minimum.
_MEASURED = 1e-2
#: The first, the least and the greatest step of t.
_FIRST, _LEAST, _GREATEST = 1 / 8, 1 / 512, 1 / 4
#: Heights are corrected so often at most, and not where they are wrong by no more than this part.
_CORRECTIONS, _RIGHT = 3, 2e-3
#: A step of t that took so few Newton steps is followed by a longer one.
_EASY = 6


def approach_walls(run: Run, walls: Sides[Wall | None], backend: str | None) -> Sides[Wall | None]:
    """Bring a run near the minimum for what walls ask for, if a valid grid leads there; then measure locally.

    The way is that of winslow, whatever the functional: any start is its minimum for the start's own cells.

    Returns:
        The walls whose target has that minimum: their first heights make up for what would come out wrong.
    """
    way = WallContinuation(walls, backend, run.report)
    try:
        way.solve(run.coordinates, nested=worth_nesting(run.problem, run.coordinates))
    finally:
        found = way.on_grid(run.coordinates)
        if found is not None:
            run.problem.measure_locally(found)
            run.take(found)
    return way.walls


@dataclass(slots=True)
class WallContinuation:
    """A run over the grids of one boundary with walls.

    Attributes:
        walls: of the four sides; in the end with corrected heights.
        backend: name of what runs the kernels.
        report: receives every step.
        found: (2, ni, nj), the last valid grid, and what walls ask for there.
        reached: the greatest t of the last grid.
        solver: of the linear systems, and the shape that it is for.
    """

    walls: Sides[Wall | None]
    backend: str | None
    report: Progress
    found: tuple[Array, WallCells] | None = None
    reached: float = 0.0
    solver: tuple[tuple[int, int], LinearSolver] | None = None

    def solve(self, coordinates: Array, *, nested: bool) -> None:
        """Find a grid that is near the minimum for what the walls ask for, or the nearest valid one.

        Args:
            coordinates: (2, ni, nj), the start; with `nested` its boundary alone is used, unless coarse grids fail.
            nested: whether to begin on coarse grids.
        """
        home = coordinates.shape[1], coordinates.shape[2]
        for shape in coarse_shapes(home) if nested else [home]:
            start = coordinates.copy() if shape == home else coarse_start(coordinates, shape)
            cells = wall_cells(self.walls, start, home)
            found = None if self.found is None else self._from_coarser(*self.found, start, cells)
            if found is None:
                found = self._continued(start, cells)
            if found is not None:
                self.found = found, cells
        self._correct(coordinates)

    def _correct(self, coordinates: Array) -> None:
        """Correct the heights on the finest grid, as long as that makes them better."""
        asked, least = self.walls, np.inf
        if self.found is None or self.found[0].shape != coordinates.shape or self.reached < 1:
            return
        home = coordinates.shape[1], coordinates.shape[2]
        self._minimized(self._problem(*self.found), self.found[0], _MEASURED)
        for _ in range(_CORRECTIONS):
            place = self.found[0].copy()
            walls, wrong = corrected(self.walls, asked, place)
            if wrong < _RIGHT or wrong > 0.7 * least:
                break
            cells = wall_cells(walls, coordinates, home)
            if not self._minimized(self._problem(place, cells), place).converged:
                break
            least, self.walls, self.found = wrong, walls, (place, cells)

    def on_grid(self, coordinates: Array) -> Array | None:
        """Return what was found on the grid with the boundary of `coordinates`; None if it is folded there."""
        if self.found is None:
            return None
        place, cells = self.found
        if place.shape != coordinates.shape:
            home = coordinates.shape[1], coordinates.shape[2]
            place = finer_grid(place, cells, coordinates, wall_cells(self.walls, coordinates, home))
        return place if corner_jacobians(*place).min() > 0 else None

    def _problem(self, place: Array, cells: WallCells) -> Problem:
        return make_problem(Grid.from_planes(*place), "winslow", target=Target.of_cells(cells), backend=self.backend)

    def _from_coarser(self, coarse: Array, coarse_cells: WallCells, start: Array, cells: WallCells) -> Array | None:
        """Return the solution from a start on a coarser grid; None if that start is folded, or leads nowhere."""
        place = finer_grid(coarse, coarse_cells, start, cells)
        problem = self._problem(place, cells)
        if not problem.energy(place)[1] > 0:
            return None
        return place if self._minimized(problem, place).converged else None

    def _continued(self, start: Array, cells: WallCells) -> Array | None:
        """Return the grid at the greatest t that is reached from a start's own cells; None where it stays folded."""
        shape = (start.shape[1], start.shape[2])
        place = start.copy()
        problem = self._problem(place, cells)
        if not problem.energy(place)[1] > 0:
            self.report.begin("untangle", shape)
            if not untangle_regularized(problem, find_functional("winslow"), place, None, self.report):
                return None
        own = own_cells(place)
        self.reached, step = 0.0, _FIRST
        while self.reached < 1:
            t = min(1.0, self.reached + step)
            trial = place.copy()
            count = len(self.report.history)
            outcome = self._minimized(self._problem(place, between(own, cells, t)), trial)
            if outcome.converged:
                place, self.reached = trial, t
                step = min(2 * step, _GREATEST) if len(self.report.history) - count <= _EASY else step
            else:
                step /= 2
            if step < _LEAST:
                break
        return place

    def _minimized(self, problem: Problem, place: Array, tolerance: float = _TOLERANCE) -> Outcome:
        """Minimize roughly, in place."""
        shape = place.shape[1], place.shape[2]
        self.report.begin("walls", shape)
        problem.measure_locally(place)
        if self.solver is None or self.solver[0] != shape:
            self.solver = shape, problem.solver()
        return minimize(
            problem,
            place,
            self.report,
            tolerance=tolerance,
            max_iterations=_STEPS,
            keep_valid=True,
            solver=self.solver[1],
        )


def between(own: tuple[Array, Array, Array], cells: WallCells, t: float) -> WallCells:
    """Return the cells at t on the way from a start's own ones."""
    along_xi, along_eta, angle = own
    return WallCells(
        along_xi ** (1 - t) * cells.along_xi**t,
        along_eta ** (1 - t) * cells.along_eta**t,
        (1 - t) * angle + t * cells.angle,
        cells.eta,
        cells.xi,
    )
