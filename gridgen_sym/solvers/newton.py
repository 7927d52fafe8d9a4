"""The global method: Newton's method on all free nodes at once, with a line search that keeps every corner valid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..runtime import Array
from .deadline import Deadline
from .goal import Goal
from .line_search import LineSearch
from .linear import LinearSolver, Solution, hessian_solver
from .nonlinear_elimination import eliminate
from .point import Point
from .problem import Problem, converged_message, diverges, jacobian_floor, step_control_message
from .progress import Progress

#: Steps in a row that are cut short by the guard and lower the energy by less than a little: it holds the grid back.
_PATIENCE, _LITTLE = 5, 1e-6
#: Shift of the semidefinite Hessian, over its mean diagonal, beyond which steps are too short to matter.
_LARGEST_SHIFT, _SMALLEST_SHIFT = 1e3, 1e-8
#: The first shift of a full Hessian that is not positive, likewise.
_FIRST_SHIFT = 1e-4
#: A whole step that leaves more than this part of the gradient's norm has led nowhere; so many of them in a row stall.
_STALLED, _STALLS = 0.5, 2
#: Nodes that stand out are seen to if the gradient's norm is more than this part of its scale, and more than this part
#: of its last value: otherwise Newton's method needs no help.
_STEEP, _POOR = 5e-3, 0.25
#: Factor by which the gradient falls in a window, and Newton steps there.
_WINDOW, _WINDOW_STEPS = 3e-1, 40
#: Relative residuals of the linear solves, and that of the last one.
_LOOSEST, _TIGHTEST, _LAST = 0.05, 1e-3, 1e-5


def minimize(
    problem: Problem,
    coordinates: Array,
    progress: Progress,
    *,
    tolerance: float,
    max_iterations: int,
    keep_valid: bool,
    until_valid: bool = False,
    semidefinite: bool = False,
    reference: float | None = None,
    solver: LinearSolver | None = None,
) -> tuple[bool, str]:
    """Minimise until the gradient's norm has fallen by the factor `tolerance`; changes `coordinates` in place.

    Uses the full Hessian while its steps lead downhill and are not cut; after a step that was cut, the
    semidefinite one, shifted where it is singular; for a functional that is not polyconvex the full one, with the
    smallest shift that conjugate gradients find positive, kept from step to step. With `semidefinite` only the
    semidefinite one. Where whole steps lead nowhere and the full Hessian is not positive, the grid is near a saddle
    point, which is left along the direction of negative curvature that conjugate gradients have met. The linear systems
    are solved only as well as the step deserves (Eisenstat and Walker 1996).

    Args:
        problem: what is minimised.
        coordinates: (2, ni, nj), the start and the result.
        progress: is told of every step.
        tolerance: factor by which the gradient's norm must fall.
        max_iterations: Newton steps.
        keep_valid: no step takes the smallest Jacobian of a valid grid to zero; barrier functionals never do.
        until_valid: stop at the first valid grid.
        semidefinite: use the semidefinite Hessian only.
        reference: the norm that the gradient must fall from; by default that at the start. Where that is larger
            than `Problem.gradient_scale`, the latter counts.
        solver: what solves the linear systems; by default the backend's.

    Returns:
        Whether it converged, and why it stopped.
    """
    guard, barrier = keep_valid or problem.kernels.barrier, problem.kernels.barrier
    point, before = Point(problem, coordinates), 0.0
    goal = Goal(point, tolerance, reference)
    progress.step(0, point.energy, point.norm, point.smallest)
    floor = jacobian_floor(point.smallest)
    linear = solver or hessian_solver(problem.fixed, problem.kernels.backend)
    state = _Newton(problem, linear, progress.deadline, semidefinite)
    cut, held_back, extent, trial = 0, 0, float(np.ptp(coordinates)), np.empty_like(coordinates)
    for iteration in range(max_iterations + 1):
        if until_valid and point.smallest > 0:
            return True, "the grid is valid."
        if goal.reached(point):
            return True, converged_message("gradient", point.norm, goal.first, iteration) + step_control_message(cut)
        if iteration == max_iterations:
            break
        if barrier and point.norm > max(_STEEP * goal.scale, _POOR * before):
            eliminate(point, _minimize_window, progress.deadline)
            if goal.reached(point):
                return True, converged_message("gradient", point.norm, goal.first, iteration + 1)
        # As in the sweeps, no step takes more than nine tenths of the smallest Jacobian.
        lowest = max(floor, 0.1 * point.smallest) if guard and point.smallest > 0 else -np.inf
        search = LineSearch(point, lowest, trial)
        step = state.downhill(search)
        if step is None:
            return False, _stuck("no step downhill was found", point.norm, goal.first)
        if diverges(step, extent):
            why = "the steps diverge, which happens where the energy has no lower bound"
            return False, _stuck(why, point.norm, goal.first)
        coordinates += step
        energy, before = point.energy, point.norm
        point.evaluate()
        progress.step(iteration + 1, point.energy, point.norm, point.smallest)
        state.learn(search, point.norm / before, goal.norm / (point.norm or 1.0))
        cut += search.folds and not barrier  # A barrier's own line search is nothing to tell.
        held_back = held_back + 1 if search.folds and energy - point.energy < _LITTLE * abs(energy) else 0
        if held_back == _PATIENCE:
            why = "the minimum lies beyond the valid grids: every step downhill would fold a cell"
            more = " This is the best valid grid" + ("." if barrier else "; keep_valid=False lets cells fold.")
            return False, _stuck(why, point.norm, goal.first) + more
    why = f"{max_iterations} Newton steps were not enough; allow more with max_iterations"
    return False, _stuck(why, point.norm, goal.first) + step_control_message(cut)


def _minimize_window(problem: Problem, coordinates: Array, deadline: Deadline) -> None:
    """Minimise over a part of the grid, well enough for the whole."""
    unseen = Progress("window", show=False, deadline=deadline)
    minimize(problem, coordinates, unseen, tolerance=_WINDOW, max_iterations=_WINDOW_STEPS, keep_valid=True)


def _stuck(why: str, norm: float, first: float) -> str:
    return f"{why}. The gradient's norm is {norm:.2e}, {norm / (first or 1):.1e} of its first value."


@dataclass(slots=True)
class _Newton:
    """Which Hessian to use, how much to shift it, and how well to solve with it; learnt from step to step.

    Attributes:
        only_semidefinite: never use the full Hessian.
        cautious: use the semidefinite one next, because the last step was cut; never where it only shifts.
        shift: added to the diagonal, over its mean.
        forcing: relative residual of the next linear solve.
        stalls: whole steps in a row that have led nowhere. If the full Hessian is not positive then, the grid is near a
            saddle point, and only a direction of negative curvature leads away from it.
    """

    problem: Problem
    solver: LinearSolver
    deadline: Deadline
    only_semidefinite: bool
    cautious: bool = False
    shift: float = 0.0
    forcing: float = _LOOSEST
    stalls: int = 0
    exact: bool = False
    planes: Array | None = None

    @property
    def clamps(self) -> bool:
        """Whether the semidefinite Hessian, and not a shift of the full one, helps where that is not positive.

        Where clamped eigenvalues make it semidefinite they change it in most corners, far more than is needed: with it
        Newton's method converges linearly, and ever slower the finer the grid is.
        """
        return self.only_semidefinite or self.problem.kernels.polyconvex

    def downhill(self, search: LineSearch) -> Array | None:
        """Return a step that lowers the energy, or None if no shift gives one."""
        semidefinite = self.only_semidefinite or self.cautious
        while self.shift < _LARGEST_SHIFT:
            self.deadline.check()
            solution = self._solve(search, semidefinite)
            if solution is not None and self._search(search, solution):
                return np.multiply(solution.vector, search.length, out=solution.vector)
            if not self.clamps:
                self.shift = max(4 * self.shift, _FIRST_SHIFT)
            elif semidefinite:
                self.shift = max(10 * self.shift, 1e-6)
            semidefinite = self.clamps
        return None

    def _solve(self, search: LineSearch, semidefinite: bool) -> Solution | None:
        """Return Newton's direction, or one of negative curvature; None if this Hessian has bad diagonal blocks."""
        self.exact = not semidefinite
        self.planes = self.problem.hessian(search.point.coordinates, semidefinite=semidefinite, out=self.planes)
        # The semidefinite Hessian may be singular (area's is); a small shift makes it definite.
        shift = max(self.shift, _SMALLEST_SHIFT) if semidefinite else self.shift
        if shift:
            size = 0.5 * float(np.abs(self.planes[0]).mean() + np.abs(self.planes[2]).mean())
            self.planes[0] += shift * size
            self.planes[2] += shift * size
        if not self.solver.set_operator(self.planes):
            return None
        solution = self.solver.solve(search.point.gradient, self.forcing)
        np.negative(solution.vector, out=solution.vector)
        return solution

    def _search(self, search: LineSearch, solution: Solution) -> bool:
        """Look along Newton's direction, or where that has failed along one of negative curvature."""
        if solution.positive:
            return search.along(solution.vector)
        return self.stalls >= _STALLS and search.away(solution.vector)

    def learn(self, search: LineSearch, reduction: float, wanted: float) -> None:
        """Draw the lesson of a step that changed the gradient's norm by a factor.

        Newton's method squares that factor. Where that will do for the factor that is still `wanted`, the next system
        is the last, and is solved just as well as that: a little more work on it saves a step.
        """
        length = abs(search.length)
        self.stalls = self.stalls + 1 if length == 1.0 and reduction > _STALLED else 0
        if self.clamps:
            self.cautious = length < (0.2 if self.exact else 0.5)
            self.shift = 0.0 if length == 1.0 and self.exact else (self.shift / 10 if length > 0.5 else self.shift)
        elif length > 0.5:
            self.shift = self.shift / 4 if self.shift > _FIRST_SHIFT / 10 else 0.0
        elif not search.folds:
            # A step that was cut because it would fold a cell says nothing of the Hessian.
            self.shift = max(4 * self.shift, _FIRST_SHIFT)
        last = reduction**2 <= wanted
        self.forcing = min(_LOOSEST, max(_LAST, 0.5 * wanted) if last else max(_TIGHTEST, 0.5 * reduction))
