"""From a folded grid to a valid one: minimise a barrier functional whose barrier is regularised, and sharpen it.

The Jacobian J is replaced by chi(J) = (J + sqrt(J² + epsilon²))/2, which is positive everywhere; epsilon is driven to
zero while the energy is minimised (Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, "Foldover-free maps in
50 lines of code"; Escobar et al. 2003). chi is a substitution in the derivation, so every barrier functional has it.

The minima for falling epsilon lie on a path, and Newton's method follows it in large steps: epsilon falls by a
constant factor, and more slowly only where a step proves too long.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..functionals.definition import Functional
from ..grids import corner_jacobians
from ..runtime import Array, Mask, kernels
from .linear import hessian_solver
from .newton import minimize
from .problem import Problem
from .progress import Progress

#: The first epsilon, over the depth of the worst fold and over the mean Jacobian: the larger of the two counts.
_DEPTH, _SIZE = 0.2, 0.02
#: Factor by which epsilon falls at most; the slowest fall that is tried; how fast a cautious fall gets bolder.
_FASTEST, _SLOWEST, _BOLDER = 0.3, 0.9, 0.8
#: For one epsilon: factor by which the gradient must fall, and Newton steps after which epsilon falls in any case.
_TOLERANCE, _STEPS = 1e-2, 20
#: Over the mean Jacobian: below this epsilon, rounding decides about signs.
_SHARPEST = 1e-12


@dataclass(frozen=True, slots=True, order=True)
class Folds:
    """How badly a grid is folded; the smaller of two is the better one.

    Attributes:
        cells: with a corner where J <= 0 (or is not a number).
        depth: minus the smallest Jacobian.
    """

    cells: int
    depth: float

    @classmethod
    def of(cls, coordinates: Array, fixed: Mask | None = None) -> Folds:
        """Count the folds of (2, ni, nj) coordinates; with `fixed`, only those that moving free nodes may mend."""
        jacobians = corner_jacobians(coordinates[0], coordinates[1])
        if fixed is not None:
            jacobians = np.where(_held_corners(fixed), np.inf, jacobians)
        folded = ~(jacobians > 0)
        return cls(int(folded.any(axis=0).sum()), -float(jacobians.min()))


def _held_corners(fixed: Mask) -> Mask:
    """Return, as `corner_jacobians` orders them, the corners whose three nodes are all fixed: their J is given."""
    held = fixed != 0
    nodes = held[:-1, :-1], held[1:, :-1], held[1:, 1:], held[:-1, 1:]
    return np.stack([nodes[k - 1] & nodes[k] & nodes[(k + 1) % 4] for k in range(4)]).astype(np.uint8)


@dataclass(slots=True)
class _Path:
    """Where on the path of minima the search is: the last point from which epsilon could be lowered.

    Attributes:
        coordinates: the grid there.
        folds: its folds.
        epsilon: the epsilon there.
        factor: by which epsilon falls next.
    """

    coordinates: Array
    folds: Folds
    epsilon: float
    factor: float = _FASTEST

    def advance(self, coordinates: Array, folds: Folds, epsilon: float) -> bool:
        """Take a new point if it is progress; return whether the path goes on, maybe with a slower fall.

        Progress means that fewer cells are folded, or that the worst fold has become shallower by more than epsilon
        has: where a cell cannot be unfolded, or the path has been lost, the depth over epsilon grows.
        """
        if folds.cells < self.folds.cells or folds.depth * self.epsilon < self.folds.depth * epsilon:
            self.coordinates, self.folds, self.epsilon = coordinates.copy(), folds, epsilon
            self.factor = max(_FASTEST, _BOLDER * self.factor)
            return True
        self.factor = float(np.sqrt(self.factor))
        coordinates[...] = self.coordinates
        return self.factor < _SLOWEST


def unfold(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    progress: Progress,
) -> bool:
    """Make every corner's Jacobian positive, where that can be done; changes `coordinates` in place.

    Stops at the first valid grid; where only corners are left whose three nodes are all fixed; or where progress has
    ended: no fall of epsilon, however slow, unfolds a cell or lifts the worst fold, or epsilon has become so small
    that rounding decides. The grid with the fewest folded cells is kept.

    Returns:
        Whether the grid is valid.
    """
    best, least = coordinates.copy(), Folds.of(coordinates)
    folds = Folds.of(coordinates, problem.fixed)
    size = float(np.abs(corner_jacobians(coordinates[0], coordinates[1])).mean())
    epsilon = max(_DEPTH * folds.depth, _SIZE * size)
    path = _Path(coordinates.copy(), Folds(folds.cells + 1, folds.depth), epsilon)
    solver = hessian_solver(problem.fixed, problem.kernels.backend)
    try:
        while folds.cells and epsilon > _SHARPEST * size:
            minimize(
                _regularized(problem, functional, parameters, epsilon),
                coordinates,
                progress,
                tolerance=_TOLERANCE,
                max_iterations=_STEPS,
                keep_valid=False,
                until_valid=True,
                semidefinite=True,
                solver=solver,
            )
            folds, reached = Folds.of(coordinates, problem.fixed), Folds.of(coordinates)
            if reached < least:
                best, least = coordinates.copy(), reached
            if not path.advance(coordinates, folds, epsilon):
                break
            epsilon = path.epsilon * path.factor
    finally:  # Whatever ends it, Ctrl-C too, the best grid is what remains.
        if least < Folds.of(coordinates):
            coordinates[...] = best
    return Folds.of(coordinates).cells == 0


def _regularized(
    problem: Problem, functional: Functional, parameters: Mapping[str, float] | None, epsilon: float
) -> Problem:
    """Return the same problem with the regularised barrier, without a weight, over all corners."""
    kernel_set = kernels(functional, "regularized", {**(parameters or {}), "epsilon": epsilon}, problem.kernels.backend)
    # Its energy is finite everywhere, so the line search need not keep corners positive.
    return Problem(replace(kernel_set, barrier=False), problem.fixed, None)
