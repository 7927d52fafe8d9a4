"""Tell of the steps of an adaptation: the user's callback, and a line on the terminal when it takes long."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

from ..solvers.progress import PATIENCE
from .result import AdaptStep

Callback = Callable[[AdaptStep], None]


class Live:
    """Hands steps on to a callback; shows a live line on a terminal once a run takes longer than `PATIENCE`."""

    def __init__(self, title: str, callback: Callback | None, show: bool | None) -> None:
        """Begin; `show` is by default whether standard error is a terminal."""
        self._title, self._callback = title, callback
        self._show = sys.stderr.isatty() if show is None else show
        self._begin = time.monotonic()
        self._status: Any = None

    def __enter__(self) -> Live:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Take the line off the terminal."""
        if self._status is not None:
            self._status.stop()

    def tell(self, step: AdaptStep) -> None:
        """Tell whoever wants to know of a step."""
        if self._callback is not None:
            self._callback(step)
        if not self._show or time.monotonic() - self._begin <= PATIENCE:
            return
        text = (
            f"{self._title}: step {step.step}, movement {step.movement:.1e}, estimated error {step.error:.2e}, "
            f"spread {step.spread:.2f}, smallest J {step.min_jacobian:.1e}"
        )
        if self._status is None:
            from rich.console import Console

            self._status = Console(stderr=True).status(text)
            self._status.start()
        self._status.update(text)
