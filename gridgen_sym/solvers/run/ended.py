"""What all results say of how their run has ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .status import Status, StopReason

if TYPE_CHECKING:
    from ...grids import Grid
    from ...topology import MultiBlock


class Ended:
    """A result with a grid and a status."""

    __slots__ = ()
    grid: Grid | MultiBlock
    status: Status

    @property
    def stopped_by(self) -> StopReason | None:
        """What ended the run early; None if nothing did."""
        return self.status.stop_reason

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C, the time limit or the callback stopped it."""
        return self.stopped_by is not None

    def _repr_html_(self) -> str:
        """Show in a notebook how it ended, and the grid."""
        from ...plotting.notebook import html_of

        return html_of(self.grid, str(self))


class Iterated(Ended):
    """A result of iterations that converge or not."""

    __slots__ = ()
    converged: bool
    iterations: int
    message: str

    def __str__(self) -> str:
        """Report in one line how it ended."""
        state = "converged" if self.converged else "NOT converged"
        return f"{state} after {self.iterations} iterations: {self.message}"
