"""Subdomains of a grid around its folds, each a grid of its own with fixed sides."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from ..arrays import Array, Mask
from ..grids import corner_jacobians, folded_corners
from .folds import Folds
from .problem import Problem

#: A rectangle with more than this fraction of all nodes is no small subdomain.
_LARGEST = 0.25


def subdomains(marked: npt.NDArray[np.bool_], layers: int) -> Iterator[tuple[slice, slice]]:
    """Return the small rectangles of nodes around marked nodes, extended by some layers.

    Marks whose surroundings touch share a rectangle.

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
    folded = folded_corners(corner_jacobians(coordinates[0], coordinates[1]))
    cells = (folded & ~Folds.held_corners(fixed)).any(axis=0)
    nodes = np.zeros(fixed.shape, dtype=bool)
    for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
        nodes[i : i + cells.shape[0], j : j + cells.shape[1]] |= cells
    return nodes


def restrict(problem: Problem, coordinates: Array, window: tuple[slice, slice]) -> tuple[Problem, Array]:
    """Return the problem on a rectangle of nodes, without a weight, with fixed sides, and a copy of its nodes.

    Nodes that slide do so there, too. The steps of the logical coordinates are those of the whole.
    """
    fixed = problem.fixed[window].copy()
    fixed[[0, -1]], fixed[:, [0, -1]] = 1, 1
    part = Problem(problem.kernels, fixed, None, steps=problem.steps)
    if problem.slide is not None:
        problem.follow(coordinates)
        part.slide = problem.slide.part(window)
    return part, np.ascontiguousarray(coordinates[:, *window])
