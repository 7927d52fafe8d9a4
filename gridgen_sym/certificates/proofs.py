"""The certificates of a boundary: the quick ones, and those of a search."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import overload

import numpy as np

from ..deprecation import renamed_arguments
from ..errors import GridgenError, quoted
from ..grids.grid import Grid, check_grid
from ..topology import MultiBlock
from .boundary_proofs import boundary_proofs
from .branching import DEFAULT_BUDGET, Conflict
from .certificate import Certificate, Numbers, point_of, point_text
from .constraint_network import nodes_of
from .layout_proofs import layout_certificates
from .node_constraints import Node
from .search import find_conflict, find_sliver

# A message names so many cells, and counts the others.
_MOST_NAMED = 6


@overload
def certificates(
    grid: Grid, *, search: bool = False, budget: int = ..., check: Callable[[], object] | None = None
) -> tuple[Certificate, ...]: ...


@overload
def certificates(
    grid: MultiBlock, *, search: bool = False, budget: int = ..., check: Callable[[], object] | None = None
) -> dict[str, tuple[Certificate, ...]]: ...


@renamed_arguments(work="budget")
def certificates(
    grid: Grid | MultiBlock,
    *,
    search: bool = False,
    budget: int = DEFAULT_BUDGET,
    check: Callable[[], object] | None = None,
) -> tuple[Certificate, ...] | dict[str, tuple[Certificate, ...]]:
    """Return proofs that no valid grid has the boundary nodes of a grid. The inner nodes do not matter.

    A grid is valid if all four corner Jacobians of every cell are positive. Boundary nodes are fixed at their stored
    coordinates. The proofs are exact: see `Certificate` for their kinds and their arithmetic. For a valid grid there
    are none. The absence of a certificate does not imply that a valid grid exists.

    Consequences of another certificate are not listed: a clockwise boundary also has four wrong corners.

    Of several blocks the outer boundary is fixed, and nodes on connections move. So a block whose whole boundary is
    an outer one has all proofs, and blocks that make up a plain grid have those of that grid; of other blocks there are
    only the kinds 'coincident', 'corner' and 'spike', at nodes of the outer boundary whose neighbors on it are of the
    same block.

    Args:
        grid: any grid with the boundary in question, such as `transfinite(bottom, top, left, right)`; or several
            blocks.
        search: if there is no quick proof, search near the folded cells of `grid` for cells that cannot all be valid.
            This succeeds most often for a grid with few folded cells, as `untangle` returns it.
        budget: how many constraints each of the few attempts of the search may apply, at about 50 microseconds each.
            The default takes a few seconds; hard boundaries need a hundred times as many, or stay undecided.
        check: called at most a few tenths of a second apart once the search begins; what it raises ends it.

    Returns:
        The proofs. Of several blocks they are by block: a mapping from names, without the blocks that have none; the
        name of blocks that are one grid is `a + b`, or `a + ... + z` of many.

    Raises:
        GridgenError: if `grid` is no grid, or `budget` no positive integer.
    """
    if isinstance(grid, MultiBlock):
        return layout_certificates(grid, partial(certificates, search=search, budget=budget, check=check))
    budget = _check_arguments(grid, budget)
    found = boundary_proofs(grid, check)
    if search and not found:
        conflict = find_conflict(grid, budget, check)
        found = [_searched(grid, conflict)] if conflict else []
    return tuple(found)


@renamed_arguments(work="budget")
def sliver_certificate(
    grid: Grid,
    *,
    budget: int = DEFAULT_BUDGET,
    check: Callable[[], object] | None = None,
) -> Certificate | None:
    """Return a proof that every valid grid with given boundary nodes, if there is one, has a sliver.

    In every valid grid some corner Jacobian is at most a fraction of the Jacobian predicted from the boundary
    spacing (`expected_jacobians`): of 0.1, 0.03, ... 1e-6 the smallest for which that was proved. So the corner is
    nearly folded, or its cell is small, as in a narrow neck. It is meant for boundaries that stay undecided: no valid
    grid is found, and no proof that there is none. For most of these it exists. The decisions are exact, as for
    `certificates`, and its absence does not imply anything.

    Args:
        grid: as for `certificates`; the search is made near its folded cells.
        budget: as for `certificates`, for each of the fractions.
        check: as for `certificates`.

    Returns:
        A certificate of kind 'sliver'. None if no proof was found, for a valid grid, and where one of the quick
        `certificates` proves more.

    Raises:
        GridgenError: as `certificates`.
    """
    budget = _check_arguments(grid, budget)
    sliver = None if boundary_proofs(grid, check) else find_sliver(grid, budget, check)
    return _searched(grid, sliver) if sliver else None


def _check_arguments(grid: Grid, budget: int) -> int:
    """Return the budget, or raise what `certificates` does."""
    check_grid(grid)
    if not isinstance(budget, (int, np.integer)) or isinstance(budget, bool) or budget < 1:
        raise GridgenError(
            f"budget must be an integer, at least 1, the number of constraints to apply; came {quoted(budget)}"
        )
    return int(budget)


def _searched(grid: Grid, conflict: Conflict) -> Certificate:
    """Return the certificate of cells that cannot all be valid, or not all as large as they should be."""
    ni, nj = grid.shape
    nodes = tuple(node for cell in conflict.cells for node in nodes_of(cell))
    fixed = {(i, j) for i, j in nodes if i in (0, ni - 1) or j in (0, nj - 1)}
    point = point_of(np.mean([grid.planes[:, i, j] for i, j in sorted(fixed or set(nodes))], axis=0))
    cells, near = _cells_text(conflict.cells), point_text(point)
    help_text = "Take more cells there, or move the boundary nodes"
    numbers, fraction = Numbers(cells=len(conflict.cells)), conflict.jacobian_fraction
    if not fraction:
        message = (
            f"no valid grid exists: near {near} there is no room for the inner nodes. Wherever they are, "
            f"not all of {cells} can be valid while every other cell is. {help_text}"
        )
        return Certificate("conflict", nodes, point, numbers, message)
    numbers["jacobian_fraction"] = fraction
    message = (
        f"every valid grid, if there is one, has a nearly folded or small cell: near {near} there is little room for "
        f"the inner nodes. Wherever they are, not all corner Jacobians of {cells} can exceed {100 * fraction:g} "
        f"% of the area predicted from the boundary spacing. {help_text}"
    )
    return Certificate("sliver", nodes, point, numbers, message)


def _cells_text(cells: tuple[Node, ...]) -> str:
    """Return the first of some cells, and how many there are, as text for a message."""
    named = ", ".join(map(str, cells[:_MOST_NAMED]))
    more = f" and {len(cells) - _MOST_NAMED} more" if len(cells) > _MOST_NAMED else ""
    return f"the {len(cells)} cells {named}{more}" if len(cells) > 1 else f"the cell {named}"
