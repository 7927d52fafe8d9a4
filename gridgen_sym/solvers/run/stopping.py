"""What ends a solver early, and what the user has then: always the best grid so far."""

from __future__ import annotations

from collections.abc import Callable

from .deadline import Stop, StopRequest
from .progress import Progress
from .result import Result


def run_to_result(
    solve: Callable[[], tuple[bool, str]], result: Callable[[bool, str, Stop | None], Result], report: Progress
) -> Result:
    """Run a solver to its end, or to what ends it early, and return what it has by then.

    Args:
        solve: returns whether it converged, and why it stopped; keeps the best grid whatever ends it.
        result: makes the result of these two, and of what has ended the run early.
        report: of the run.

    Raises:
        Exception: whatever the callback raises, as it is; its attribute `result` and a note then hold the best grid.
    """
    try:
        converged, message = solve()
    except StopRequest as stop:
        return result(False, f"{stop}; this is the best grid that it had.", stop.by)
    except KeyboardInterrupt:
        return result(False, "it was interrupted; this is the best grid that it had.", "Ctrl-C")
    except Exception as error:
        if report.callback_error is error:
            best = result(False, "the callback raised an error; this is the best grid.", "callback")
            error.result = best  # type: ignore[attr-defined]
            error.add_note("The callback of a solver raised this; its attribute 'result' holds the best grid so far.")
        raise
    return result(converged, message, None)
