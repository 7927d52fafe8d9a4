"""The global method: Newton's method on all free nodes at once, with a line search that keeps every corner valid."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ..convergence import ConvergenceTest, converged
from ..energy_problem import EnergyProblem
from ..iterate import Iterate
from ..linear.solution import LinearSolver
from ..problem import Problem
from ..run.deadline import Deadline
from ..run.progress import Progress
from ..run.status import Outcome, Status
from ..run.step_control import StepControl, diverges, jacobian_floor
from ..subdomains import restrict
from .line_search import LineSearch
from .nonlinear_elimination import steep_subdomains, sweep_standing_out
from .steps import NewtonSteps

#: A step that lowers the energy by less than this fraction makes no progress.
_LITTLE = 1e-6
#: Regions with an outstanding gradient are relaxed locally if the gradient's norm is more than this fraction of its
#: scale, and more than this fraction of its last value: otherwise Newton's method alone is faster.
_STEEP, _POOR = 5e-3, 0.25
#: Factor by which the gradient falls in a subdomain, and Newton steps there.
_WINDOW, _WINDOW_STEPS = 3e-1, 40
#: Values that are evaluated anew after every step may never let the grid settle: steps without a smaller gradient.
_UNSETTLED = 50

#: After so many steps that have not halved the gradient rounding may be the reason.
_NO_BETTER = 20
_AT_ROUND_OFF = " It is as small as rounding lets it be."

#: Over the largest coordinate: Newton steps that are not longer move the nodes by rounding errors only.
_ROUNDING = 100 * float(np.finfo(float).eps)

#: Why Newton's method ends without converging.
_WHY = {
    Status.ITERATION_LIMIT: "{steps} Newton steps were not enough; allow more with max_iterations",
    Status.STALLED: "no step downhill was found",
    Status.DIVERGED: "the steps diverge, which happens where the energy has no lower bound",
    Status.HELD_BACK: (
        "every step downhill that was tried would fold a cell; whether a valid grid has less energy is not known"
    ),
    Status.UNSETTLED: (
        "the grid does not settle: wherever a step that sees a frozen weight or field moves the nodes, its values are "
        "others. In the mode 'differentiated' it belongs to the energy, and a smaller or smoother one changes less"
    ),
}


def minimize(
    problem: EnergyProblem,
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
) -> Outcome:
    """Minimize until the gradient's norm has fallen by the factor `tolerance`; changes `coordinates` in place.

    Args:
        problem: what is minimized.
        coordinates: the start and the result, in the problem's shape.
        progress: receives every step.
        tolerance: factor by which the gradient's norm must fall.
        max_iterations: Newton steps.
        keep_valid: no step takes the smallest Jacobian of a valid grid to zero; barrier functionals never do.
        until_valid: stop at the first valid grid.
        semidefinite: use the semidefinite Hessian only; see `NewtonSteps` for what else is used.
        reference: the norm that the gradient must fall from; by default that at the start. Where that is larger
            than `Problem.gradient_scale`, the latter counts.
        solver: what solves the linear systems; by default the backend's.

    Returns:
        How it has ended.
    """
    problem.follow(coordinates)
    iterate, before, barrier = Iterate(problem, coordinates), 0.0, problem.kernels.barrier
    convergence = ConvergenceTest(iterate, tolerance, reference)
    progress.step(0, iterate.energy, iterate.norm, iterate.smallest)
    control = StepControl(keep_valid or barrier, jacobian_floor(iterate.smallest))
    linear = solver or problem.solver()
    steps = NewtonSteps(problem, linear, progress.deadline, semidefinite)
    extent, trial, least = float(np.ptp(coordinates)), np.empty_like(coordinates), (iterate.norm, 0)
    halved = least
    for iteration in range(max_iterations + 1):
        if until_valid and iterate.smallest > 0:
            return Outcome(Status.CONVERGED, "the grid is valid.")
        if convergence.reached(iterate):
            search = LineSearch(iterate, control.lowest(iterate.smallest), trial)
            if iteration < max_iterations and convergence.is_by_rounding(iterate) and _polish(steps, search):
                iteration += 1
                progress.step(iteration, iterate.energy, iterate.norm, iterate.smallest)
            # Steps that a barrier itself shortens are not reported.
            return converged("gradient", iterate.norm, convergence.first, iteration, "" if barrier else str(control))
        if iteration == max_iterations:
            break
        if barrier and iterate.norm > max(_STEEP * convergence.scale, _POOR * before):
            _eliminate(iterate, progress.deadline)
            if convergence.reached(iterate):
                return converged("gradient", iterate.norm, convergence.first, iteration + 1)
        search = LineSearch(iterate, control.lowest(iterate.smallest), trial)
        step = steps.downhill(search)
        if step is None:
            if convergence.at_round_off(iterate):
                return converged("gradient", iterate.norm, convergence.first, iteration, _AT_ROUND_OFF)
            return _stuck(Status.STALLED, iterate, convergence)
        if diverges(step, extent):
            return _stuck(Status.DIVERGED, iterate, convergence)
        if steps.is_newton(search) and np.abs(step).max() <= _ROUNDING * np.abs(coordinates).max():
            remark = " Newton's steps move the nodes by rounding errors only."
            return converged("gradient", iterate.norm, convergence.first, iteration, remark)
        coordinates += step
        problem.retract(coordinates)
        # The weight may have changed: progress is measured in the energy with the weight that the step has used.
        control.count(search.folds, iterate.energy - search.energy >= _LITTLE * abs(iterate.energy))
        before = iterate.norm
        iterate.evaluate()
        progress.step(iteration + 1, iterate.energy, iterate.norm, iterate.smallest)
        steps.learn(search, iterate.norm / before, convergence.norm / (iterate.norm or 1.0))
        least = min(least, (iterate.norm, iteration))
        halved = halved if iterate.norm > 0.5 * halved[0] else (iterate.norm, iteration)
        waited = (iteration - halved[1]) % _NO_BETTER == _NO_BETTER - 1
        if waited and not problem.lags and convergence.at_round_off(iterate):
            return converged("gradient", iterate.norm, convergence.first, iteration + 1, _AT_ROUND_OFF)
        if control.holds_back:
            more = " This is the best valid grid" + ("." if barrier else "; keep_valid=False lets cells fold.")
            return _stuck(Status.HELD_BACK, iterate, convergence, more)
        if problem.lags and iteration - least[1] >= _UNSETTLED:
            return _stuck(Status.UNSETTLED, iterate, convergence)
    return _stuck(Status.ITERATION_LIMIT, iterate, convergence, "" if barrier else str(control), steps=max_iterations)


def _polish(steps: NewtonSteps, search: LineSearch) -> bool:
    """Take one more whole Newton step, if it halves the gradient; return whether it did.

    What rounding adds to a gradient was only estimated.
    """
    step = steps.last(search)
    if step is None or not search.halves_gradient(step):
        return False
    search.iterate.coordinates[...] = search.trial
    search.iterate.evaluate()
    return True


def _eliminate(iterate: Iterate, deadline: Deadline) -> None:
    """Lower the energy where the gradient is large: by sweeps, while they are efficient, and in small subdomains.

    Args:
        iterate: the grid, changed in place; a valid one stays valid. Of several blocks nothing is done.
        deadline: of the run.
    """
    problem = iterate.problem
    if not isinstance(problem, Problem):
        return
    sweep_standing_out(iterate, problem, deadline)
    parts = steep_subdomains(iterate, problem)
    for part in parts:
        inside, place = restrict(problem, iterate.coordinates, part)
        unseen = Progress("subdomain", show=False, deadline=deadline)
        try:
            minimize(inside, place, unseen, tolerance=_WINDOW, max_iterations=_WINDOW_STEPS, keep_valid=True)
        finally:
            iterate.coordinates[:, *part] = place
    if parts:
        iterate.problem.follow(iterate.coordinates)
        iterate.evaluate()


def _stuck(status: Status, iterate: Iterate, convergence: ConvergenceTest, more: str = "", steps: int = 0) -> Outcome:
    """Return the end of a run that has not converged, with the norm of the gradient."""
    small = (
        f"The gradient's norm is {iterate.norm:.2e}, {iterate.norm / (convergence.first or 1):.1e} of its first value."
    )
    return Outcome(status, f"{_WHY[status].format(steps=steps)}. {small}{more}")
