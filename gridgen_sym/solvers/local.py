"""The paper's method (Section 3): minimise the energy over one node at a time, sweep after sweep.

A sweep visits the nodes in four colors; nodes of one color share no corner. Each visit is one damped
Newton step on the local energy, the sum over the 12 corners that contain the node.
"""

from __future__ import annotations

import numpy as np

from ..runtime import Array, Mask
from .problem import Problem, converged_message, jacobian_floor, norm_of
from .progress import Progress

COLORS = 4


def sweep(problem: Problem, coordinates: Array, fixed: Mask, *, floor: float, reach: float) -> float:
    """Visit every node that is not in `fixed` once, in place; then the weight is evaluated anew.

    Args:
        problem: what is minimised.
        coordinates: (2, ni, nj).
        fixed: (ni, nj), non-zero at nodes that stay; all of `problem.fixed` and any others.
        floor: no step takes the Jacobian of a corner from above it to below it; a negative one lets cells fold.
        reach: a step of this length is not taken.

    Returns:
        The largest component of a step, taken or not.
    """
    step = max(
        problem.kernels.sweep(
            coordinates,
            problem.weights(coordinates),
            fixed,
            color,
            floor=floor,
            reach=reach,
            interior_only=problem.interior_only,
        )
        for color in range(COLORS)
    )
    problem.refresh(coordinates)
    return step


def sweep_until_converged(
    problem: Problem,
    coordinates: Array,
    progress: Progress,
    *,
    tolerance: float,
    max_iterations: int,
    keep_valid: bool,
) -> tuple[bool, str]:
    """Sweep until the gradient's norm has fallen by the factor `tolerance`; changes `coordinates` in place.

    Returns:
        Whether it converged, and why it stopped.
    """
    energy, smallest, gradient = problem.energy_gradient(coordinates)
    norm = norm_of(gradient)
    first = min(norm, problem.gradient_scale(coordinates, energy) or norm)
    progress.step(0, energy, norm, smallest)
    # A node that goes farther in one step has left the domain for good.
    reach = 1e3 * float(np.ptp(coordinates))
    guard = keep_valid or problem.kernels.barrier
    # On a folded start there is no validity to keep, and corners that cannot be mended would hold all others back.
    floor = jacobian_floor(smallest) if guard and smallest > 0 else -1.0
    round_off = problem.round_off(coordinates, gradient)
    for iteration in range(max_iterations + 1):
        if norm <= max(tolerance * first, round_off):
            return True, converged_message("gradient", norm, first, iteration)
        if iteration == max_iterations:
            break
        step = sweep(problem, coordinates, problem.fixed, floor=floor, reach=reach)
        if step >= reach:
            why = "the sweeps diverge, which happens where the energy has no lower bound; this is the last grid."
            return False, why
        energy, smallest, gradient = problem.energy_gradient(coordinates, out=gradient)
        norm = norm_of(gradient)
        progress.step(iteration + 1, energy, norm, smallest)
        if step == 0:
            return False, (
                f"no node can move to a lower local energy{' without folding a cell' if guard else ''}, and the "
                f"gradient's norm is {norm:.2e}, {norm / first:.1e} of its first value."
            )
    return False, (
        f"{max_iterations} sweeps have brought the gradient's norm to {norm:.2e}, {norm / first:.1e} of its first "
        f"value, not to {tolerance:.1e}: allow more with max_iterations, or use method='newton'"
        f"{'; if cells that would fold hold it back, keep_valid=False lets them' if keep_valid else ''}."
    )
