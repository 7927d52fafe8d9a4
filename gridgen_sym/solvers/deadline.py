"""The end of a time limit: all that works for long asks now and then whether it has come."""

from __future__ import annotations

import time


class StopRequest(Exception):  # noqa: N818 - nothing went wrong
    """Ends a solver that the callback or the time limit stops; its text says which."""


class Deadline:
    """When a run must end, in seconds from now."""

    def __init__(self, seconds: float | None = None) -> None:
        """Set it; None is never."""
        self._seconds, self._begin = seconds, time.monotonic()

    @property
    def left(self) -> float:
        """The seconds that are left: infinite without a limit, 0 when the time is over."""
        return float("inf") if self._seconds is None else max(0.0, self._begin + self._seconds - time.monotonic())

    def check(self) -> None:
        """Do nothing as long as there is time.

        Raises:
            StopRequest: when it is over.
        """
        if not self.left:
            raise StopRequest(f"the time limit of {self._seconds:g} seconds is over")
