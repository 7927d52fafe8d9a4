"""How a run has ended: as values that a program can test, without reading a sentence."""

from __future__ import annotations

from enum import Enum, StrEnum
from typing import NamedTuple


class StopReason(StrEnum):
    """What ended a run early; each is equal to its text."""

    USER = "Ctrl-C"
    TIME_LIMIT = "time limit"
    CALLBACK = "callback"
    ERROR = "error"


class Status(Enum):
    """How a run has ended; the value is the sentence that says so."""

    CONVERGED = "The convergence test is met."
    ITERATION_LIMIT = "The iterations that were allowed were not enough."
    STALLED = "No step makes progress any more."
    DIVERGED = "The steps diverge."
    HELD_BACK = "Steps that make progress would fold a cell."
    NOT_DIFFERENTIABLE = "The functional has no derivative at the grid."
    UNSETTLED = "The weight, or a field, changes as much as the grid does."
    WORSE = "The grid has settled, but it is worse than the start by its own estimate."
    FOLDED = "Cells are folded, and no proof is known that this cannot be avoided."
    IMPOSSIBLE = "Cells are folded, and no valid grid has these boundary nodes: a certificate proves it."
    STOPPED_BY_USER = "Ctrl-C stopped the run."
    STOPPED_BY_TIME_LIMIT = "The time limit stopped the run."
    STOPPED_BY_CALLBACK = "The callback stopped the run."
    STOPPED_BY_ERROR = "An error in the user's own solver or callback stopped the run."

    @classmethod
    def stopped(cls, reason: StopReason) -> Status:
        """Return the status of a run that was stopped early."""
        return cls[f"STOPPED_BY_{reason.name}"]

    @property
    def stop_reason(self) -> StopReason | None:
        """What ended the run early; None if nothing did."""
        prefix = "STOPPED_BY_"
        return StopReason[self.name.removeprefix(prefix)] if self.name.startswith(prefix) else None


class Outcome(NamedTuple):
    """How an iteration has ended.

    Attributes:
        status: for programs.
        message: for people: why it ended, as a sentence with its numbers.
    """

    status: Status
    message: str

    @property
    def converged(self) -> bool:
        """Whether the convergence test is met."""
        return self.status is Status.CONVERGED
