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
#: Up to this many marks are grouped one by one: loading scipy.ndimage takes longer.
_FEW = 1000


def subdomains(marked: npt.NDArray[np.bool_], layers: int) -> Iterator[tuple[slice, slice]]:
    """Return the small rectangles of nodes around marked nodes, extended by some layers.

    Marks whose surroundings touch share a rectangle.

    Args:
        marked: (ni, nj), of the nodes.
        layers: of nodes.
    """
    few = np.count_nonzero(marked) <= _FEW
    for window in _windows_of_few(marked, layers) if few else _windows(marked, layers):
        if marked[window].size <= _LARGEST * marked.size:
            yield window


def _windows(marked: npt.NDArray[np.bool_], layers: int) -> list[tuple[slice, slice]]:
    """Return the rectangles, in the order in which rows of nodes meet what they surround."""
    from scipy.ndimage import find_objects, label, maximum_filter

    return list(find_objects(label(maximum_filter(marked, 2 * layers + 1, mode="constant"), np.ones((3, 3)))[0]))


def _windows_of_few(marked: npt.NDArray[np.bool_], layers: int) -> list[tuple[slice, slice]]:
    """Return the same, mark by mark: surroundings touch where marks are up to 2 `layers` + 1 rows and columns apart."""
    left, reach = marked.copy(), 2 * layers + 1
    found = []
    for begin in map(tuple, np.argwhere(marked)):
        group, at = [begin] if left[begin] else [], 0
        left[begin] = False
        while at < len(group):
            first = np.maximum(np.array(group[at]) - reach, 0)
            window = left[first[0] : group[at][0] + reach + 1, first[1] : group[at][1] + reach + 1]
            group += map(tuple, np.argwhere(window) + first)
            window[...] = False
            at += 1
        if group:
            low, high = np.maximum(np.array(group) - layers, 0), np.array(group) + layers + 1
            rows, columns = zip(low.min(axis=0), np.minimum(high.max(axis=0), marked.shape), strict=True)
            met = int(low[low[:, 0] == rows[0], 1].min())
            found.append((int(rows[0]), met, (slice(*map(int, rows)), slice(*map(int, columns)))))
    return [window for _, _, window in sorted(found, key=lambda one: one[:2])]


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
