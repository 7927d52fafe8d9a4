"""What every solver returns: the grid, and the whole truth about how it was reached."""

from __future__ import annotations

from dataclasses import dataclass

from ...certificates import Certificate
from ...grids import Grid, Quality, quality
from .deadline import Stop


@dataclass(frozen=True, slots=True)
class Step:
    """One line of a solver's history.

    Attributes:
        iteration: sweep or Newton step; 0 is the start.
        energy: the discrete energy; NaN where the solver does not compute it.
        gradient_norm: Euclidean norm of the energy's gradient, or of the Euler-Lagrange residual, in the free nodes.
        min_jacobian: the smallest Jacobian at any corner of any cell.
        stage: `minimize`, `untangle` or `solve`; a callback sees all stages, on coarser grids too.
        shape: nodes (ni, nj) of the grid that the step was on.
    """

    iteration: int
    energy: float
    gradient_norm: float
    min_jacobian: float
    stage: str
    shape: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Result:
    """A solved grid.

    Attributes:
        grid: the last grid; where the solver stopped early, the best valid one that it had.
        converged: whether the criterion that was asked for is met.
        message: why it stopped, as a sentence; also what the user must know of the result.
        iterations: sweeps or Newton steps.
        energy: discrete energy of `grid`, over all corners of all cells (or the paper's set, where that was asked for).
        history: one entry per iteration of the last stage.
        stopped_by: what ended it early: `Ctrl-C`, `time limit` or `callback`; None if nothing did.
        certificates: the proofs that no valid grid has this boundary; none for a valid grid. Where untangling ended
            with folds, these are those of a search, too: `certificates(grid, search=True)`. If there are none of
            these, it may be the one of `sliver_certificate`, that every valid grid has a sliver.
    """

    grid: Grid
    converged: bool
    message: str
    iterations: int
    energy: float
    history: tuple[Step, ...]
    stopped_by: Stop | None = None
    certificates: tuple[Certificate, ...] = ()

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C, the time limit or the callback stopped it."""
        return self.stopped_by is not None

    @property
    def quality(self) -> Quality:
        """The quality measures of the grid."""
        return quality(self.grid)

    @property
    def energy_per_corner(self) -> float:
        """The energy over the number of corners of all cells; for `winslow`, 2 is a grid of squares."""
        ni, nj = self.grid.shape
        return self.energy / (4 * (ni - 1) * (nj - 1))

    def __str__(self) -> str:
        """Say in one line how it ended."""
        state = "converged" if self.converged else "NOT converged"
        return f"{state} after {self.iterations} iterations: {self.message}"
