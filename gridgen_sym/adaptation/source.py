"""What a grid is adapted to, in one form: a function that gives nodal values on any grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError
from ..fields.function import required_arguments
from ..fields.sampled import SampledField
from ..fields.scalar import as_scalar
from ..grids import Grid
from .recovery import nodal_values
from .transfer import transfer

Solution: TypeAlias = "str | Callable[..., npt.ArrayLike] | npt.ArrayLike"

#: Moves between two solutions of the user's own solver; a function of x and y is evaluated after each move.
_MOVES_PER_SOLUTION = 3


@dataclass(frozen=True, slots=True)
class Source:
    """Where nodal values come from.

    Attributes:
        function: gives them on a grid.
        moves: how often to move the nodes before asking again.
        sampled: whether only samples on one grid are known, so that derivatives must be taken there.
    """

    function: Callable[[Grid], npt.ArrayLike]
    moves: int = 1
    sampled: bool = False

    def on(self, grid: Grid, step: int) -> Array:
        """Return the checked nodal values (ni, nj) on the grid of a step."""
        try:
            values = self.function(grid)
        except GridgenError:
            raise
        except Exception as error:  # A user's solver may raise anything.
            raise GridgenError(
                f"the solution cannot be had on the grid of step {step}: your solver raised {error!r}"
            ) from error
        return nodal_values(grid, values, f"the solution on the grid of step {step}")


def source_of(solution: Solution, grid: Grid) -> Source:
    """Return a solution given in any form as a `Source`.

    Raises:
        GridgenError: for a function of no or more than two arguments, or nodal values that do not fit the grid.
    """
    given: Any = solution
    if callable(given) and not isinstance(given, SampledField):
        arguments = required_arguments(given)
        if arguments == 1:
            return Source(given, moves=_MOVES_PER_SOLUTION)
        if arguments != 2:
            raise GridgenError(
                "the solution must be your solver, a function of one grid, or a function of two arrays (x, y); came "
                f"one of {arguments} arguments"
            )
    field = as_scalar(given, "the solution")
    if field.per_node:
        values = nodal_values(grid, given, "the solution")
        return Source(lambda on: transfer(grid, values, on), sampled=True)

    def evaluated(on: Grid) -> Array:
        field.check_samples(on.x, on.y)
        return field.values(on.x, on.y)

    return Source(evaluated)
