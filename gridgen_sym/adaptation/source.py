"""What a grid is adapted to, in one form: a function that gives nodal values on any grid."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError
from ..fields.weight_formula import Compiled, compiled_formula, is_expression
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
            raise GridgenError(f"the solution cannot be had on the grid of step {step}: {error!r}") from error
        return nodal_values(grid, values, f"the solution on the grid of step {step}")


def source_of(solution: Solution, grid: Grid) -> Source:
    """Return a solution given in any form as a `Source`.

    Raises:
        GridgenError: for a function of no or more than two arguments, or nodal values that do not fit the grid.
    """
    given: Any = solution
    if isinstance(given, str) or is_expression(given):
        function = compiled_formula(given, "")
        return Source(lambda on: _spread(_quietly(function, on), on))
    if not callable(given):
        values = nodal_values(grid, given, "the solution")
        return Source(lambda on: transfer(grid, values, on), sampled=True)
    arguments = _arguments(given)
    if arguments == 1:
        return Source(given, moves=_MOVES_PER_SOLUTION)
    if arguments == 2:
        return Source(lambda on: _spread(given(on.x, on.y), on))
    raise GridgenError(
        f"a solution must be your solver, a function of one grid, or a function of two arrays (x, y); came one of "
        f"{arguments} arguments"
    )


def _arguments(function: Callable[..., Any]) -> int:
    """Return how many arguments a function must be given."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # NumPy's own functions do not tell.
        return int(getattr(function, "nin", 0))
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(one.kind in kinds and one.default is inspect.Parameter.empty for one in parameters)


def _quietly(formula: Compiled, grid: Grid) -> npt.ArrayLike:
    """Evaluate a formula; where it is not finite, that is an error with the node's number, and not a warning."""
    with np.errstate(all="ignore"):
        return formula(grid.x, grid.y)


def _spread(values: npt.ArrayLike, grid: Grid) -> npt.ArrayLike:
    """Return a single number as a field."""
    return np.full(grid.shape, values) if np.ndim(values) == 0 else values
