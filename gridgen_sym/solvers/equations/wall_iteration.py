"""Grids with walls through the equations: control functions that are updated from one solution to the next.

The start is an algebraic grid with the walls' heights, and the control functions that hold it: it solves the equations.
Where that is folded, it is the grid of the walls as a target.
They pass to smooth ones, while every wall adds to them until its heights and angles are those that are asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Array
from ...boundary.sides import Sides
from ...boundary.wall import Wall, check_heights
from ...errors import GridgenError
from ...fields.wall_cells import WallCells, misplaced_sides, wall_cells
from ...grids import corner_jacobians
from ..minimization import Run
from ..multilevel.nested import worth_nesting
from ..multilevel.wall_continuation import WallContinuation
from ..run.status import Outcome, Status
from .algebraic_grid import holding_controls, law_controls, law_grid, line_fractions, smoothed
from .newton import solve_by_newton
from .residual import Equations
from .wall_controls import WallControls, wall_controls

#: Heights to this part, and angles to these degrees, are what was asked for.
_HEIGHTS, _DEGREES = 1e-3, 0.1
#: By how much an update may change the share of smooth control functions, and what part of an update is tried last.
_SHARE, _LEAST_PART = 0.25, 1 / 64
#: How well the equations are solved after an update, and in how many steps at most.
_TOLERANCE, _STEPS = 1e-3, 12
#: Updates without a better grid after which there is no hope.
_PATIENCE = 15
#: Sweeps that smooth the control functions; the largest ones, over 2/step, beyond which central differences oscillate.
_SWEEPS, _LARGEST = 10, 0.5
_BEGAN = "The transfinite grid with these heights is folded, so it began with the one that has the walls as a target: "


@dataclass(frozen=True, slots=True)
class Errors:
    """How far the walls of a grid are from what was asked for.

    Attributes:
        height: the largest error of a first height, as a part of it.
        degrees: the largest error of an angle.
        mean: the root mean square of all errors, as a multiple of what is allowed.
    """

    height: float
    degrees: float
    mean: float

    @classmethod
    def of(cls, controls: tuple[WallControls, ...], coordinates: Array) -> Errors:
        """Measure a grid."""
        found = [wall.errors(coordinates) for wall in controls]
        height = np.abs(np.expm1(np.concatenate([one for one, _ in found])))
        degrees = np.degrees(np.abs(np.concatenate([one for _, one in found])))
        every = np.concatenate([height / _HEIGHTS, degrees / _DEGREES])
        mean = float(np.sqrt(np.square(every).mean())) if every.size else 0.0
        return cls(float(height.max(initial=0.0)), float(degrees.max(initial=0.0)), mean)

    @property
    def allowed(self) -> bool:
        """Whether they are as they should be."""
        return self.height <= _HEIGHTS and self.degrees <= _DEGREES


@dataclass(frozen=True, slots=True)
class Background:
    """The control functions without what walls add.

    Attributes:
        holding: (2, ni, nj), those that hold the start.
        smooth: those of the walls' laws, and the smoothed rest of what holds the start.
    """

    holding: Array
    smooth: Array

    @classmethod
    def of(cls, equations: Equations, start: Array, cells: WallCells) -> Background:
        """Return the control functions of a valid start."""
        steps = equations.problem.steps
        holding = holding_controls(equations, start)
        own_eta = None if cells.eta is None else line_fractions(start)
        own_xi = None if cells.xi is None else line_fractions(start.swapaxes(1, 2)).T
        largest = 2 * _LARGEST / np.array(steps)[:, None, None]
        rest = np.clip(holding, -largest, largest) - law_controls(start, own_eta, own_xi, steps)
        return cls(holding, law_controls(start, cells.eta, cells.xi, steps) + smoothed(rest, _SWEEPS))

    def at(self, share: float) -> Array:
        """Return the control functions at a share of the smooth ones."""
        return np.asarray((1 - share) * self.holding + share * self.smooth)


@dataclass(slots=True)
class WallIteration:
    """The outer iteration; the best valid grid so far is kept in the run.

    Attributes:
        run: of the solver.
        equations: with control functions.
        background: control functions without what walls add.
        controls: what the walls add.
        place: (2, ni, nj), the last solution.
        share: of the smooth control functions in the background.
        goal: the greatest share.
        reference: norm of the first residual, from which the last one must fall.
        steps: how many Newton steps were taken in all.
        best: the least mean error so far, as a multiple of what is allowed.
    """

    run: Run
    equations: Equations
    background: Background
    controls: tuple[WallControls, ...]
    place: Array
    share: float = 0.0
    goal: float = 1.0
    reference: float | None = None
    steps: int = 0
    best: float = np.inf

    def solve(self, limit: int, tolerance: float) -> Outcome:
        """Update the control functions until heights and angles are those asked for, or nothing gets better."""
        self.run.report.begin("control", self.run.problem.fixed.shape)
        update = waiting = 0
        while True:
            off = Errors.of(self.controls, self.place)
            if off.allowed and self.share == self.goal:
                return self._finished(update, tolerance)
            waiting = waiting + 1 if off.mean >= self.best else 0
            self._keep(off.mean)
            if update == limit:
                return self._ended(Status.ITERATION_LIMIT, update, "allow more with max_iterations.")
            if waiting > _PATIENCE:
                return self._ended(Status.STALLED, update, f"the last {waiting} made nothing better.")
            for wall in self.controls:
                wall.aim(self.place, accelerate=self.share == self.goal)
            if not self._updated():
                if self.share == self.goal:
                    return self._ended(Status.STALLED, update, "none leads to a valid solution any more.")
                self.goal = self.share
            update += 1

    def _updated(self) -> bool:
        """Solve with the next control functions, or with a part of the change; return whether that was possible."""
        part = 1.0
        while part >= _LEAST_PART:
            share = min(self.goal, self.share + part * _SHARE)
            planes = self.background.at(share)
            for wall in self.controls:
                wall.add_to(planes, part)
            trial = self.place.copy()
            if self._solved(trial, planes, _TOLERANCE, None).converged:
                self.place, self.share = trial, share
                for wall in self.controls:
                    wall.accept(part)
                return True
            part /= 2
        return False

    def _solved(self, trial: Array, planes: Array, tolerance: float, reference: float | None) -> Outcome:
        """Solve the equations with control functions, in place."""
        controlled = self.equations.controlled
        assert controlled is not None
        self.equations.controlled = replace(controlled, planes=planes)
        self.equations.measure_locally(trial)
        history = self.run.report.history
        before = len(history)
        report = self.run.report
        outcome = solve_by_newton(self.equations, trial, report, tolerance, _STEPS, True, reference, damps=False)
        self.steps += len(history) - before - 1
        if self.reference is None:
            self.reference = history[before].gradient_norm
        return outcome

    def _keep(self, mean: float) -> None:
        """Keep the last solution in the run, if its mean error is the least one."""
        if mean < self.best:
            self.best, self.run.coordinates = mean, self.place.copy()

    def _finished(self, updates: int, tolerance: float) -> Outcome:
        """Solve the equations as well as was asked for, with the last control functions."""
        assert self.equations.controlled is not None
        self.run.coordinates, trial = self.place, self.place.copy()
        outcome = self._solved(trial, self.equations.controlled.planes, tolerance, self.reference)
        if outcome.converged:
            self.run.coordinates = trial
        norm = self.run.report.history[-1].gradient_norm
        return Outcome(outcome.status, f"{self._told(updates)}; the residual's norm is {norm:.1e}.")

    def _ended(self, status: Status, updates: int, why: str) -> Outcome:
        """Return how the iteration has ended without the heights and angles."""
        told = f"{self._told(updates)}: {why} This is the best valid grid."
        return Outcome(status, f"{told} Without control, walls become a target, which needs no such iteration.")

    def _told(self, updates: int) -> str:
        off = Errors.of(self.controls, self.run.coordinates)
        lean = any(np.degrees(np.abs(wall.tilt)).max(initial=0.0) > _DEGREES for wall in self.controls if wall.angles)
        beside = " (beside corners of the block of angles that pass to theirs)" if lean else ""
        return (
            f"after {updates} updates of the control functions and {self.steps} Newton steps, heights at the walls are "
            f"within {100 * off.height:.2g} % of those asked for, and angles within {off.degrees:.2g} degrees of right "
            f"ones{beside}"
        )


def solve_with_walls(
    run: Run, equations: Equations, walls: Sides[Wall | None], limit: int, tolerance: float
) -> Outcome:
    """Solve the equations with control functions that walls ask for; the run keeps the best valid grid.

    Args:
        run: of the solver, on the start.
        equations: with control functions, whatever they are.
        walls: of the four sides.
        limit: how many updates of the control functions are allowed.
        tolerance: factor by which the residual's norm must fall in the end.

    Raises:
        GridgenError: for a folded start of a functional without a barrier, or heights below rounding errors.
    """
    check_heights(walls, run.start)
    shape = run.start.shape
    cells = wall_cells(walls, run.coordinates, shape)
    algebraic = law_grid(run.coordinates, cells)
    if limit and corner_jacobians(*algebraic).min() > 0:
        run.coordinates = algebraic
    elif not (limit and _begun_with_target(run, walls)) and not run.make_valid():
        return run.could_not_unfold()
    if not corner_jacobians(*run.coordinates).min() > 0:
        raise GridgenError(
            "control functions from walls begin with a valid grid, and the start is folded: unfold it first with "
            "untangle"
        )
    problem, start = run.problem, run.coordinates.copy()
    problem.refresh(start)
    controls = wall_controls(walls, start, cells, problem.steps, problem.fixed)
    iteration = WallIteration(run, equations, Background.of(equations, start, cells), controls, start)
    run.remark = misplaced_sides(walls, start)
    return iteration.solve(limit, tolerance)


def _begun_with_target(run: Run, walls: Sides[Wall | None]) -> bool:
    """Start from the grid for which the walls are a target, and report that; return whether that is valid."""
    way = WallContinuation(walls, run.problem.kernels.backend, run.report)
    way.solve(run.coordinates, nested=worth_nesting(run.problem, run.coordinates))
    found = way.on_grid(run.coordinates)
    if found is None:
        return False
    run.coordinates, run.said = found, _BEGAN
    return True
