"""Move the boundary of a valid grid to where it shall be, by steps that keep every cell valid."""

from __future__ import annotations

from ...arrays import Array
from ..harmonic import SIDES, move_sides
from ..newton.minimize import minimize
from ..problem import Problem
from ..run.progress import Progress

#: The shortest step, over the whole way; steps, accepted or not, after which it is given up.
_SHORTEST, _MOST = 1 / 512, 80
#: How well the energy is minimized after each step: factor by which the gradient must fall, and Newton steps.
_TOLERANCE, _STEPS = 0.1, 3


def move_boundary(problem: Problem, coordinates: Array, boundary: Array, progress: Progress) -> bool:
    """Move a valid grid's sides along straight lines to those of another grid, in place.

    Inner nodes follow harmonically, and relax after each step. A step that would fold a cell is halved; the next one
    after an accepted step is twice as long.

    Args:
        problem: with a barrier, on a grid of this shape with all inner nodes free.
        coordinates: (2, ni, nj), valid; left as the last valid grid on the way.
        boundary: (2, ni, nj), whose sides are wanted.
        progress: records the Newton steps, and holds the deadline.

    Returns:
        Whether the sides are those of `boundary`.
    """
    first = coordinates.copy()
    way, step = 0.0, 1.0
    for _ in range(_MOST):
        progress.deadline.check()
        ahead = min(way + step, 1.0)
        moved = move_sides(coordinates, boundary if ahead == 1.0 else _between(first, boundary, ahead))
        if problem.folds(moved).cells:
            step /= 2
            if step < _SHORTEST:
                break
            continue
        coordinates[...], way, step = moved, ahead, 2 * step
        if way == 1.0:
            return True
        minimize(problem, coordinates, progress, tolerance=_TOLERANCE, max_iterations=_STEPS, keep_valid=True)
    return False


def _between(first: Array, last: Array, way: float) -> Array:
    """Return a grid with sides between those of two others, and nothing inside."""
    between = first.copy()
    for side in SIDES:
        between[side] += way * (last[side] - first[side])
    return between
