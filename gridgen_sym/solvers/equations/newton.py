"""Newton's method on the discrete Euler–Lagrange equations.

Where they are elliptic, the linear systems are solved by the backend's solver and a line search keeps the residual's
norm falling. Where they are not, or where that fails, Levenberg's damping minimizes the norm instead.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array
from ..convergence import converged
from ..run.deadline import Deadline
from ..run.progress import Progress
from ..run.status import Outcome, Status
from ..run.step_control import StepControl, jacobian_floor
from .system import System

_HALVINGS = 30
#: A step that lowers the norm by less than this factor makes no progress.
_LITTLE = 0.99
#: Levenberg's damping: where it begins and ends, over the mean diagonal of the normal equations.
_FIRST_DAMPING, _LARGEST_DAMPING = 1e-3, 1e12


def solve_by_newton(
    equations: System,
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
    damping = 0.0
    if equations.equation_type != "elliptic":
        damping = _FIRST_DAMPING
    residual = equations.residual(coordinates)
    norm = equations.norm(residual)
    first = norm if reference is None else reference
    floor = equations.round_off(coordinates)
    control = StepControl(keep_valid or equations.barrier, jacobian_floor(equations.smallest(coordinates)))
    for iteration in range(limit + 1):
        smallest = equations.remember(coordinates, norm)
        report.step(iteration, float("nan"), norm, smallest)
        if norm <= max(tolerance * first, floor):
            return converged("residual", norm, first, iteration, str(control))
        if iteration == limit or control.holds_back:
            break
        guard = control.lowest(smallest)
        allowed = _LARGEST_DAMPING if damps else 0.0
        step, damping, folds = _reduce(equations, coordinates, residual, (damping, allowed), guard, report.deadline)
        if step is None:
            why = f"no step lowers the residual's norm further; it is {norm:.2e}, {norm / first:.1e} of its first."
            return Outcome(Status.STALLED, why)
        coordinates += step
        before = norm
        equations.refresh(coordinates)
        residual = equations.residual(coordinates)
        norm = equations.norm(residual)
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
    equations: System,
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
    norm = equations.norm(residual)
    if damping == 0.0:
        direction = equations.direction(coordinates, residual)
        for length in 0.5 ** np.arange(_HALVINGS):
            trial = coordinates + length * direction
            if not _above(equations, trial, guard):
                folds = True
            elif equations.norm(equations.residual(trial)) <= (1 - 1e-4 * length) * norm:
                return length * direction, 0.0, folds
        damping = _FIRST_DAMPING
        if largest < damping:
            return None, 0.0, folds
    matrix, right = equations.linearized(coordinates, residual)
    normal, slope = (matrix.T @ matrix).tocsc(), -(matrix.T @ right)
    size = normal.diagonal().mean()
    while damping < largest:
        deadline.check()
        from scipy.sparse import identity

        direction = equations.field(_solve(normal + damping * size * identity(slope.size, format="csc"), slope))
        trial = coordinates + direction
        if not _above(equations, trial, guard):
            folds = True
        elif equations.norm(equations.residual(trial)) <= (1 - 1e-6) * norm:
            return direction, damping / 5, folds
        damping *= 4
    return None, damping, folds


def _above(equations: System, trial: Array, guard: float) -> bool:
    """Return whether a grid is finite and its smallest Jacobian is above the guard."""
    return bool(np.isfinite(trial).all() and equations.smallest(trial) > guard)


def _solve(matrix: Any, right: Array) -> Array:  # noqa: ANN401
    """Solve a sparse system; a singular one gives NaN, which no step accepts."""
    from scipy.sparse.linalg import splu

    try:
        solution: Array = splu(matrix).solve(right)
    except RuntimeError:
        return np.full_like(right, np.nan)
    return solution
