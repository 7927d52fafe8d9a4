"""One grid of an example, made by the paper's method, with the numbers that the table shows of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..fields import Weight
from ..grids import Grid, Quality, quality
from ..solvers import Result, energy, optimize

#: Sweeps of the local method within which an example must converge; where it does not, Newton gives the limit.
MOST_SWEEPS = 1200


@dataclass(frozen=True, slots=True)
class Case:
    """One grid of an example.

    Attributes:
        label: its name in the table.
        grid: the grid.
        effort: sweeps of the local method, or Newton steps; empty for a grid that nothing was minimized for.
        start_energy: energy of the start from transfinite interpolation; None where there is none.
        energy: energy of the grid; None where there is none.
        converged: the solver's own word; None where nothing was solved.
        message: the solver's own sentence.
        extra: further numbers for the table, by the heading of their column.
    """

    label: str
    grid: Grid
    effort: str = ""
    start_energy: float | None = None
    energy: float | None = None
    converged: bool | None = None
    message: str = ""
    extra: Mapping[str, float] = field(default_factory=dict)

    @property
    def quality(self) -> Quality:
        """The quality measures of the grid."""
        return quality(self.grid)

    @property
    def evenness(self) -> float:
        """The smallest J over the mean one: 1 where all cells are alike, negative where one is inverted."""
        return self.quality.min_jacobian / self.quality.mean_jacobian


def sweep(
    label: str,
    start: Grid,
    functional: str,
    *,
    weight: Weight | None = None,
    sweeps: int = MOST_SWEEPS,
    keep_valid: bool = False,
) -> Case:
    """Return the grid of the paper's method: local minimization, node by node, `sweeps` times at most."""
    result = optimize(
        start,
        functional,
        "local",
        weight=weight,
        max_iterations=sweeps,
        keep_valid=keep_valid,
        spacing="index",
        progress=False,
    )
    start_energy = energy(start, functional, weight=weight, spacing="index")
    return _case(label, result, f"{result.iterations} sweeps", start_energy)


def limit(case: Case, functional: str) -> Case:
    """Return the minimum that the sweeps of `case` were on the way to, by Newton's method from where they stopped."""
    result = optimize(case.grid, functional, "newton", keep_valid=False, spacing="index", progress=False)
    return _case(f"{case.label} (limit)", result, f"{result.iterations} Newton steps more", case.start_energy)


def converge(label: str, start: Grid, functional: str) -> tuple[Case, ...]:
    """Return the grid of the paper's method and, if its sweeps were too few, also their limit."""
    case = sweep(label, start, functional)
    return (case,) if case.converged else (case, limit(case, functional))


def _case(label: str, result: Result, effort: str, start_energy: float | None) -> Case:
    return Case(label, result.grid, effort, start_energy, result.energy, result.converged, result.message)
