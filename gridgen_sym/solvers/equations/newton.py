"""Newton's method on the discrete Euler–Lagrange equations.

Where they are elliptic, the linear systems are solved by the backend's solver and a line search keeps the residual's
norm falling. Where they are not, or where that fails, Levenberg's damping minimizes the norm instead.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array
from ...grids import corner_jacobians
from ..convergence import converged
from ..linear.solution import LinearSolver
from ..linear.sparse import assemble_jacobian, to_field, to_vector
from ..linear.systems import jacobian_solver
from ..norms import norm_of
from ..run.deadline import Deadline
from ..run.progress import Progress
from ..run.status import Outcome, Status
from ..run.step_control import StepControl, jacobian_floor
from .residual import Equations

_HALVINGS = 30
#: Relative residual of the linear solves.
_FORCING = 1e-3
#: A step that lowers the norm by less than this factor makes no progress.
_LITTLE = 0.99
#: Levenberg's damping: where it begins and ends, over the mean diagonal of the normal equations.
_FIRST_DAMPING, _LARGEST_DAMPING = 1e-3, 1e12


def solve_by_newton(
    equations: Equations,
    coordinates: Array,
    report: Progress,
    tolerance: float,
    limit: int,
    keep_valid: bool,
    reference: float | None = None,
    damps: bool = True,
) -> Outcome:
    """Newton's method with a line search on the residual's norm, or Levenberg's damping where not elliptic.

    With `keep_valid`, and for barrier functionals, no step folds a cell of a valid grid. The norm must fall from
    `reference`, by default from that of the start. Without `damps` it ends where the line search does, which is soon.
    """
    problem, damping = equations.problem, 0.0
    if problem.kernels.equation_type != "elliptic":
        damping = _FIRST_DAMPING
    residual = equations.residual(coordinates)
    norm = norm_of(residual)
    first = norm if reference is None else reference
    floor = equations.round_off(coordinates)
    solver = jacobian_solver(problem.fixed, problem.kernels.backend)
    first_smallest = float(corner_jacobians(*coordinates).min())
    control = StepControl(keep_valid or problem.kernels.barrier, jacobian_floor(first_smallest))
    for iteration in range(limit + 1):
        smallest = equations.remember(coordinates, norm)
        report.step(iteration, float("nan"), norm, smallest)
        if norm <= max(tolerance * first, floor):
            return converged("residual", norm, first, iteration, str(control))
        if iteration == limit or control.holds_back:
            break
        guard = control.lowest(smallest)
        allowed = _LARGEST_DAMPING if damps else 0.0
        step, damping, folds = _reduce(
            equations, solver, coordinates, residual, (damping, allowed), guard, report.deadline
        )
        if step is None:
            why = f"no step lowers the residual's norm further; it is {norm:.2e}, {norm / first:.1e} of its first."
            return Outcome(Status.STALLED, why)
        coordinates += step
        before = norm
        problem.refresh(coordinates)
        residual = equations.residual(coordinates)
        norm = norm_of(residual)
        control.count(folds, norm <= _LITTLE * before)
    if control.holds_back:
        return Outcome(
            Status.HELD_BACK,
            "every step toward a solution that was tried would fold a cell; whether a valid grid solves the equations "
            f"is not known. The residual's norm is {norm:.2e}, {norm / first:.1e} of its first value. This is the best "
            "valid grid; keep_valid=False lets cells fold.",
        )
    why = f"{limit} steps have brought the residual's norm to {norm:.2e}, {norm / first:.1e} of its first value."
    return Outcome(Status.ITERATION_LIMIT, why + str(control))


def _reduce(
    equations: Equations,
    solver: LinearSolver,
    coordinates: Array,
    residual: Array,
    dampings: tuple[float, float],
    guard: float,
    deadline: Deadline,
) -> tuple[Array | None, float, bool]:
    """Return a step that lowers the residual's norm (None if there is none), and the damping for the next one.

    Also, whether a longer step was refused because it would have folded a cell. Given are the damping of this step, and
    the greatest one that is allowed.
    """
    folds, (damping, largest) = False, dampings
    norm, fixed = norm_of(residual), equations.problem.fixed
    if damping == 0.0:
        usable = solver.set_operator(equations.jacobian(coordinates))
        direction = solver.solve(-residual, _FORCING).vector if usable else np.full_like(residual, np.nan)
        for length in 0.5 ** np.arange(_HALVINGS):
            trial = coordinates + length * direction
            if not _above(trial, guard):
                folds = True
            elif norm_of(equations.residual(trial)) <= (1 - 1e-4 * length) * norm:
                return length * direction, 0.0, folds
        damping = _FIRST_DAMPING
        if largest < damping:
            return None, 0.0, folds
    matrix = assemble_jacobian(equations.jacobian(coordinates), fixed)
    right = -to_vector(residual, fixed)
    normal, slope = (matrix.T @ matrix).tocsc(), matrix.T @ right
    size = normal.diagonal().mean()
    while damping < largest:
        deadline.check()
        from scipy.sparse import identity

        direction = to_field(_solve(normal + damping * size * identity(slope.size, format="csc"), slope), fixed)
        trial = coordinates + direction
        if not _above(trial, guard):
            folds = True
        elif norm_of(equations.residual(trial)) <= (1 - 1e-6) * norm:
            return direction, damping / 5, folds
        damping *= 4
    return None, damping, folds


def _above(trial: Array, guard: float) -> bool:
    """Return whether a grid is finite and its smallest Jacobian is above the guard."""
    return bool(np.isfinite(trial).all() and corner_jacobians(trial[0], trial[1]).min() > guard)


def _solve(matrix: Any, right: Array) -> Array:  # noqa: ANN401
    """Solve a sparse system; a singular one gives NaN, which no step accepts."""
    from scipy.sparse.linalg import splu

    try:
        solution: Array = splu(matrix).solve(right)
    except RuntimeError:
        return np.full_like(right, np.nan)
    return solution
