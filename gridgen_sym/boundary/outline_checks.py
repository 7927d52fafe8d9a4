"""What makes points and corners an outline: the checks, and the repair of a curve that runs clockwise."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, real_array
from ..errors import GridgenError
from .corners import Corners
from .polygon import first_repeated

#: Larger coordinates have differences and lengths that overflow.
_LARGEST = 1e300
#: So many numbers are listed in a message.
_MOST_LISTED = 12


def checked_points(points: ArrayLike, name: str) -> tuple[Array, int]:
    """Return a copy of the vertices, and how many copies of the first one at the end were left out.

    They are finite, enough of them, and none is repeated at once.
    """
    given = real_array(points, f"the points of the outline '{name}'")
    array = _opened(given).copy()
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 4:
        raise GridgenError(
            f"the outline '{name}' needs points of shape (N, 2) with N >= 4, but came with {array.shape}"
        )
    bad = ~(np.abs(array) <= _LARGEST).all(axis=1)
    if bad.any():
        k = int(bad.argmax())
        limit = "be finite" if not np.isfinite(array).all() else f"lie within {_LARGEST:g} of 0, or lengths overflow"
        raise GridgenError(f"every point of the outline '{name}' must {limit}, but point {k} is {array[k].tolist()}")
    repeated = first_repeated(array)
    if repeated is not None:
        raise GridgenError(
            f"the outline '{name}' repeats a point: {repeated} and {repeated + 1} are both "
            f"{array[repeated].tolist()}; remove point {repeated + 1}"
        )
    return array, len(given) - len(array)


def _opened(points: Array) -> Array:
    """Return a curve without copies of its first point at the end, by which many programs mark it as closed."""
    while points.ndim == 2 and len(points) > 1 and np.array_equal(points[-1], points[0]):
        points = points[:-1]
    return points


def checked_corners(corners: ArrayLike, count: int, name: str, copies: int = 0) -> Corners:
    """Return corners as four different indices of points, in the order of the points from any start.

    Args:
        corners: what was given: four indices, or a mark for each point (see `Outline`).
        count: how many points there are.
        name: of the outline, for messages.
        copies: how many copies of point 0 at the end were left out; indices and marks of these are those of point 0.
    """
    values = real_array(corners, f"the corners of the outline '{name}'")
    if values.shape == (count + copies,) and np.isin(values, (-1, 0, 1)).all():
        values = _marked_corners(values, count, name)
    same = np.where((values >= count) & (values < count + copies), 0, values)
    whole = same.shape == (4,) and np.isfinite(same).all() and (same % 1 == 0).all()
    if not whole or same.min() < 0 or same.max() >= count or not (np.diff((same - same[0]) % count) > 0).all():
        closed = (
            f"; point {count} is point 0 again, and no other corner"
            if values.shape == (4,) and (same != values).any()
            else ""
        )
        raise GridgenError(
            f"the corners of the outline '{name}' must be 'auto' or four different indices of its points from 0 to "
            f"{count - 1}, in the order of the points, but are {_listed(values)}{closed}"
        )
    c0, c1, c2, c3 = (int(value) for value in same)
    return c0, c1, c2, c3


def _listed(values: Array) -> str:
    """Return numbers as a list, whole ones without a point."""
    shown = [f"{value:.15g}" for value in values.ravel()[:_MOST_LISTED]]
    more = ["..."] if values.size > _MOST_LISTED else []
    return f"[{', '.join(shown + more)}]"


def _marked_corners(marks: Array, count: int, name: str) -> Array:
    """Return the indices of the corners that are marked as pygridgen's `beta` does.

    There every point has a number: 1 where the grid's boundary turns to the left, 0 where it does not turn. The marks
    of copies of point 0, which follow those of the `count` points, are marks of point 0.
    """
    first, copied = marks[0], marks[count:]
    merged = marks[:count].copy()
    merged[0] = max(first, copied.max(initial=first))
    if (marks == -1).any() or merged.sum() != 4:
        twice = "; the last point is the first one again, so that their marks are one corner"
        raise GridgenError(
            f"a grid of the outline '{name}' has four corners, marked by 1, at which it turns to the left, but the "
            f"marks hold {int((merged == 1).sum())} times 1 and {int((marks == -1).sum())} times -1"
            f"{twice if first == 1 and (copied == 1).any() else ''}"
        )
    return np.flatnonzero(merged).astype(float)


def run_backwards(points: Array, corners: Corners) -> tuple[Array, Corners]:
    """Run a curve backwards from its corner 1, so that bottom and top stay on their curves."""
    count, (_, c1, c2, c3) = len(points), corners
    order: NDArray[np.intp] = (c1 - np.arange(count)) % count
    return np.ascontiguousarray(points[order]), (0, c1, c1 + count - c3, c1 + count - c2)


def crossing_text(points: Array, crossing: tuple[int, int]) -> str:
    """Return which two edges meet, and where, for a message."""
    edges = [f"edge {k} from {points[k].tolist()} to {points[(k + 1) % len(points)].tolist()}" for k in crossing]
    return f"{edges[0]} meets {edges[1]}"
