"""Three questions about a closed polygon: its orientation, repeated points, and whether it meets itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .grid import FloatArray

_BLOCK = 1 << 22  # Pairs of edges compared at a time: bounds the memory of the quadratic test.


def is_clockwise(points: FloatArray) -> bool:
    """Say whether a closed polygon (N, 2) runs clockwise, its signed area being negative."""
    x, y = _scaled(points).T
    return bool(x @ np.roll(y, -1) < np.roll(x, -1) @ y)


def first_repeated(points: FloatArray) -> int | None:
    """Return the first k for which point k+1 (cyclically) equals point k, or None."""
    same = (points == np.roll(points, -1, axis=0)).all(axis=1)
    return int(same.argmax()) if same.any() else None


def first_crossing(points: FloatArray) -> tuple[int, int] | None:
    """Return the first two edges of a closed polygon that meet otherwise than neighbors do, or None.

    Edge k joins point k to point k+1. Edges that touch count as meeting, as do neighbors that run back on
    each other. Quadratic, in blocks of vectorised comparisons of the edges' boxes; only pairs with common
    boxes are looked at.

    Args:
        points: shape (N, 2), finite.
    """
    start = _scaled(points)
    end = np.roll(start, -1, axis=0)
    low, high = np.minimum(start, end), np.maximum(start, end)
    count = len(points)
    rows = max(1, _BLOCK // count)
    for first in range(0, count, rows):
        part = slice(first, first + rows)
        boxes = (low[part, None] <= high[None]).all(axis=2) & (low[None] <= high[part, None]).all(axis=2)
        a, b = np.nonzero(boxes)
        a += first
        a, b = a[a < b], b[a < b]
        meet = _meet(start, end, a, b)
        if meet.any():
            k = int(meet.argmax())
            return int(a[k]), int(b[k])
    return None


def _scaled(points: FloatArray) -> FloatArray:
    """Move and shrink the polygon into the unit box, so that products neither overflow nor vanish."""
    half = points / 2  # The difference of two huge coordinates would overflow.
    moved = half - half.min(axis=0)
    extent = float(moved.max())
    return np.asarray(moved / extent) if extent > 0 else moved


def _meet(start: FloatArray, end: FloatArray, a: NDArray[np.intp], b: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Say for each pair of edges a < b, whose boxes overlap, whether they meet wrongly."""
    count = len(start)
    straddle = (_side(start[a], end[a], start[b]) * _side(start[a], end[a], end[b]) <= 0) & (
        _side(start[b], end[b], start[a]) * _side(start[b], end[b], end[a]) <= 0
    )
    before, after = b - a == 1, (a == 0) & (b == count - 1)
    # Neighbors always share a point; they are wrong only when the second runs back along the first.
    first, second = np.where(after, b, a), np.where(after, a, b)
    one, two = end[first] - start[first], end[second] - start[second]
    back = (_side(start[first], end[first], end[second]) == 0) & ((one * two).sum(axis=1) < 0)
    return np.where(before | after, back, straddle)


def _side(p: FloatArray, q: FloatArray, r: FloatArray) -> FloatArray:
    """Return on which side of the line p q the point r lies: 1 left, -1 right, 0 on it."""
    u, v = q - p, r - p
    return np.sign(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
