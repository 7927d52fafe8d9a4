"""What every solver returns: the grid, and how it was reached."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...certificates import Certificate
from ...fields.wall_growth import WallRemark
from ...grids import Change, Grid, Quality, quality
from .differentiable import Differentiable
from .ended import Iterated
from .status import Status


@dataclass(frozen=True, slots=True)
class Step:
    """One line of a solver's history.

    Attributes:
        iteration: sweep or Newton step; 0 is the start.
        energy: the discrete energy; NaN where the solver does not compute it.
        gradient_norm: Euclidean norm of the energy's gradient, or of the Euler-Lagrange residual, in the free nodes.
        min_jacobian: the smallest Jacobian at any corner of any cell.
        stage: `minimize`, `untangle`, `solve` or `control`; a callback sees all stages, on coarser grids too.
        shape: nodes (ni, nj) of the grid that the step was on.
    """

    iteration: int
    energy: float
    gradient_norm: float
    min_jacobian: float
    stage: str
    shape: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Result(Iterated, Differentiable):
    """A solved grid.

    Attributes:
        grid: the last grid; where the solver stopped early, the best valid one that it had.
        converged: whether the convergence test is met.
        status: how the run has ended. Folded cells count for more than a convergence test that is met, and what stopped
            the run early for more than these.
        message: why it ended, as a sentence with its numbers; also what the user must know of the result.
        iterations: sweeps or Newton steps.
        energy: discrete energy of `grid`, over all corners of all cells (or the paper's set, where that was asked for).
        history: one entry per iteration of the last stage.
        certificates: the proofs that no valid grid has this boundary; none for a valid grid. Where untangling ended
            with folds, these are those of a search, too: `certificates(grid, search=True)`. If there are none of
            these, it may be the one of `sliver_certificate`, that every valid grid has a sliver.
        untangled_by: the name of the strategy that made a folded start valid; empty where the start was valid, or the
            result is folded.
        logical_area: of the rectangle that the grid is a map of: 1 for the unit square, the number of cells with
            `spacing="index"`.
        change: some measures of the start and of `grid`; the message has one sentence on what of them is worse. Every
            solver gives it; None in a result made otherwise.
        wall_remarks: growth of walls that the cells cannot keep, with its numbers; the message has their sentences.
        minimum: what the grid is the minimum of, for derivatives; None where it is none, or in a copy from a pickle.
    """

    grid: Grid
    converged: bool
    status: Status
    message: str
    iterations: int
    energy: float
    history: tuple[Step, ...]
    certificates: tuple[Certificate, ...] = ()
    untangled_by: str = ""
    logical_area: float = 1.0
    change: Change | None = None
    wall_remarks: tuple[WallRemark, ...] = ()
    minimum: object = field(default=None, repr=False, compare=False)

    @property
    def quality(self) -> Quality:
        """The quality measures of the grid."""
        return quality(self.grid)

    @property
    def energy_per_corner(self) -> float:
        """The mean energy of the corners of all cells; for `winslow`, 2 is a conformal map of the unit square."""
        return self.energy / (4 * self.logical_area)
