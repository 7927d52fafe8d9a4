"""A line on the terminal that shows the progress of a long run."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

#: Seconds after which a run starts to show what it does.
PATIENCE = 1.0


class LiveLine:
    """Shows a line on standard error once a run takes longer than `PATIENCE`, and removes it at the end."""

    def __init__(self, title: str, show: bool | None = None) -> None:
        """Begin.

        Args:
            title: what is being done.
            show: whether to show the line; by default, if standard error is a terminal.
        """
        self._title = title
        self._show = sys.stderr.isatty() if show is None else show
        self._begin = time.monotonic()
        self._status: Any = None

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove the line from the terminal."""
        if self._status is not None:
            self._status.stop()

    @property
    def seconds(self) -> float:
        """Return the seconds since the start."""
        return time.monotonic() - self._begin

    def display(self, text: str) -> None:
        """Show the progress of the run, if it takes long."""
        if not self._show or self.seconds <= PATIENCE:
            return
        text = f"{self._title}: {text}"
        if self._status is None:
            from rich.console import Console

            self._status = Console(stderr=True).status(text)
            self._status.start()
        self._status.update(text)
