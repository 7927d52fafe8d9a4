"""Minimize a functional with a regularized barrier, and sharpen the barrier: the path to a valid grid.

The Jacobian J is replaced by chi(J) = (J + sqrt(J² + epsilon²))/2, which is positive everywhere; epsilon is driven to
zero while the energy is minimized (Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, "Foldover-free maps in
50 lines of code"; Escobar et al. 2003). chi is a substitution in the derivation, so every barrier functional has it.

The minima for falling epsilon lie on a path, and Newton's method follows it in large steps: epsilon falls by a
constant factor. Where a valid grid exists the worst fold becomes shallower with epsilon, sooner or later; where none
exists it tends to a depth that stays.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from ...arrays import Array
from ...functionals.definition import Functional
from ...functionals.metric import INVERSE_TARGET_NAMES
from ...functionals.registry import functional as find_functional
from ...runtime import kernels
from ..folds import Folds, mean_jacobian
from ..newton.minimize import minimize
from ..problem import Problem
from ..run.progress import Progress
from .affine_maps import AffineMap
from .diagonal_target import DiagonalTarget
from .search import Search

#: The first epsilon, over the depth of the worst fold and over the mean Jacobian: the larger of the two counts.
_DEPTH, _SIZE = 0.2, 0.02
#: Progress is a worst fold that is shallower by this factor, or one folded cell less.
_SHALLOWER = 0.9
#: For one epsilon: factor by which the gradient must fall, and Newton steps after which epsilon falls in any case.
_TOLERANCE, _STEPS = 1e-2, 20
#: Over the mean Jacobian: below this epsilon, rounding decides about signs.
_SHARPEST = 1e-12


class Pace(NamedTuple):
    """How fast epsilon falls.

    Attributes:
        fall: factor by which it falls.
        patience: falls without progress after which the path is given up.
    """

    fall: float
    patience: int


#: Fast is cheap and mostly enough; slow follows the path where Newton's method would jump to another one.
FAST, SLOW = Pace(0.3, 3), Pace(0.6, 6)

#: Lowers the energy of a problem from given coordinates on, in place.
Lower = Callable[[Problem, Array], None]


def global_newton(problem: Problem, progress: Progress) -> Lower:
    """Return Newton's method on all nodes of a problem, as a function that lowers its energy."""
    solver, sliding = problem.solver(), problem.slide is not None

    def lower(regular: Problem, coordinates: Array) -> None:
        minimize(
            regular,
            coordinates,
            progress,
            tolerance=_TOLERANCE,
            max_iterations=_STEPS,
            keep_valid=False,
            until_valid=True,
            semidefinite=True,
            solver=solver if sliding == (regular.slide is not None) else regular.solver(),
        )

    return lower


def follow(
    search: Search,
    frame: AffineMap,
    lower: Lower,
    functional: Functional | None = None,
    pace: Pace = FAST,
    target: DiagonalTarget | None = None,
) -> None:
    """Follow the minima for falling epsilon from the start of a search, in mapped coordinates; offer every grid.

    Nodes slide where coordinates are as they are: curves are not mapped.

    Args:
        search: takes the grids.
        frame: the coordinates.
        lower: lowers the energy for one epsilon.
        functional: whose barrier is followed instead of the search's own, with its default parameters.
        pace: how fast epsilon falls.
        target: of the corners in mapped coordinates, relative to which the barrier is regularized.
    """
    place, fixed = frame.apply(search.start), search.problem.fixed
    problem = search.problem if frame.matrix is None else replace(search.problem, slide=None)
    parameters = search.parameters if functional is None else None
    try:
        for _ in path(problem, functional or search.functional, place, parameters, lower, pace, target):
            search.best.offer(frame.invert(place, search.start, fixed))
    finally:  # Ctrl-C may come in the midst of a step.
        search.best.offer(frame.invert(place, search.start, fixed))


def path(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    lower: Lower,
    pace: Pace = FAST,
    target: DiagonalTarget | None = None,
) -> Iterator[None]:
    """Follow the minima for falling epsilon, changing `coordinates` in place, as long as that is progress.

    With a target, epsilon, the depth of folds and the mean Jacobian are relative to it.
    """

    def mendable() -> Folds:
        return target.folds(coordinates, problem.held) if target else problem.folds(coordinates, mendable=True)

    folds = [mendable()]
    size = target.mean_jacobian(coordinates) if target else mean_jacobian(coordinates)
    epsilon = max(_DEPTH * folds[0].depth, _SIZE * size)
    while folds[-1].cells and epsilon > _SHARPEST * size and not _ended(folds[1:], pace.patience):
        lower(regularized(problem, functional, parameters, epsilon, target), coordinates)
        folds.append(mendable())
        epsilon *= pace.fall
        yield


def _ended(folds: list[Folds], patience: int = FAST.patience) -> bool:
    """Return whether the last falls of epsilon were no progress over all before them."""
    before, lately = folds[:-patience], folds[-patience:]
    if not before:
        return False
    fewer = min(fold.cells for fold in lately) < min(fold.cells for fold in before)
    shallower = min(fold.depth for fold in lately) < _SHALLOWER * min(fold.depth for fold in before)
    return not (fewer or shallower)


def regularized(
    problem: Problem,
    functional: Functional,
    parameters: Mapping[str, float] | None,
    epsilon: float,
    target: DiagonalTarget | None = None,
) -> Problem:
    """Return the same problem with the regularized barrier, without a weight, over all corners.

    Where the density needs more than the metric, Winslow's barrier is taken: the boundary alone decides on validity.
    """
    variant = "target+regularized" if target else "regularized"
    planes = INVERSE_TARGET_NAMES if target else ()
    kernel_set = None
    if not functional.fields:
        given = {**(parameters or {}), "epsilon": epsilon}
        kernel_set = kernels(functional, variant, given, problem.kernels.backend)
    if kernel_set is None or kernel_set.planes != planes:
        winslow = find_functional("winslow")
        kernel_set = kernels(winslow, variant, {"epsilon": epsilon}, problem.kernels.backend)
    # Its energy is finite everywhere, so the line search need not keep corners positive.
    smooth, values = replace(kernel_set, barrier=False), target.values if target else None
    return Problem(smooth, problem.fixed, None, _values=values, slide=problem.slide)
