"""Tell of the steps of an adaptation: the user's callback, and a line on the terminal when it takes long."""

from __future__ import annotations

from collections.abc import Callable

from ..solvers.live import LiveLine
from .result import AdaptStep

Callback = Callable[[AdaptStep], None]


class Stopped(Exception):  # noqa: N818 - nothing went wrong
    """Ends an adaptation that the callback or the time limit stops; its text says which."""


class Live(LiveLine):
    """Hands steps on to a callback, shows them, and knows when the time is over."""

    def __init__(self, title: str, callback: Callback | None, show: bool | None, time_limit: float | None) -> None:
        """Begin; `show` is by default whether standard error is a terminal, `time_limit` is in seconds."""
        super().__init__(title, show)
        self._callback, self._limit = callback, time_limit

    def left(self) -> float | None:
        """Return the seconds that are left, or None where there is no limit.

        Raises:
            Stopped: when the time is over.
        """
        if self._limit is None:
            return None
        if self.seconds >= self._limit:
            raise Stopped(f"the time limit of {self._limit:g} seconds is over")
        return self._limit - self.seconds

    def tell(self, step: AdaptStep) -> None:
        """Tell whoever wants to know of a step.

        Raises:
            Stopped: if the callback asks for it, or the time is over.
        """
        if self._callback is not None:
            try:
                self._callback(step)
            except StopIteration:
                raise Stopped("the callback stopped it") from None
        self.display(
            f"step {step.step}, movement {step.movement:.1e}, estimated error {step.error:.2e}, "
            f"spread {step.spread:.2f}, smallest J {step.min_jacobian:.1e}"
        )
        self.left()
