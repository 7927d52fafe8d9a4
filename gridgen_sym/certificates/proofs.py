"""Certificates for the boundary of a grid: the quick ones, and those of a search."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..errors import GridgenError
from ..grids.grid import Grid, check_grid
from .boundary_proofs import boundary_proofs
from .certificate import Certificate, point_of, point_text
from .conflict import LITTLE_WORK, Conflict
from .neck import Node
from .network import nodes_of
from .search import find_conflict, find_sliver

# A message names so many cells, and counts the others.
_MOST_NAMED = 6


def certificates(
    grid: Grid, *, search: bool = False, work: int = LITTLE_WORK, check: Callable[[], object] | None = None
) -> tuple[Certificate, ...]:
    """Return proofs that the boundary nodes of a grid, which do not move, admit no grid without a folded cell.

    The inner nodes do not matter. None for a valid grid; and no certificate is no proof that a valid grid exists.
    What follows from another certificate is not listed: a clockwise boundary has four wrong corners.

    Args:
        grid: any grid with the boundary in question, such as `transfinite(bottom, top, left, right)`.
        search: where there is no certificate otherwise, search near the folded cells of `grid` for cells that cannot
            all be valid. It finds most on the least folded grid, as `untangle` returns it.
        work: how many steps each of the few attempts of the search may take, some 50 microseconds each. The
            default means a few seconds; hard boundaries need a hundred times as many, or are never decided.
        check: called again and again during the search; what it raises ends it.

    Raises:
        GridgenError: if `grid` is no Grid, or `work` no positive whole number.
    """
    _check_arguments(grid, work)
    found = boundary_proofs(grid)
    if search and not found:
        conflict = find_conflict(grid, work, check)
        found = [_searched(grid, conflict)] if conflict else []
    return tuple(found)


def sliver_certificate(
    grid: Grid, *, work: int = LITTLE_WORK, check: Callable[[], object] | None = None
) -> Certificate | None:
    """Return a proof that every valid grid with some boundary nodes, if there is one, has a sliver.

    Some corner Jacobian is at most a small part, the smallest for which that was proved of a few from 0.1 to 1e-6, of
    the area that the lengths of the boundary's edges let expect there. So that corner is nearly folded, or its cell is
    small: a narrow neck makes cells small in good grids, too. It is meant for boundaries for which neither a valid grid
    is found nor a proof that there is none, and was found for all but few of these.

    Args:
        grid: as for `certificates`; the search is made near its folded cells.
        work: as for `certificates`, for each of these parts.
        check: as for `certificates`.

    Returns:
        A certificate of kind 'sliver'. None if no proof was found, for a valid grid, and where one of the quick
        `certificates` says more.

    Raises:
        GridgenError: as `certificates`.
    """
    _check_arguments(grid, work)
    sliver = None if boundary_proofs(grid) else find_sliver(grid, work, check)
    return _searched(grid, sliver) if sliver else None


def _check_arguments(grid: Grid, work: int) -> None:
    """Raise what `certificates` does."""
    check_grid(grid)
    if not isinstance(work, (int, np.integer)) or isinstance(work, bool) or work < 1:
        raise GridgenError(f"work must be a whole number of steps, at least 1; came {work!r}")


def _searched(grid: Grid, conflict: Conflict) -> Certificate:
    """Return the certificate of cells that cannot all be valid, or not all as large as they should be."""
    ni, nj = grid.shape
    nodes = tuple(node for cell in conflict.cells for node in nodes_of(cell))
    fixed = {(i, j) for i, j in nodes if i in (0, ni - 1) or j in (0, nj - 1)}
    point = point_of(np.mean([grid.planes[:, i, j] for i, j in sorted(fixed or set(nodes))], axis=0))
    cells, place = _cells_text(conflict.cells), point_text(point)
    help_text = "Take more cells there, or place the boundary's nodes otherwise"
    numbers: dict[str, float] = {"cells": len(conflict.cells)}
    if not conflict.share:
        message = (
            f"no valid grid exists: near {place} there is no room for the inner nodes: wherever they are, "
            f"not all of {cells} can be valid while every other cell is. {help_text}"
        )
        return Certificate("conflict", nodes, point, numbers, message)
    message = (
        f"every valid grid, if there is one, has a nearly folded or small cell: near {place} there is little room for "
        f"the inner nodes: wherever they are, not all corner Jacobians of {cells} can exceed {100 * conflict.share:g} "
        f"% of the area that the lengths of the boundary's edges let expect there. {help_text}"
    )
    return Certificate("sliver", nodes, point, numbers | {"share": conflict.share}, message)


def _cells_text(cells: tuple[Node, ...]) -> str:
    """Return the first of some cells, and how many there are, as text for a message."""
    named = ", ".join(map(str, cells[:_MOST_NAMED]))
    more = f" and {len(cells) - _MOST_NAMED} more" if len(cells) > _MOST_NAMED else ""
    return f"the {len(cells)} cells {named}{more}" if len(cells) > 1 else f"the cell {named}"
