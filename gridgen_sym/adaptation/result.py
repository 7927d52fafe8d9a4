"""What adaptation returns: the grid, the values on it, and how each step went."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..arrays import Array
from ..fields.sampled import grid_field
from ..grids import Change, Grid, Measures, Quality, quality
from ..solvers.run.ended import Ended
from ..solvers.run.status import Status
from ..topology import LayoutQuality, MultiBlock
from ..topology import quality as quality_of_layout
from .equidistribution import Equidistribution, equidistribution


@dataclass(frozen=True, slots=True)
class AdaptStep:
    """One line of the history of an adaptation.

    Attributes:
        step: 0 is the start.
        movement: the largest distance that a node has moved in this step, over the size of the domain; 0 at the start.
        error: estimated L2 error of bilinear interpolation of the solution (see `hierarchical_error`).
        spread: standard deviation over mean of the density of nodes times the cells' areas; 0 where it is
            equidistributed.
        min_jacobian: the smallest Jacobian at any corner of any cell.
        damping: how far the weight went to the one of the density; above 1 where it was extrapolated.
    """

    step: int
    movement: float
    error: float
    spread: float
    min_jacobian: float
    damping: float


class Adapted(Ended):
    """What the results of one block and of several say of how an adaptation ended."""

    __slots__ = ()
    message: str
    history: tuple[AdaptStep, ...]

    @property
    def converged(self) -> bool:
        """Whether the grid has settled, and is no worse than the start by its own estimate."""
        return self.status is Status.CONVERGED

    @property
    def iterations(self) -> int:
        """The number of steps."""
        return len(self.history) - 1

    def __str__(self) -> str:
        """Say in one line how it ended."""
        state = "converged" if self.converged else "NOT converged"
        return f"{state} after {self.iterations} steps: {self.message}"


@dataclass(frozen=True, slots=True)
class AdaptResult(Adapted):
    """An adapted grid.

    Attributes:
        grid: the last grid; always valid if the start was, or could be untangled.
        values: (ni, nj), the solution on `grid`.
        density: (ni, nj), the density of nodes that was asked for, at the nodes of `grid`.
        status: how it ended.
        message: why it stopped, as a sentence; also what the user must know of the result.
        history: one entry per step, the start first.
        start: the grid of step 0: the one that was given, or the untangled one.
    """

    grid: Grid
    values: Array = field(compare=False)
    density: Array = field(compare=False)
    status: Status
    message: str
    history: tuple[AdaptStep, ...]
    start: Grid

    @property
    def before(self) -> Equidistribution:
        """The spread of s·J and sqrt(s)·J over the cells of the start; s is the last density, interpolated."""
        return equidistribution(self.start, grid_field(self.grid, self.density)(self.start.x, self.start.y))

    @property
    def after(self) -> Equidistribution:
        """The spread of s·J and sqrt(s)·J over the cells of `grid`; s is the last density."""
        return equidistribution(self.grid, self.density)

    @property
    def change(self) -> Change:
        """Some measures of the start and of the grid; the message has one sentence on what of them is worse."""
        return change_of(self.start, self.grid)

    @property
    def quality(self) -> Quality:
        """The quality measures of the grid."""
        return quality(self.grid)


@dataclass(frozen=True, slots=True)
class LayoutAdaptResult(Adapted):
    """An adapted grid of several blocks; the attributes are those of `AdaptResult`.

    Attributes:
        grid: the last grid.
        values: the solution on `grid`: for each block, by name, (ni, nj).
        density: the density of nodes that was asked for, likewise.
        status: how it ended.
        message: why it stopped.
        history: one entry per step.
        start: the grid of step 0.
    """

    grid: MultiBlock
    values: Mapping[str, Array] = field(compare=False)
    density: Mapping[str, Array] = field(compare=False)
    status: Status
    message: str
    history: tuple[AdaptStep, ...]
    start: MultiBlock

    @property
    def quality(self) -> LayoutQuality:
        """The quality measures of the grid."""
        return quality_of_layout(self.grid)


def change_of(start: Grid, grid: Grid) -> Change:
    """Return what adaptation has made of the measures of a start; it is asked to change the sizes of cells."""
    return Change(Measures.of(start), Measures.of(grid), sizes_asked=True)
