"""What ends a solver early; the user always gets the best grid so far."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from ...runtime.process import time_limited
from .deadline import StopRequest
from .progress import Progress
from .status import Outcome, Status, StopReason

Made = TypeVar("Made")


def run_to_result(solve: Callable[[], Outcome], result: Callable[[Outcome], Made], report: Progress) -> Made:
    """Run a solver until it ends or is stopped, and return its result so far.

    Compilations within honor the deadline, too; only what the energy of the result needs is compiled without a limit.

    Args:
        solve: returns how it has ended; keeps the best grid whatever ends it.
        result: makes the result of that, or of what has ended the run early.
        report: of the run.

    Raises:
        Exception: whatever the callback raises, as it is; its attribute `result` and a note then hold the best grid.
    """
    try:
        with time_limited(report.deadline.check):
            outcome = solve()
    except StopRequest as stop:
        return result(Outcome(Status.stopped(stop.by), f"{stop}; this is the best grid that it had."))
    except KeyboardInterrupt:
        stopped = Status.stopped(StopReason.USER)
        return result(Outcome(stopped, "it was interrupted; this is the best grid that it had."))
    except Exception as error:
        if report.callback_error is error:
            stopped = Status.stopped(StopReason.ERROR)
            best = result(Outcome(stopped, "the callback raised an error; this is the best grid."))
            error.result = best  # type: ignore[attr-defined]
            error.add_note("The callback of a solver raised this; its attribute 'result' holds the best grid so far.")
        raise
    return result(outcome)
