"""What ends a run early: Ctrl-C, a callback, or the time limit, which all long-running stages check."""

from __future__ import annotations

import time

from .status import StopReason


class StopRequest(Exception):  # noqa: N818 - nothing went wrong
    """Ends a run that the callback or the time limit stops; its text says so.

    Attributes:
        by: which of them.
    """

    def __init__(self, by: StopReason, text: str) -> None:
        """Say which, and why."""
        super().__init__(text)
        self.by = by


class Deadline:
    """When a run must end, in seconds from now."""

    def __init__(self, seconds: float | None = None) -> None:
        """Set it; None is never."""
        self._seconds, self._begin = seconds, time.monotonic()

    def check(self) -> float:
        """Return the seconds that are left, infinite without a limit.

        Raises:
            StopRequest: when the time is over.
        """
        if self._seconds is None:
            return float("inf")
        left = self._begin + self._seconds - time.monotonic()
        if left <= 0:
            raise StopRequest(StopReason.TIME_LIMIT, f"the time limit of {self._seconds:g} seconds is over")
        return left
