"""The textbook's untangling, as a baseline: regularized barrier, no coarse grids, epsilon as in the paper.

Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, "Foldover-free maps in 50 lines of code", equation 6, with
ten Newton steps for each epsilon, with the positive semidefinite Hessian. The kernels are the project's.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

import gridgen_sym as gg
from gridgen_sym.grids import corner_jacobians, folded_corners
from gridgen_sym.runtime import kernels
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.linear.systems import hessian_solver
from gridgen_sym.solvers.newton.minimize import minimize
from gridgen_sym.solvers.problem import Problem
from gridgen_sym.solvers.run.progress import Progress

_STEPS, _PATIENCE, _SMALLEST_RATE = 10, 8, 0.1


def plain_untangle(start: gg.Grid, name: str = "winslow", *, multigrid: bool, limit: float) -> gg.Grid:
    """Return the grid after untangling: valid, or that of the last round, after several without progress.

    Progress is a round after which fewer cells are folded, or the smallest Jacobian is a tenth nearer to zero.

    Args:
        start: the folded grid.
        name: a functional with a barrier.
        multigrid: solve the linear systems by the project's multigrid, and not by SciPy's sparse LU.
        limit: processor seconds after which no new round begins.
    """
    fixed, coordinates = make_problem(start, name).fixed, start.planes.copy()
    solver = hessian_solver(fixed, "c" if multigrid else "numpy")
    least, folded, mean = _jacobians(coordinates)
    epsilon = float(np.sqrt(1e-12 * mean**2 + 0.04 * min(least, 0.0) ** 2)) + 1e-8 * abs(mean)
    best, stalled, previous = (folded, -least), 0, np.inf
    begin = time.process_time()
    with Progress("plain", show=False) as report:
        while least <= 0 and stalled <= _PATIENCE and time.process_time() - begin < limit:
            regularized = kernels(gg.functional(name), "regularized", {"epsilon": epsilon})
            problem = Problem(replace(regularized, barrier=False), fixed, None)
            before = min(problem.energy(coordinates)[0], previous)
            minimize(
                problem,
                coordinates,
                report,
                tolerance=1e-3,
                max_iterations=_STEPS,
                keep_valid=False,
                semidefinite=True,
                solver=solver,
            )
            previous, (least, folded, _) = problem.energy(coordinates)[0], _jacobians(coordinates)
            stalled = 0 if folded < best[0] or -least < 0.9 * best[1] else stalled + 1
            best = min(best, (folded, -least))
            rate, root = max(1 - previous / before, _SMALLEST_RATE), float(np.hypot(least, epsilon))
            epsilon *= 1 - rate if least >= 0 else 1 - rate * root / (abs(least) + root)
    return gg.Grid.from_planes(*coordinates)


def _jacobians(coordinates: np.ndarray) -> tuple[float, int, float]:
    """Return the smallest Jacobian, the number of folded cells, and the mean Jacobian."""
    jacobians = corner_jacobians(coordinates[0], coordinates[1])
    return float(jacobians.min()), int(folded_corners(jacobians).any(axis=0).sum()), float(jacobians.mean())
