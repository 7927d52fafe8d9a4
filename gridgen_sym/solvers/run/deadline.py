"""What ends a run before its end: Ctrl-C, a callback, or the time limit, for which all that works for long asks."""

from __future__ import annotations

import time
from typing import Literal

#: What may end a run early.
Stop = Literal["Ctrl-C", "time limit", "callback"]


class StopRequest(Exception):  # noqa: N818 - nothing went wrong
    """Ends a run that the callback or the time limit stops; its text says so.

    Attributes:
        by: which of them.
    """

    def __init__(self, by: Stop, text: str) -> None:
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
            raise StopRequest("time limit", f"the time limit of {self._seconds:g} seconds is over")
        return left
