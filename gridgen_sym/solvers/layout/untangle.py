"""Untangle blocks together: the regularized barrier, sharpened; copies move as one node."""

from __future__ import annotations

from collections.abc import Mapping

from ...arrays import Array
from ...functionals.definition import Functional
from ..folds import Folds
from ..newton.minimize import minimize
from ..run.progress import Progress
from ..untangling.regularization import regularized
from .problem import LayoutProblem

#: The first epsilon, over the depth of the worst fold and over the mean Jacobian, and the factors by which it falls: in
#: large steps first, and in small ones where these have led to another path.
_DEPTH, _SIZE, _FALLS = 0.2, 0.02, (0.3, 0.6)
#: Falls without a shallower worst fold, or fewer folds, after which the path is given up.
_PATIENCE, _SHALLOWER = 5, 0.9
#: For one epsilon: the factor by which the gradient must fall, and the most Newton steps.
_TOLERANCE, _STEPS = 1e-2, 20
#: What is said where the path ends with folds.
NO_PROGRESS = "untangling made no more progress; this is the least folded grid found."
#: Over the mean Jacobian: below this epsilon, rounding decides about signs.
_SHARPEST = 1e-12


def untangle_blocks(
    problem: LayoutProblem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    report: Progress,
) -> bool:
    """Leave the least folded grid that is found in `coordinates`; return whether it is valid.

    Nodes slide only where no valid grid is found while they stay.
    """
    slide = problem.slide
    if slide is not None:
        problem.slide = None
        try:
            if untangle_blocks(problem, functional, coordinates, parameters, report):
                return True
        finally:
            problem.slide = slide
    best, folds = coordinates.copy(), problem.folds(coordinates)
    try:
        for fall in _FALLS:
            if folds.cells == 0:
                break
            place = coordinates.copy()
            epsilon = max(_DEPTH * folds.depth, _SIZE * problem.mean_jacobian(place))
            since, least = 0, Folds(problem.folds(place).cells, folds.depth)
            while folds.cells and since < _PATIENCE and epsilon > _SHARPEST * problem.mean_jacobian(place):
                _lower(problem, functional, parameters, epsilon, place, report)
                found = problem.folds(place)
                if found < folds:
                    best, folds = place.copy(), found
                progress = found.cells < least.cells or found.depth < _SHALLOWER * least.depth
                least, since = min(least, found), 0 if progress else since + 1
                epsilon *= fall
    finally:
        coordinates[...] = best
        problem.refresh(coordinates)
    return folds.cells == 0


def _lower(
    problem: LayoutProblem,
    functional: Functional,
    parameters: Mapping[str, float] | None,
    epsilon: float,
    coordinates: Array,
    report: Progress,
) -> None:
    """Lower the energy with one regularized barrier, in place."""
    blocks = [regularized(block, functional, parameters, epsilon) for block in problem.blocks]
    regular = LayoutProblem(blocks, problem.copies, problem.fixed, problem.bonds, problem.slide)
    minimize(
        regular,
        coordinates,
        report,
        tolerance=_TOLERANCE,
        max_iterations=_STEPS,
        keep_valid=False,
        until_valid=True,
        semidefinite=True,
    )
