"""From a folded grid to a valid one: minimise a barrier functional whose barrier is regularised, and lower it.

The Jacobian J is replaced by chi(J) = (J + sqrt(J² + epsilon²))/2, which is positive everywhere; epsilon is driven to
zero while the energy is minimised (Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, "Foldover-free maps in
50 lines of code"; Escobar et al. 2003). chi is a substitution in the derivation, so every barrier functional has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..functionals.definition import Functional
from ..grids import Grid, corner_jacobians, quality
from ..runtime import Array, kernels
from .linear import hessian_solver
from .newton import minimize
from .problem import Problem
from .progress import Progress

#: Newton steps for one epsilon, and rounds without progress after which to give up.
_INNER_STEPS, _PATIENCE = 10, 8
_SMALLEST_RATE = 0.1


def unfold(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    progress: Progress,
    *,
    max_rounds: int = 200,
) -> bool:
    """Make every corner's Jacobian positive, where that can be done; changes `coordinates` in place.

    Stops at the first valid grid, or when several rounds have neither unfolded a cell nor lifted the smallest
    Jacobian. The grid with the fewest folded cells is kept.

    Returns:
        Whether the grid is valid.
    """
    least, count = _folds(coordinates)
    epsilon = _first_epsilon(coordinates, least)
    best, best_key, stalled = coordinates.copy(), (count, -least), 0
    previous = np.inf
    solver = hessian_solver(problem.fixed, problem.kernels.backend)
    try:
        for _ in range(max_rounds):
            if least > 0 or stalled > _PATIENCE:
                break
            regularized = _regularized(problem, functional, parameters, epsilon)
            start, _ = regularized.energy(coordinates)
            minimize(
                regularized,
                coordinates,
                progress,
                tolerance=1e-3,
                max_iterations=_INNER_STEPS,
                keep_valid=False,
                semidefinite=True,
                solver=solver,
            )
            energy, _ = regularized.energy(coordinates)
            least, count = _folds(coordinates)
            epsilon = _next_epsilon(epsilon, least, energy, min(start, previous))
            previous, key = energy, (count, -least)
            lifted = count < best_key[0] or least > 0.9 * -best_key[1]
            stalled = 0 if key < best_key and lifted else stalled + 1
            if key < best_key:
                best, best_key = coordinates.copy(), key
    finally:  # Whatever ends it, Ctrl-C too, the best grid is what remains.
        coordinates[...] = best
    return best_key[0] == 0


def _regularized(
    problem: Problem, functional: Functional, parameters: Mapping[str, float] | None, epsilon: float
) -> Problem:
    """Return the same problem with the regularised barrier, without a weight, over all corners."""
    kernel_set = kernels(functional, "regularized", {**(parameters or {}), "epsilon": epsilon}, problem.kernels.backend)
    # Its energy is finite everywhere, so the line search need not keep corners positive.
    return Problem(replace(kernel_set, barrier=False), problem.fixed, None)


def _folds(coordinates: Array) -> tuple[float, int]:
    """Return the smallest Jacobian, and the number of cells with a corner where it is not positive."""
    jacobians = corner_jacobians(coordinates[0], coordinates[1])
    return float(jacobians.min()), int((jacobians <= 0).any(axis=0).sum())


def _first_epsilon(coordinates: Array, least: float) -> float:
    """Return an epsilon of the size of the folds."""
    size = abs(float(corner_jacobians(coordinates[0], coordinates[1]).mean()))
    return float(np.sqrt(1e-12 * size**2 + 0.04 * min(least, 0.0) ** 2) + 1e-8 * size)


def _next_epsilon(epsilon: float, least: float, energy: float, previous: float) -> float:
    """Lower epsilon as fast as the energy's fall allows (Garanzha et al. 2021, equation 6)."""
    rate = max(1 - energy / previous, _SMALLEST_RATE) if np.isfinite(previous) else _SMALLEST_RATE
    if least >= 0:
        return (1 - rate) * epsilon
    root = np.hypot(least, epsilon)
    return float(epsilon * (1 - rate * root / (abs(least) + root)))


def could_not_unfold(coordinates: Array, definition: Functional) -> str:
    """Return what to tell the user about a grid that stayed folded."""
    folds = quality(Grid.from_planes(*coordinates)).describe_folds()
    return (
        f"untangling with {definition.name} made no more progress; this is the least folded grid that it found. {folds}"
        " If the boundary turns the wrong way there, no valid grid exists: place its nodes or corners differently."
    )
