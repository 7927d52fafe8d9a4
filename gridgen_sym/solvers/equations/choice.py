"""Which of the grids that an iteration on equations has seen is returned, and what is said of it."""

from __future__ import annotations

from typing import Protocol

from ...arrays import Array
from ..run.status import Outcome, Status
from .system import System


class HasCoordinates(Protocol):
    """A run with the coordinates that it returns."""

    coordinates: Array


def choose_grid(run: HasCoordinates, equations: System, outcome: Outcome, keep_valid: bool) -> Outcome:
    """Choose the grid to return, and report what the type of the equations implies."""
    status, message = outcome
    folded = not equations.smallest(run.coordinates) > 0
    if outcome.converged and folded and keep_valid and True in equations.best:
        run.coordinates, status = equations.best[True][1], Status.HELD_BACK
        message += (
            " That solution is folded; this is the best valid grid on the way (keep_valid=False returns the solution)."
        )
    elif not outcome.converged and equations.best:
        run.coordinates = equations.best[True in equations.best][1]
        message += " This is the best valid grid on the way." if folded and True in equations.best else ""
    if equations.equation_type != "elliptic":
        message += (
            f" The equations are not elliptic ({equations.equation_type}), so a solution need not exist or be unique."
        )
    equations.refresh(run.coordinates)
    return Outcome(status, message)
