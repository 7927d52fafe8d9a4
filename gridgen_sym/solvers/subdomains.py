"""Small parts of a grid round its folds, to be worked on as grids of their own."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from ..arrays import Array, Mask
from ..grids import corner_jacobians
from .folds import Folds
from .problem import Problem

#: A window with more than this part of all nodes is no small one.
_LARGEST = 0.25


def windows(marked: npt.NDArray[np.bool_], layers: int) -> Iterator[tuple[slice, slice]]:
    """Return the rectangles of nodes round what is marked, with so many layers more, as far as they are small.

    Marks whose surroundings touch are in one window.

    Args:
        marked: (ni, nj), of the nodes.
        layers: of nodes.
    """
    from scipy.ndimage import find_objects, label, maximum_filter

    groups, _ = label(maximum_filter(marked, 2 * layers + 1, mode="constant"), np.ones((3, 3)))
    for window in find_objects(groups):
        if groups[window].size <= _LARGEST * groups.size:
            yield window


def folded_nodes(coordinates: Array, fixed: Mask) -> npt.NDArray[np.bool_]:
    """Return the nodes (ni, nj) of folded cells, without corners that only fixed nodes form.

    Args:
        coordinates: (2, ni, nj).
        fixed: (ni, nj), non-zero at nodes that do not move; corners with no other nodes do not count.
    """
    folded = ~(corner_jacobians(coordinates[0], coordinates[1]) > 0)
    cells = (folded & ~Folds.held_corners(fixed)).any(axis=0)
    nodes = np.zeros(fixed.shape, dtype=bool)
    for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
        nodes[i : i + cells.shape[0], j : j + cells.shape[1]] |= cells
    return nodes


def cut_out(problem: Problem, coordinates: Array, window: tuple[slice, slice]) -> tuple[Problem, Array]:
    """Return a window as a problem of its own, without a weight, and a copy of its coordinates; its sides are fixed."""
    fixed = problem.fixed[window].copy()
    fixed[[0, -1]], fixed[:, [0, -1]] = 1, 1
    return Problem(problem.kernels, fixed, None), np.ascontiguousarray(coordinates[:, *window])
