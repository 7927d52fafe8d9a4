"""What a grid is adapted to, in one form: a function that gives nodal values on any grid."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError
from ..fields.function import required_arguments
from ..fields.sampled import SampledField
from ..fields.scalar import as_scalar
from ..grids import Grid
from ..topology import MultiBlock
from .layout_nodes import nodes_of
from .recovery import nodal_values
from .transfer import transfer

Solution: TypeAlias = "str | Callable[..., npt.ArrayLike] | npt.ArrayLike"

#: Moves between two solutions of the user's own solver; a function of x and y is evaluated after each move.
_MOVES_PER_SOLUTION = 3
#: Values at nodes are interpolated within one block only.
_NO_VALUES = (
    "nodal values of several blocks are not interpolated from block to block: pass your solver, a function of x and y, "
    "a formula, or samples with their positions"
)


@dataclass(frozen=True, slots=True)
class Source:
    """Where nodal values come from.

    Attributes:
        function: gives them on a grid, of one block or several.
        moves: how often to move the nodes before asking again.
        sampled: whether only samples on one grid are known, so that derivatives must be taken there.
    """

    function: Callable[[Any], Any]
    moves: int = 1
    sampled: bool = False

    def on(self, grid: Grid | MultiBlock, step: int) -> Array:
        """Return the checked nodal values on the grid of a step, as its `Nodes` have them."""
        try:
            values = self.function(grid)
        except GridgenError:
            raise
        except Exception as error:  # A user's solver may raise anything.
            raise GridgenError(
                f"the solution cannot be had on the grid of step {step}: your solver raised {error!r}"
            ) from error
        return nodes_of(grid).values(values, f"the solution on the grid of step {step}")


def source_of(solution: Solution, grid: Grid | MultiBlock) -> Source:
    """Return a solution given in any form as a `Source`.

    Raises:
        GridgenError: for a function of no or more than two arguments, or nodal values that do not fit the grid; for
            nodal values of several blocks.
    """
    if isinstance(grid, MultiBlock) and isinstance(solution, Mapping):
        raise GridgenError(_NO_VALUES)
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
        if isinstance(grid, MultiBlock):
            raise GridgenError(_NO_VALUES)
        values = nodal_values(grid, given, "the solution")
        return Source(lambda on: transfer(grid, values, on), sampled=True)

    def evaluated(on: Grid | MultiBlock) -> Any:  # noqa: ANN401 - as a solver gives them
        nodes = nodes_of(on)
        field.check_samples(nodes.x, nodes.y)
        return nodes.given_back(field.values(nodes.x, nodes.y))

    return Source(evaluated)
