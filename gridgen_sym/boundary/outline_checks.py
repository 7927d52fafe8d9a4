"""What makes points and corners an outline: the checks, and the repair of a curve that runs clockwise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, real_array
from ..errors import GridgenError
from .corner_marks import are_marks, corners_of_marks, refuse_fractions
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


def checked_corners(corners: ArrayLike, points: Array, name: str, copies: int = 0) -> Corners:
    """Return corners as four different indices of points, in the order of the points from any start.

    Args:
        corners: what was given: four indices, four places, or a mark for each point (see `Outline`).
        points: the vertices (N, 2).
        name: of the outline, for messages.
        copies: how many copies of point 0 at the end were left out; indices and marks of these are those of point 0.
    """
    values, count = real_array(corners, f"the corners of the outline '{name}'"), len(points)
    if are_places(values):
        return _nearest(values, points, name)
    if are_marks(values, count + copies):
        values = corners_of_marks(values, points, name)
    refuse_fractions(values, count + copies, name)
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


def are_places(corners: ArrayLike) -> bool:
    """Return whether corners are given as four places, (4, 2)."""
    return np.shape(corners) == (4, 2)


def _nearest(places: Array, points: Array, name: str) -> Corners:
    """Return the points that are nearest to four places, in the order of the points from that of the first place."""
    if not np.isfinite(places).all():
        raise GridgenError(f"the corners of the outline '{name}' must be finite places; came {places.tolist()}")
    found = np.array([int(np.hypot(*(points - place).T).argmin()) for place in places])
    ahead = np.sort((found - found[0]) % len(points))
    if (np.diff(ahead) == 0).any():
        raise GridgenError(
            f"the corners of the outline '{name}' are four different points, but those nearest to the four places are "
            f"{found.tolist()}: give places nearer to the corners"
        )
    c0, c1, c2, c3 = ((ahead + found[0]) % len(points)).tolist()
    return c0, c1, c2, c3


def checked_islands(islands: Sequence[ArrayLike], name: str) -> tuple[Array, ...]:
    """Return read-only copies of islands as closed curves (n, 2) without a copy of their first point at the end.

    Raises:
        GridgenError: for what is no curve, has fewer than three points, or is not finite.
    """
    made = []
    for k, island in enumerate(islands):
        curve = _opened(real_array(island, f"island {k} of the outline '{name}'")).copy()
        if curve.ndim != 2 or curve.shape[1] != 2 or len(curve) < 3 or not (np.abs(curve) <= _LARGEST).all():
            raise GridgenError(
                f"island {k} of the outline '{name}' needs finite points of shape (n, 2) with n >= 3, but came with "
                f"{curve.shape}"
            )
        curve.setflags(write=False)
        made.append(curve)
    return tuple(made)


def _listed(values: Array) -> str:
    """Return numbers as a list, whole ones without a point."""
    shown = [f"{value:.15g}" for value in values.ravel()[:_MOST_LISTED]]
    more = ["..."] if values.size > _MOST_LISTED else []
    return f"[{', '.join(shown + more)}]"


def run_backwards(points: Array, corners: Corners) -> tuple[Array, Corners]:
    """Run a curve backwards from its corner 1, so that bottom and top stay on their curves."""
    count, (_, c1, c2, c3) = len(points), corners
    order: NDArray[np.intp] = (c1 - np.arange(count)) % count
    return np.ascontiguousarray(points[order]), (0, c1, c1 + count - c3, c1 + count - c2)


def crossing_text(points: Array, crossing: tuple[int, int]) -> str:
    """Return which two edges meet, and where, for a message."""
    edges = [f"edge {k} from {points[k].tolist()} to {points[(k + 1) % len(points)].tolist()}" for k in crossing]
    return f"{edges[0]} meets {edges[1]}"
