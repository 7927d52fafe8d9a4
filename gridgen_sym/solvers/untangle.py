"""From a folded grid to a valid one: minimise a barrier functional whose barrier is regularised, and sharpen it.

The Jacobian J is replaced by chi(J) = (J + sqrt(J² + epsilon²))/2, which is positive everywhere; epsilon is driven to
zero while the energy is minimised (Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, "Foldover-free maps in
50 lines of code"; Escobar et al. 2003). chi is a substitution in the derivation, so every barrier functional has it.

The minima for falling epsilon lie on a path, and Newton's method follows it in large steps: epsilon falls by a
constant factor. Where a valid grid exists the worst fold becomes shallower with epsilon, sooner or later; where none
exists it tends to a depth that stays. Affine maps neither fold nor unfold, but no grid in a thin band is what these
functionals like: what stays folded is tried again in coordinates in which the boundary extends evenly.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..functionals.definition import Functional
from ..grids import corner_jacobians
from ..runtime import Array, Mask, kernels
from .linear import hessian_solver
from .newton import minimize
from .problem import Problem
from .progress import Progress

#: The first epsilon, over the depth of the worst fold and over the mean Jacobian: the larger of the two counts.
_DEPTH, _SIZE = 0.2, 0.02
#: Factor by which epsilon falls.
_FALL = 0.3
#: Progress has ended if in so many falls no cell is unfolded, and the worst fold is no shallower by this factor.
_PATIENCE, _SHALLOWER = 3, 0.9
#: For one epsilon: factor by which the gradient must fall, and Newton steps after which epsilon falls in any case.
_TOLERANCE, _STEPS = 1e-2, 20
#: Over the mean Jacobian: below this epsilon, rounding decides about signs.
_SHARPEST = 1e-12
#: A boundary that extends so much more one way than the other is looked at in stretched coordinates, too.
_THIN = 1.5


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
            jacobians = np.where(cls.held_corners(fixed), np.inf, jacobians)
        folded = ~(jacobians > 0)
        return cls(int(folded.any(axis=0).sum()), -float(jacobians.min()))

    @staticmethod
    def held_corners(fixed: Mask) -> npt.NDArray[np.bool_]:
        """Return, as `corner_jacobians` orders them, the corners whose three nodes are all fixed: their J is given."""
        held = fixed != 0
        nodes = held[:-1, :-1], held[1:, :-1], held[1:, 1:], held[:-1, 1:]
        return np.stack([nodes[k - 1] & nodes[k] & nodes[(k + 1) % 4] for k in range(4)])


@dataclass(slots=True)
class _Least:
    """The least folded grid so far: its coordinates, and its folds."""

    coordinates: Array
    folds: Folds

    def offer(self, coordinates: Array) -> None:
        """Take a grid that is less folded."""
        folds = Folds.of(coordinates)
        if folds < self.folds:
            self.coordinates, self.folds = coordinates.copy(), folds


@dataclass(frozen=True, slots=True)
class _Frame:
    """Affine coordinates: `matrix` (2, 2) times what is left of a point when `center` (2,) is taken away."""

    matrix: Array
    center: Array

    def of(self, coordinates: Array) -> Array:
        """Return coordinates (2, ni, nj) in this frame."""
        return np.ascontiguousarray(np.tensordot(self.matrix, coordinates - self.center[:, None, None], axes=1))

    def back(self, coordinates: Array, like: Array, fixed: Mask) -> Array:
        """Return them from this frame, with the fixed nodes bit by bit as in `like`."""
        there = np.tensordot(np.linalg.inv(self.matrix), coordinates, axes=1) + self.center[:, None, None]
        return np.where(fixed != 0, like, there)


def _frames(coordinates: Array) -> Iterator[_Frame]:
    """Return the coordinates to search in: as they are, and, for a thin boundary, with its extent made even."""
    yield _Frame(np.eye(2), np.zeros(2))
    sides = coordinates[:, :, 0], coordinates[:, :, -1], coordinates[:, 0], coordinates[:, -1]
    boundary = np.concatenate(sides, axis=1)
    center, size = boundary.mean(axis=1), float(np.ptp(boundary)) or 1.0
    spread, axes = np.linalg.eigh(np.cov((boundary - center[:, None]) / size))
    extents = np.sqrt(np.maximum(spread, 0.0))
    if extents[1] > _THIN * extents[0] > 0:
        yield _Frame(axes @ np.diag(extents[1] / extents) @ axes.T, center)


def unfold(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    progress: Progress,
) -> bool:
    """Make every corner's Jacobian positive, where that can be done; changes `coordinates` in place.

    Stops at the first valid grid; where only corners are left whose three nodes are all fixed; or where progress has
    ended: epsilon falls and falls, and no cell unfolds any more, nor does the worst fold become shallower, or epsilon
    has become so small that rounding decides. The grid with the fewest folded cells is kept, whatever ends it.

    Returns:
        Whether the grid is valid.
    """
    least = _Least(coordinates.copy(), Folds.of(coordinates))
    start = least.coordinates
    try:
        for frame in _frames(start):
            place = frame.of(start)
            try:
                for _ in _path(problem, functional, place, parameters, progress):
                    least.offer(frame.back(place, start, problem.fixed))
            finally:  # Ctrl-C may come in the midst of a step.
                least.offer(frame.back(place, start, problem.fixed))
            if not Folds.of(least.coordinates, problem.fixed).cells:
                break
    finally:
        coordinates[...] = least.coordinates
    return least.folds.cells == 0


def _path(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    progress: Progress,
) -> Iterator[None]:
    """Follow the minima for falling epsilon, changing `coordinates` in place, as long as that is progress."""
    folds = [Folds.of(coordinates, problem.fixed)]
    size = float(np.abs(corner_jacobians(coordinates[0], coordinates[1])).mean())
    epsilon = max(_DEPTH * folds[0].depth, _SIZE * size)
    solver = hessian_solver(problem.fixed, problem.kernels.backend)
    while folds[-1].cells and epsilon > _SHARPEST * size and not _ended(folds[1:]):
        minimize(
            regularized(problem, functional, parameters, epsilon),
            coordinates,
            progress,
            tolerance=_TOLERANCE,
            max_iterations=_STEPS,
            keep_valid=False,
            until_valid=True,
            semidefinite=True,
            solver=solver,
        )
        folds.append(Folds.of(coordinates, problem.fixed))
        epsilon *= _FALL
        yield


def _ended(folds: list[Folds]) -> bool:
    """Return whether the last falls of epsilon were no progress over all before them."""
    before, lately = folds[:-_PATIENCE], folds[-_PATIENCE:]
    if not before:
        return False
    fewer = min(fold.cells for fold in lately) < min(fold.cells for fold in before)
    shallower = min(fold.depth for fold in lately) < _SHALLOWER * min(fold.depth for fold in before)
    return not (fewer or shallower)


def regularized(
    problem: Problem, functional: Functional, parameters: Mapping[str, float] | None, epsilon: float
) -> Problem:
    """Return the same problem with the regularised barrier, without a weight, over all corners."""
    kernel_set = kernels(functional, "regularized", {**(parameters or {}), "epsilon": epsilon}, problem.kernels.backend)
    # Its energy is finite everywhere, so the line search need not keep corners positive.
    return Problem(replace(kernel_set, barrier=False), problem.fixed, None)
