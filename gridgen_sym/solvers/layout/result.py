"""What solvers return for several blocks."""

from __future__ import annotations

from dataclasses import dataclass

from ...topology import MultiBlock
from ...topology.quality import LayoutQuality, quality
from ..run.result import Step
from ..run.status import Status, StopReason


@dataclass(frozen=True, slots=True)
class LayoutResult:
    """A solved grid of several blocks.

    Attributes:
        grid: the last grid; where the solver stopped early, the best valid one that it had.
        converged: whether the convergence test is met.
        status: how the run has ended; see `Result`.
        message: why it ended, as a sentence with its numbers; also what the user must know of the result.
        iterations: Newton steps of the last stage.
        energy: the discrete energy of `grid`, over all corners of all cells.
        history: one entry per iteration of the last stage; the shape of a step is the number of its nodes, and 1.
        untangled_by: what made a folded start valid; empty where the start was valid, or the result is folded.
    """

    grid: MultiBlock
    converged: bool
    status: Status
    message: str
    iterations: int
    energy: float
    history: tuple[Step, ...]
    untangled_by: str = ""

    @property
    def stopped_by(self) -> StopReason | None:
        """What ended the run early; None if nothing did."""
        return self.status.stop_reason

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C, the time limit or the callback stopped it."""
        return self.stopped_by is not None

    @property
    def quality(self) -> LayoutQuality:
        """The quality measures of the grid."""
        return quality(self.grid)

    def __str__(self) -> str:
        """Report in one line how it ended."""
        state = "converged" if self.converged else "NOT converged"
        return f"{state} after {self.iterations} iterations: {self.message}"
