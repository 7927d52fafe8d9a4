"""The four corners of an outline: chosen automatically, or moved where no valid grid could exist."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .sampling import arc_lengths, turns_at

Corners = tuple[int, int, int, int]

#: Inner angles in degrees: a corner of at least the first counts as straight; it moves to one of at most the second.
STRAIGHT, _CONVEX = 170.0, 150.0
#: Candidates of the automatic choice: so many sharp vertices, and so many at equal arc lengths.
_SHARPEST, _EVEN = 24, 12


@dataclass(frozen=True, slots=True)
class CornerChoice:
    """Four corners of an outline, and their penalty.

    Attributes:
        corners: indices of the outline's points, counter-clockwise from corner 0.
        angles: the inner angles in degrees between the boundary nodes at the four corners.
        penalty: how far the choice is from a rectangle with the grid's numbers of cells, 0 for that: the sum over the
            corners of ((angle - 90) / 90)² (and 25 times the square of what exceeds 150 degrees, over 30), plus the
            squared logarithms of the ratios of opposite sides, and a quarter of that of the mean length of a cell along
            xi over that along eta. Here angles are those of the outline, seen over the mean length of a cell; the first
            term takes the mean of that and of the angle seen over a 24th of the outline.
        moved: the corners, 0 to 3, that are not where the outline has them.
        message: which were moved, and why; empty if none was.
    """

    corners: Corners
    angles: tuple[float, float, float, float]
    penalty: float
    moved: tuple[int, ...]
    message: str


def corner_penalty(points: Array, corners: NDArray[np.intp], ni: int, nj: int) -> Array:
    """Return the penalty of choices of corners, shape (n, 4), for a grid of ni x nj nodes; see `CornerChoice`."""
    length, total = _closed_lengths(points)
    angle = _vertex_angles(points, length, total, total / (2 * (ni + nj) - 4))
    wide = _vertex_angles(points, length, total, total / 24)
    cost = (((angle + wide) / 2 - 90) / 90) ** 2 + 25 * (np.maximum(angle - 150, 0) / 30) ** 2
    at = length[corners]
    b, r, t, le = ((np.roll(at, -1, axis=1) - at) % total).T
    with np.errstate(divide="ignore", invalid="ignore"):  # A side may be so short that rounding leaves nothing of it.
        balance = np.log(b / t) ** 2 + np.log(le / r) ** 2
        balance += np.log((b + t) * (nj - 1) / ((le + r) * (ni - 1))) ** 2 / 4
    return np.asarray(cost[corners].sum(axis=1) + np.where(np.isnan(balance), np.inf, balance))


def automatic_corners(points: Array, ni: int, nj: int) -> Corners:
    """Return the corners of least penalty; see `ranked_corners`."""
    return as_corners(ranked_corners(points, ni, nj)[0])


def ranked_corners(points: Array, ni: int, nj: int) -> NDArray[np.intp]:
    """Return choices (n, 4) among the sharpest vertices and some at equal arc lengths, the least penalty first.

    Of equal ways to number them the one is taken whose corner 0 is nearest to point 0.
    """
    length, total = _closed_lengths(points)
    angle = _vertex_angles(points, length, total, total / (2 * (ni + nj) - 4))
    even = np.searchsorted(length, np.arange(_EVEN) * total / _EVEN) % len(points)
    candidates = np.unique(np.concatenate((np.argsort(angle, kind="stable")[:_SHARPEST], even)))
    chosen = np.array(list(combinations(candidates.tolist(), 4)))
    ways = np.concatenate([np.roll(chosen, -shift, axis=1) for shift in range(4)])
    first = length[ways[:, 0]]
    # Ties, such as that of a numbering with the opposite one, go to the nearest start: rounding must not decide.
    penalty = corner_penalty(points, ways, ni, nj).round(9)
    return ways[np.lexsort((np.minimum(first, total - first), penalty))]


def settled_corners(
    points: Array, corners: Corners, nodes: tuple[int, int], angles_of: Callable[[Corners], Array]
) -> tuple[Corners, tuple[int, ...]]:
    """Move each corner that is straight or reflex between its boundary nodes to the nearest convex turn.

    A corner moves by at most half of the side that it shortens. Without a convex turn so near it stays.

    Args:
        points: the vertices of the outline.
        corners: indices of these, counter-clockwise.
        nodes: the numbers of nodes (ni, nj).
        angles_of: gives the inner angles in degrees between the boundary nodes at the corners of any choice.

    Returns:
        The corners, and which were moved.
    """
    length, total = _closed_lengths(points)
    angle = _vertex_angles(points, length, total, total / (2 * sum(nodes) - 4))
    present, moved = corners, []
    for k in range(4):
        if angles_of(present)[k] < STRAIGHT:
            continue
        for vertex in _nearest_convex(length, total, angle, present, k):
            trial = as_corners(np.array([*present[:k], vertex, *present[k + 1 :]]))
            angles = angles_of(trial)
            others = np.delete(angles, k) >= STRAIGHT
            if angles[k] <= _CONVEX and not (others & (np.delete(angles_of(present), k) < STRAIGHT)).any():
                present = trial
                moved.append(k)
                break
    return present, tuple(moved)


def _nearest_convex(length: Array, total: float, angle: Array, corners: Corners, k: int) -> list[int]:
    """Return the vertices that turn to the left around corner k, the nearest first."""
    here, before, after = (length[corners[m % 4]] for m in (k, k - 1, k + 1))
    forward, backward = (length - here) % total, (here - length) % total
    near = (forward <= (after - here) % total / 2) | (backward <= (here - before) % total / 2)
    distance = np.minimum(forward, backward)
    fit = np.flatnonzero(near & (distance > 0) & (angle <= _CONVEX))
    return [int(vertex) for vertex in fit[np.argsort(distance[fit], kind="stable")]]


def _closed_lengths(points: Array) -> tuple[Array, float]:
    """Return the arc length of each vertex of a closed polygon, and that of the whole."""
    length = arc_lengths(np.concatenate((points, points[:1])))
    return length[:-1], float(length[-1])


def _vertex_angles(points: Array, length: Array, total: float, reach: float) -> Array:
    """Return the inner angles in degrees at the vertices of a closed polygon, seen over one `reach` on either side."""
    return 180.0 - np.degrees(turns_at(points, length, length, reach, period=total))


def as_corners(values: NDArray[np.intp]) -> Corners:
    """Return four indices as a tuple."""
    c0, c1, c2, c3 = values.tolist()
    return c0, c1, c2, c3
