"""The global method: Newton's method on all free nodes at once, with a line search that keeps every corner valid."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ..convergence import Goal, converged_message
from ..iterate import Point
from ..linear.solution import LinearSolver
from ..linear.systems import hessian_solver
from ..problem import Problem
from ..run.deadline import Deadline
from ..run.progress import Progress
from ..run.step_control import StepControl, diverges, jacobian_floor
from .line_search import LineSearch
from .nonlinear_elimination import eliminate
from .steps import NewtonSteps

#: A step that lowers the energy by less than this part of it leads nowhere.
_LITTLE = 1e-6
#: Nodes that stand out are seen to if the gradient's norm is more than this part of its scale, and more than this part
#: of its last value: otherwise Newton's method needs no help.
_STEEP, _POOR = 5e-3, 0.25
#: Factor by which the gradient falls in a window, and Newton steps there.
_WINDOW, _WINDOW_STEPS = 3e-1, 40
#: A weight that is evaluated anew after every step may never let the grid settle: steps without a smaller gradient.
_UNSETTLED = 50

_NO_STEP = "no step downhill was found"
_DIVERGES = "the steps diverge, which happens where the energy has no lower bound"
_HELD_BACK = "the minimum lies beyond the valid grids: every step downhill would fold a cell"
_LAGS = (
    "the grid does not settle: wherever a step that sees a frozen weight moves the nodes, the weight is another. A "
    "weight in the mode 'differentiated' belongs to the energy, and a smaller or smoother one changes less"
)


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

    Args:
        problem: what is minimised.
        coordinates: (2, ni, nj), the start and the result.
        progress: is told of every step.
        tolerance: factor by which the gradient's norm must fall.
        max_iterations: Newton steps.
        keep_valid: no step takes the smallest Jacobian of a valid grid to zero; barrier functionals never do.
        until_valid: stop at the first valid grid.
        semidefinite: use the semidefinite Hessian only; see `NewtonSteps` for what else is used.
        reference: the norm that the gradient must fall from; by default that at the start. Where that is larger
            than `Problem.gradient_scale`, the latter counts.
        solver: what solves the linear systems; by default the backend's.

    Returns:
        Whether it converged, and why it stopped.
    """
    point, before, barrier = Point(problem, coordinates), 0.0, problem.kernels.barrier
    goal = Goal(point, tolerance, reference)
    progress.step(0, point.energy, point.norm, point.smallest)
    control = StepControl(keep_valid or barrier, jacobian_floor(point.smallest))
    linear = solver or hessian_solver(problem.fixed, problem.kernels.backend)
    steps = NewtonSteps(problem, linear, progress.deadline, semidefinite)
    extent, trial, least = float(np.ptp(coordinates)), np.empty_like(coordinates), (point.norm, 0)
    for iteration in range(max_iterations + 1):
        if until_valid and point.smallest > 0:
            return True, "the grid is valid."
        if goal.reached(point):
            # A barrier's own line search is nothing to tell.
            said = "" if barrier else str(control)
            return True, converged_message("gradient", point.norm, goal.first, iteration) + said
        if iteration == max_iterations:
            break
        if barrier and point.norm > max(_STEEP * goal.scale, _POOR * before):
            eliminate(point, _minimize_window, progress.deadline)
            if goal.reached(point):
                return True, converged_message("gradient", point.norm, goal.first, iteration + 1)
        search = LineSearch(point, control.lowest(point.smallest), trial)
        step = steps.downhill(search)
        if step is None or diverges(step, extent):
            return False, _stuck(_NO_STEP if step is None else _DIVERGES, point, goal)
        coordinates += step
        # The weight may be another now: progress is what the step has made of the energy with that which it has seen.
        control.count(search.folds, point.energy - search.energy >= _LITTLE * abs(point.energy))
        before = point.norm
        point.evaluate()
        progress.step(iteration + 1, point.energy, point.norm, point.smallest)
        steps.learn(search, point.norm / before, goal.norm / (point.norm or 1.0))
        least = min(least, (point.norm, iteration))
        if control.holds_back:
            more = " This is the best valid grid" + ("." if barrier else "; keep_valid=False lets cells fold.")
            return False, _stuck(_HELD_BACK, point, goal) + more
        if problem.weight is not None and problem.weight.lags and iteration - least[1] >= _UNSETTLED:
            return False, _stuck(_LAGS, point, goal)
    why = f"{max_iterations} Newton steps were not enough; allow more with max_iterations"
    return False, _stuck(why, point, goal) + ("" if barrier else str(control))


def _minimize_window(problem: Problem, coordinates: Array, deadline: Deadline) -> None:
    """Minimise over a part of the grid, well enough for the whole."""
    unseen = Progress("window", show=False, deadline=deadline)
    minimize(problem, coordinates, unseen, tolerance=_WINDOW, max_iterations=_WINDOW_STEPS, keep_valid=True)


def _stuck(why: str, point: Point, goal: Goal) -> str:
    """Return why it stopped, and how small the gradient is."""
    return f"{why}. The gradient's norm is {point.norm:.2e}, {point.norm / (goal.first or 1):.1e} of its first value."
