"""Report the steps of an adaptation: the user's callback, and a line on the terminal when it takes long."""

from __future__ import annotations

from collections.abc import Callable

from ..solvers.run.deadline import StopRequest
from ..solvers.run.live import LiveLine
from ..solvers.run.status import StopReason
from .result import AdaptStep

Callback = Callable[[AdaptStep], None]


class Live(LiveLine):
    """Hands steps on to a callback, and shows them."""

    def __init__(self, title: str, callback: Callback | None, show: bool | None) -> None:
        """Begin; `show` is by default whether standard error is a terminal."""
        super().__init__(title, show)
        self._callback = callback

    def report(self, step: AdaptStep) -> None:
        """Report a step to the callback, and show it.

        Raises:
            StopRequest: if the callback asks for it.
        """
        if self._callback is not None:
            try:
                self._callback(step)
            except StopIteration:
                raise StopRequest(StopReason.CALLBACK, "the callback stopped it") from None
        self.display(
            f"step {step.step}, movement {step.movement:.1e}, estimated error {step.error:.2e}, "
            f"spread {step.spread:.2f}, smallest J {step.min_jacobian:.1e}"
        )
