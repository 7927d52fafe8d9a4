"""The paper's method (Section 3): minimize the energy over one node at a time, sweep after sweep.

A sweep visits the nodes in four colors; nodes of one color share no corner. Each visit is one damped
Newton step on the local energy, the sum over the 12 corners that contain the node. Nodes that slide are
visited after the inner ones.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

import numpy as np

from ..arrays import Array, Mask
from .convergence import ConvergenceTest, converged
from .energy_problem import EnergyProblem
from .iterate import Iterate
from .problem import Problem
from .run.progress import Progress
from .run.status import Outcome, Status
from .run.step_control import jacobian_floor
from .sliding.relaxation import relax_sliding

COLORS = 4
SomeProblem = TypeVar("SomeProblem", bound=EnergyProblem, contravariant=True)


def sweep(problem: Problem, coordinates: Array, fixed: Mask, *, floor: float, reach: float) -> float:
    """Visit every node that is not in `fixed` once, in place; held values are not evaluated anew.

    Args:
        problem: what is minimized.
        coordinates: (2, ni, nj).
        fixed: (ni, nj), non-zero at nodes that stay; all of `problem.fixed` and any others.
        floor: no step takes the Jacobian of a corner from above it to below it; a negative one lets cells fold.
        reach: a step of this length is not taken.

    Returns:
        The largest component of a step, taken or not.
    """
    return max(
        problem.kernels.sweep(
            coordinates,
            problem.values(coordinates),
            fixed,
            color,
            problem.steps,
            floor=floor,
            reach=reach,
            interior_only=problem.interior_only,
        )
        for color in range(COLORS)
    )


def _sweep_summed(problem: Problem, coordinates: Array, fixed: Mask, *, floor: float, reach: float) -> float:
    """Sweep as `sweep` does, but let corners fold that are not summed.

    Where that takes a summed corner across the barrier, the sweep is made again with all corners guarded.
    """
    before = coordinates.copy()
    step = sweep(problem, coordinates, fixed, floor=-1.0, reach=reach)
    if problem.energy(coordinates)[1] > floor:
        return step
    coordinates[...] = before
    return sweep(problem, coordinates, fixed, floor=floor, reach=reach)


def visit_nodes(problem: Problem, coordinates: Array, *, floor: float, reach: float) -> float:
    """Visit every free node of a block once, and every sliding one, in place; see `sweep`."""
    move = _sweep_summed if problem.guard_summed_only and floor >= 0 else sweep
    step = move(problem, coordinates, problem.fixed, floor=floor, reach=reach)
    return max(step, relax_sliding(problem, coordinates, floor=floor))


class Visit(Protocol[SomeProblem]):
    """Visits every free node of a problem once."""

    def __call__(self, problem: SomeProblem, coordinates: Array, *, floor: float, reach: float) -> float:
        """Move nodes in place, and return the largest component of a step; see `sweep`."""


def sweep_until_converged(
    problem: SomeProblem,
    coordinates: Array,
    progress: Progress,
    *,
    visit: Visit[SomeProblem],
    tolerance: float,
    max_iterations: int,
    keep_valid: bool,
) -> Outcome:
    """Sweep until the gradient's norm has fallen by the factor `tolerance`; changes `coordinates` in place.

    Returns:
        How it has ended.
    """
    problem.follow(coordinates)
    iterate = Iterate(problem, coordinates)
    convergence = ConvergenceTest(iterate, tolerance)
    progress.step(0, iterate.energy, iterate.norm, iterate.smallest)
    # A node that moves farther in one step has left the domain.
    reach = 1e3 * float(np.ptp(coordinates))
    guard = keep_valid or problem.kernels.barrier
    # On a folded start there is no validity to keep, and corners that cannot be repaired would block all others.
    floor = jacobian_floor(iterate.smallest) if guard and iterate.smallest > 0 else -1.0
    for iteration in range(max_iterations + 1):
        if convergence.reached(iterate):
            return converged("gradient", iterate.norm, convergence.first, iteration)
        if iteration == max_iterations:
            break
        step = visit(problem, coordinates, floor=floor, reach=reach)
        if step >= reach:
            why = "the sweeps diverge, which happens where the energy has no lower bound; this is the last grid."
            return Outcome(Status.DIVERGED, why)
        iterate.evaluate()
        progress.step(iteration + 1, iterate.energy, iterate.norm, iterate.smallest)
        if step == 0:
            return Outcome(
                Status.STALLED,
                f"no node can move to a lower local energy{' without folding a cell' if guard else ''}, and the "
                f"gradient's norm is {iterate.norm:.2e}, {iterate.norm / convergence.first:.1e} of its first value.",
            )
    free = keep_valid and not problem.kernels.barrier
    return Outcome(
        Status.ITERATION_LIMIT,
        f"{max_iterations} sweeps have brought the gradient's norm to {iterate.norm:.2e}, "
        f"{iterate.norm / convergence.first:.1e} of its first value, not to {tolerance:.1e}: allow more with "
        "max_iterations, or use method='newton'"
        f"{'; if cells that would fold hold it back, keep_valid=False lets them' * free}.",
    )
