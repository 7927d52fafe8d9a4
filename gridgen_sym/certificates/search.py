"""Where the search for a proof is made: near the folded cells of a grid, with as few cells as it takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..grids.grid import Grid, corner_jacobians
from .conflict import LITTLE_WORK, Conflict, contracted_places
from .neck import Node

#: Corner Jacobians that all exceed such a part of what the boundary's spacing lets expect are looked for.
SHARES = (0.1, 0.03, 0.01, 0.003, 0.001, 3e-4, 1e-4, 1e-5, 1e-6)
#: To show that still fewer cells conflict: so many times the work of the proof that is known, and so much in all.
_PATIENCE, _ALTOGETHER = 2, 20_000
#: Cells up to so many cells from a folded one are looked at, at first and then.
_LAYERS = (3, 9)


def find_conflict(grid: Grid, work: int = LITTLE_WORK, check: Callable[[], object] | None = None) -> Conflict | None:
    """Search near the folded cells of a grid for a proof that no valid grid has its boundary nodes.

    Args:
        grid: any grid; its folds are hints where to search, and the less folded it is, the better. Where its inner
            nodes are does not matter otherwise.
        work: how many rules may be used in each of a few attempts, which bounds the time.
        check: called again and again; what it raises ends the search.

    Returns:
        Cells that conflict, as few as are found. None if no proof was found.
    """
    found = _first_conflict(grid, work, 0.0, check)
    return found and _fewest(grid, found, check)


def find_sliver(grid: Grid, work: int = LITTLE_WORK, check: Callable[[], object] | None = None) -> Conflict | None:
    """Search near the folded cells of a grid for a proof that every grid has a sliver: a small corner Jacobian.

    Args:
        grid: as in `find_conflict`.
        work: as in `find_conflict`, for each share.
        check: as in `find_conflict`.

    Returns:
        Cells that conflict at the smallest share, of a few, for which a proof was found. None if none was.
    """
    best = None
    for share in SHARES:
        # Cells that conflict at one share often do so at the next, and few of them take little work.
        found = best and contracted_places(grid, best.cells, work, share=share, check=check)
        if not isinstance(found, Conflict):
            found = _first_conflict(grid, work, share, check)
        if found is None:
            break
        best = _fewest(grid, found, check)
    return best


def _first_conflict(grid: Grid, work: int, share: float, check: Callable[[], object] | None) -> Conflict | None:
    """Return the first cells that are found to conflict: near folds, and without cases, first."""
    before: set[Node] = set()
    for layers in _LAYERS:
        cells = _near_folds(grid, layers)
        for cases in (False, True):
            if cells and cells != before:
                found = contracted_places(grid, cells, work, share=share, cases=cases, check=check)
                if isinstance(found, Conflict):
                    return found
        before = cells
    return None


def _near_folds(grid: Grid, layers: int) -> set[Node]:
    """Return the cells up to some cells from a folded one."""
    with np.errstate(over="ignore", invalid="ignore"):
        folded = np.argwhere(~(corner_jacobians(grid.x, grid.y) > 0).all(axis=0))
    near = np.zeros((grid.shape[0] - 1, grid.shape[1] - 1), dtype=bool)
    for i, j in folded:
        near[max(i - layers, 0) : i + layers + 1, max(j - layers, 0) : j + layers + 1] = True
    return {(int(i), int(j)) for i, j in np.argwhere(near)}


def _fewest(grid: Grid, conflict: Conflict, check: Callable[[], object] | None) -> Conflict:
    """Leave out cells of a conflict as long as the others still conflict, and that is shown with as little work."""
    kept, each, left = conflict.cells, _PATIENCE * conflict.work, _ALTOGETHER
    for cell in conflict.cells:
        if cell in kept and left > 0:
            others = [other for other in kept if other != cell]
            fewer = contracted_places(grid, others, each, share=conflict.share, cases=conflict.cases, check=check)
            left -= fewer.work if isinstance(fewer, Conflict) else each
            kept = fewer.cells if isinstance(fewer, Conflict) else kept
    return replace(conflict, cells=kept)
