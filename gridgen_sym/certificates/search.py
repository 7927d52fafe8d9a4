"""Where a proof is searched for: near the folded cells of a grid, with as few cells as it takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..grids.grid import Grid, corner_jacobians, folded_corners
from .branching import DEFAULT_BUDGET, Conflict, prove_conflict
from .node_constraints import Node

#: The fractions of the expected Jacobians for which a sliver is searched for, in turn.
JACOBIAN_FRACTIONS = (0.1, 0.03, 0.01, 0.003, 0.001, 3e-4, 1e-4, 1e-5, 1e-6)
#: To show that fewer cells conflict: largest cost as a multiple of the first proof's, and the cost of all attempts.
_MOST_TIMES, _ALTOGETHER = 2, 20_000
#: Cells at most so many cells away from a folded one are searched, at first and then.
_LAYERS = (3, 9)


def find_conflict(
    grid: Grid, budget: int = DEFAULT_BUDGET, check: Callable[[], object] | None = None
) -> Conflict | None:
    """Search near the folded cells of a grid for a proof that no valid grid has its boundary nodes.

    Args:
        grid: any grid; its folded cells show where to search, and the fewer there are, the better. The positions of
            its inner nodes do not matter otherwise.
        budget: how many constraints each of a few attempts may apply, which bounds the time.
        check: called often; what it raises ends the search.

    Returns:
        Cells that conflict, as few as are found. None if no proof was found.
    """
    found = _first_conflict(grid, budget, 0.0, check)
    return found and _fewest(grid, found, check)


def find_sliver(grid: Grid, budget: int = DEFAULT_BUDGET, check: Callable[[], object] | None = None) -> Conflict | None:
    """Search near the folded cells of a grid for a proof that every valid grid has a small corner Jacobian.

    Args:
        grid: as in `find_conflict`.
        budget: as in `find_conflict`, for each fraction.
        check: as in `find_conflict`.

    Returns:
        Cells that conflict at the smallest of `JACOBIAN_FRACTIONS` for which a proof was found. None if there is none.
    """
    best = None
    for fraction in JACOBIAN_FRACTIONS:
        # Cells that conflict at one fraction often do so at the next, and few of them cost little.
        found = best and prove_conflict(grid, best.cells, budget, jacobian_fraction=fraction, branch=True, check=check)
        found = found or _first_conflict(grid, budget, fraction, check)
        if found is None:
            break
        best = _fewest(grid, found, check)
    return best


def _first_conflict(grid: Grid, budget: int, fraction: float, check: Callable[[], object] | None) -> Conflict | None:
    """Return the first cells that are found to conflict: near folded cells, and without branching, first."""
    before: set[Node] = set()
    for layers in _LAYERS:
        cells = _near_folded_cells(grid, layers)
        for branch in (False, True):
            if cells and cells != before:
                found = prove_conflict(grid, cells, budget, jacobian_fraction=fraction, branch=branch, check=check)
                if found:
                    return found
        before = cells
    return None


def _near_folded_cells(grid: Grid, layers: int) -> set[Node]:
    """Return the cells that are at most so many cells away from a folded one."""
    with np.errstate(over="ignore", invalid="ignore"):
        near = folded_corners(corner_jacobians(grid.x, grid.y)).any(axis=0)
    for axis in (0, 1):
        padded = np.pad(near, [(layers, layers) if axis == other else (0, 0) for other in (0, 1)])
        near = np.lib.stride_tricks.sliding_window_view(padded, 2 * layers + 1, axis).any(axis=-1)
    return {(i, j) for i, j in np.argwhere(near).tolist()}


def _fewest(grid: Grid, conflict: Conflict, check: Callable[[], object] | None) -> Conflict:
    """Leave out cells of a conflict as long as the others still conflict and the proof costs little."""
    kept, each, left = conflict.cells, _MOST_TIMES * conflict.cost, _ALTOGETHER
    fraction = conflict.jacobian_fraction
    for cell in conflict.cells:
        if cell in kept and left > 0:
            others = [other for other in kept if other != cell]
            fewer = prove_conflict(
                grid, others, each, jacobian_fraction=fraction, branch=conflict.branched, check=check
            )
            left -= fewer.cost if fewer else each
            kept = fewer.cells if fewer else kept
    return replace(conflict, cells=kept)
