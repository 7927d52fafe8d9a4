"""The measures of a grid in groups, each computed by bands of rows that fit into a processor's cache."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .grid import Grid, corner_jacobians, folded_corners
from .orthogonality import Deviation, side_qualities

#: Nodes of a band: its planes and what is made of them stay in a second-level cache.
_BAND = 8192


class _Corner(NamedTuple):
    """One corner of every cell of a band.

    Attributes:
        J, g12: of its edge vectors g1 and g2.
        trace: g11 + g22.
        product: |g1| |g2|.
        turned: whether one of the two edges points into the corner.
    """

    J: Array
    g12: Array
    trace: Array
    product: Array
    turned: bool


def jacobian_measures(grid: Grid) -> dict[str, Any]:
    """Return what the corner Jacobians tell: their extremes and mean, and which cells are folded."""
    least, most, total, folded = np.inf, -np.inf, 0.0, []
    for first, planes in _bands(grid):
        jacobians = corner_jacobians(*planes)
        least, most = _smaller(least, jacobians), _larger(most, jacobians)
        total += float(jacobians.sum())
        if not least > 0:
            folded.append(np.argwhere(folded_corners(jacobians).any(axis=0)) + np.array((first, 0)))
    cells = (grid.shape[0] - 1) * (grid.shape[1] - 1)
    found = np.concatenate(folded) if folded else np.empty((0, 2), dtype=np.intp)
    return {
        "cells": cells,
        "folded_cells": len(found),
        "min_jacobian": least,
        "mean_jacobian": total / (4 * cells),
        "max_jacobian": most,
        "folded": found,
        "folded_centers": _centers(grid, found),
    }


def condition_measures(grid: Grid) -> dict[str, Any]:
    """Return the scaled Jacobians and condition numbers of corners."""
    scaled, largest, total, count = np.inf, -np.inf, 0.0, 0
    for corner in _corners(grid):
        scaled = _smaller(scaled, np.where(corner.product > 0, corner.J / corner.product, 0.0))
        condition = np.where(corner.J > 0, corner.trace / corner.J, np.inf)
        highest = float(condition.max())
        finite = condition if highest < np.inf else condition[np.isfinite(condition)]
        largest, total, count = _larger(largest, condition), total + float(finite.sum()), count + finite.size
    return {
        "min_scaled_jacobian": scaled,
        "mean_condition": total / count if count else np.inf,
        "max_condition": largest,
    }


def angle_measures(grid: Grid) -> dict[str, Any]:
    """Return the inner angles of cells, and how far they are from 90 degrees."""
    least, most, off = np.inf, -np.inf, []
    for corner in _corners(grid):
        # At the corners 1 and 3 one of the two edges points into the corner: the inner angle is the supplement.
        angle = np.arctan2(corner.J, -corner.g12 if corner.turned else corner.g12)
        angle += np.where(angle < 0, 2 * np.pi, 0.0)
        angle = np.where(corner.product > 0, angle, 0.0)
        least, most = _smaller(least, angle), _larger(most, angle)
        off.append(np.abs(np.where(angle > np.pi, 270.0, 90.0) - np.degrees(angle)).ravel())
    return {
        "min_angle": float(np.degrees(least)),
        "max_angle": float(np.degrees(most)),
        "non_orthogonality": Deviation.of(np.concatenate(off)),
    }


def ratio_measures(grid: Grid) -> dict[str, Any]:
    """Return the largest ratios of lengths within a cell, and of the areas of neighbors."""
    aspect, ratio, positive, before = 1.0, 1.0, True, np.empty((0, grid.shape[1] - 1))
    for _, planes in _bands(grid):
        along_xi, along_eta = np.hypot(*np.diff(planes, axis=1)), np.hypot(*np.diff(planes, axis=2))
        width, height = along_xi[:, :-1] + along_xi[:, 1:], along_eta[:-1] + along_eta[1:]
        aspect = _larger(aspect, _ratios(width, height))
        area = corner_jacobians(*planes).mean(axis=0)
        positive = positive and bool((area > 0).all())
        if positive:
            rows = np.concatenate((before, area))
            for pair in ((rows[1:], rows[:-1]), (area[:, 1:], area[:, :-1])):
                ratio = _larger(ratio, _ratios(*pair))
            before = area[-1:]
    return {"max_aspect_ratio": aspect, "max_area_ratio": ratio if positive else np.inf}


def side_measures(grid: Grid) -> dict[str, Any]:
    """Return how cells begin at the sides."""
    return {"sides": side_qualities(grid)}


_NAMES: Mapping[Callable[[Grid], dict[str, Any]], str] = {
    jacobian_measures: "cells folded_cells min_jacobian mean_jacobian max_jacobian folded folded_centers",
    condition_measures: "min_scaled_jacobian mean_condition max_condition",
    angle_measures: "min_angle max_angle non_orthogonality",
    ratio_measures: "max_aspect_ratio max_area_ratio",
    side_measures: "sides",
}
#: What computes each measure, with others of its group.
GROUPS = {name: group for group, names in _NAMES.items() for name in names.split()}


def _bands(grid: Grid) -> Iterator[tuple[int, Array]]:
    """Yield the first row of cells and the planes of bands of rows; neighbors share a row of nodes."""
    ni, nj = grid.shape
    rows = max(1, _BAND // nj)
    for first in range(0, ni - 1, rows):
        yield first, grid.planes[:, first : first + rows + 1]


def _corners(grid: Grid) -> Iterator[_Corner]:
    """Yield the four corners of the cells of each band."""
    low, high = slice(None, -1), slice(1, None)
    for _, planes in _bands(grid):
        xi, eta = np.diff(planes, axis=1), np.diff(planes, axis=2)
        g11, g22 = (xi**2).sum(axis=0), (eta**2).sum(axis=0)
        along_xi, along_eta = np.sqrt(g11), np.sqrt(g22)
        for xi_edge, eta_edge, turned in ((low, low, False), (low, high, True), (high, high, False), (high, low, True)):
            (x_xi, y_xi), (x_eta, y_eta) = xi[:, :, xi_edge], eta[:, eta_edge]
            J, g12 = x_xi * y_eta - x_eta * y_xi, x_xi * x_eta + y_xi * y_eta
            trace, product = g11[:, xi_edge] + g22[eta_edge], along_xi[:, xi_edge] * along_eta[eta_edge]
            yield _Corner(J, g12, trace, product, turned)


def _ratios(a: Array, b: Array) -> Array:
    """Return the larger of a/b and b/a; inf where one of them is 0."""
    small, large = np.minimum(a, b), np.maximum(a, b)
    return np.where(small > 0, large / small, np.inf)


def _smaller(least: float, values: Array) -> float:
    """Return the least of a number and an array; NaN where one is."""
    return float(np.minimum(least, values.min()))


def _larger(most: float, values: Array) -> float:
    """Return the greatest of a number and an array, which may be empty; NaN where one is."""
    return float(np.maximum(most, values.max(initial=-np.inf)))


def _centers(grid: Grid, cells: NDArray[np.intp]) -> Array:
    """Return the means of the four nodes of the given cells, shape (n, 2)."""
    i, j = cells.T
    nodes = grid.planes[:, [i, i + 1, i + 1, i], [j, j, j + 1, j + 1]]
    return np.asarray(nodes.mean(axis=1).T)
