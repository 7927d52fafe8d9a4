"""Relaxation of sliding nodes one by one: what a sweep over inner nodes is for these.

Every second node of a side moves by one damped Newton step along its curve. Such nodes have no cell in common, nor
have those of opposite sides, so that each step is the one of the node alone. They are damped together.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ..problem import Problem

#: No step is longer than this part of the way to the nearer neighbor along the curve: that one moves in its turn.
_OF_GAP = 0.4
#: How often a step is halved before it is not taken.
_HALVINGS = 12


def relax_sliding(problem: Problem, coordinates: Array, *, floor: float) -> float:
    """Move every sliding node once, in place.

    Args:
        problem: whose sliding nodes are where they are in the coordinates.
        coordinates: (2, ni, nj).
        floor: no step takes the smallest Jacobian from above it to below it; a negative one lets cells fold.

    Returns:
        The longest step, taken or not.
    """
    slide, longest = problem.slide, 0.0
    if slide is None:
        return longest
    for chosen in slide.colors():
        energy, smallest, gradient = problem.energy_gradient(coordinates)
        slope = (slide.tangents * gradient[:, *slide.nodes]).sum(axis=0)
        bend = slide.second_along(problem.hessian(coordinates))
        most = _OF_GAP * slide.gaps(coordinates)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(bend > 0, -slope / bend, -np.sign(slope) * most)
        step = np.where(chosen & np.isfinite(step), np.clip(step, -most, most), 0.0)
        longest = max(longest, float(np.abs(step).max(initial=0.0)))
        least = floor if smallest > floor else -np.inf
        for _ in range(_HALVINGS if step.any() else 0):
            moved, places = slide.moved(coordinates, step)
            lower, there = problem.energy(moved)
            if lower < energy and there > least:
                coordinates[...] = moved
                slide.take(places)
                break
            step /= 2
    return longest
