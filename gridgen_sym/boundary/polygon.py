"""Closed polygons: orientation, repeated points, self-intersections, winding number and turning."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .predicates import area_sign, orientation

_PAIRS = 1 << 20  # Pairs of edges compared at a time: bounds the memory of the sweep.

Pairs = tuple[NDArray[np.intp], NDArray[np.intp]]


def is_clockwise(points: Array) -> bool:
    """Return whether a closed polygon (N, 2) runs clockwise, that is, has a negative signed area."""
    return area_sign(points) < 0


def first_repeated(points: Array, among: NDArray[np.bool_] | None = None) -> int | None:
    """Return the first k, of those that are `among`, for which point k+1 (cyclically) equals point k, or None."""
    same = (points == np.roll(points, -1, axis=0)).all(axis=1)
    if among is not None:
        same &= among
    return int(same.argmax()) if same.any() else None


def first_crossing(points: Array, check: Callable[[], object] | None = None) -> tuple[int, int] | None:
    """Return the first two edges of a closed polygon that meet otherwise than neighbors do, or None; exact.

    Edge k joins point k to point k+1. Edges that touch count as meeting, as do neighbors that run back on
    each other.

    Args:
        points: shape (N, 2), finite.
        check: called between blocks of very many pairs; what it raises ends the work.
    """
    found: list[tuple[int, int]] = []
    back = turns(points)[1]
    for a, b in _close_pairs(points, check):
        meet = _meet(points, back, a, b)
        found.extend(zip(a[meet].tolist(), b[meet].tolist(), strict=True))
    return min(found, default=None)


def proper_crossings(points: Array, check: Callable[[], object] | None = None) -> list[tuple[int, int]]:
    """Return all pairs of edges a < b of a closed polygon that cross between their ends, sorted; exact.

    Arguments as for `first_crossing`.
    """
    found: list[tuple[int, int]] = []
    for a, b in _close_pairs(points, check):
        crosses = (np.multiply(*_sides(points, a, b)) < 0) & (np.multiply(*_sides(points, b, a)) < 0)
        found.extend(zip(a[crosses].tolist(), b[crosses].tolist(), strict=True))
    return sorted(found)


def winding_number(points: Array, at: Array) -> int | None:
    """Return how often a closed polygon (N, 2) winds around a point, counter-clockwise; None on the polygon. Exact."""
    end = np.roll(points, -1, axis=0)
    low, high = np.minimum(points, end), np.maximum(points, end)
    spans = np.flatnonzero((low[:, 1] <= at[1]) & (at[1] <= high[:, 1]))
    side = orientation(points[spans], end[spans], at)
    if ((side == 0) & (low[spans, 0] <= at[0]) & (at[0] <= high[spans, 0])).any():
        return None
    # An edge counts with its lower end and without its upper one, so that none counts twice where two meet.
    start_below, end_below = points[spans, 1] <= at[1], end[spans, 1] <= at[1]
    up, down = start_below & ~end_below, ~start_below & end_below
    return int((up & (side > 0)).sum()) - int((down & (side < 0)).sum())


def turns(points: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the turn at each point of a closed polygon, and where it runs back on itself.

    The turn is in radians, in (-pi, pi), positive to the left; its sign is exact near the ends of that interval,
    so that the sum is 2 pi times a whole number that can be read off. Where the polygon runs back the turn is pi.
    """
    edge = _directions(points, np.roll(points, -1, axis=0))
    before = np.roll(edge, 1, axis=0)
    cross = before[:, 0] * edge[:, 1] - before[:, 1] * edge[:, 0]
    dot = (before * edge).sum(axis=1)
    sign = np.where(cross < 0, -1, 1)
    behind = np.flatnonzero(dot < 0)
    exact = orientation(np.roll(points, 1, axis=0)[behind], points[behind], np.roll(points, -1, axis=0)[behind])
    sign[behind] = np.where(exact < 0, -1, 1)
    back = np.zeros(len(points), dtype=bool)
    back[behind] = exact == 0
    return sign * np.arctan2(np.abs(cross), dot), back


def _directions(start: Array, end: Array) -> Array:
    """Return the directions of edges (n, 2), scaled so that the larger component is 1 or -1; 0 without length."""
    with np.errstate(over="ignore"):
        edge = end - start
    # A difference may overflow, but it does not underflow: halve both ends where it overflows.
    edge = np.where(np.isfinite(edge).all(axis=1, keepdims=True), edge, end / 2 - start / 2)
    length = np.abs(edge).max(axis=1, keepdims=True)
    return np.asarray(np.divide(edge, length, out=np.zeros_like(edge), where=length > 0))


def inner_angles(before: Array, at: Array, after: Array) -> Array:
    """Return the angles in degrees, in [0, 360), at points of a counter-clockwise polygon, shapes (n, 2) -> (n,)."""
    to, back = _directions(at, after), _directions(at, before)
    cross = to[:, 0] * back[:, 1] - to[:, 1] * back[:, 0]
    return np.asarray(np.degrees(np.arctan2(cross, (to * back).sum(axis=1))) % 360.0)


def _close_pairs(points: Array, check: Callable[[], object] | None) -> Iterator[Pairs]:
    """Yield the pairs of edges a < b whose bounding boxes have a point in common, in blocks: a sweep along x."""
    start = points
    end = np.roll(points, -1, axis=0)
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    # The edges that begin no later than edge k ends, and come after it in the order.
    last = np.searchsorted(low[:, 0], high[:, 0], side="right")
    following = last - np.arange(len(order)) - 1
    for first, stop in _blocks(following):
        if check is not None and first:
            check()
        count = following[first:stop]
        a = np.repeat(np.arange(first, stop), count)
        b = a + 1 + np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count)
        near = (low[a, 1] <= high[b, 1]) & (low[b, 1] <= high[a, 1])
        one, other = order[a[near]], order[b[near]]
        yield np.minimum(one, other), np.maximum(one, other)


def _blocks(counts: NDArray[np.intp]) -> Iterator[tuple[int, int]]:
    """Yield ranges of rows that hold about `_PAIRS` pairs, and at least one row."""
    total = np.cumsum(counts)
    first = 0
    while first < len(counts):
        before = int(total[first - 1]) if first else 0
        stop = max(first + 1, int(np.searchsorted(total, before + _PAIRS, side="right")))
        yield first, stop
        first = stop


def _sides(points: Array, a: NDArray[np.intp], b: NDArray[np.intp]) -> tuple[NDArray[np.int8], NDArray[np.int8]]:
    """Return on which side of the line of edge a the two ends of edge b lie."""
    end = np.roll(points, -1, axis=0)
    return orientation(points[a], end[a], points[b]), orientation(points[a], end[a], end[b])


def _meet(points: Array, back: NDArray[np.bool_], a: NDArray[np.intp], b: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return for each pair of edges a < b, whose boxes overlap, whether they intersect."""
    before, after = b - a == 1, (a == 0) & (b == len(points) - 1)
    meet = np.zeros(len(a), dtype=bool)
    # Neighbors always share a point; they are wrong only when the second runs back along the first.
    neighbors = before | after
    meet[neighbors] = back[np.where(after, a, b)[neighbors]]
    apart = np.flatnonzero(~neighbors)
    a, b = a[apart], b[apart]
    meet[apart] = (np.multiply(*_sides(points, a, b)) <= 0) & (np.multiply(*_sides(points, b, a)) <= 0)
    return meet
