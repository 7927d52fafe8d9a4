"""What makes points and corners an outline: the checks, and the repair of a curve that runs clockwise."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import GridgenError
from .corners import Corners
from .grid import FloatArray, real_array
from .polygon import first_repeated


def checked_points(points: ArrayLike, name: str) -> FloatArray:
    """Return a copy of the vertices: finite, enough of them, none repeated at once."""
    array = real_array(points, f"the points of the outline '{name}'").copy()
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 4:
        raise GridgenError(
            f"the outline '{name}' needs points of shape (N, 2) with N >= 4, but came with {array.shape}"
        )
    bad = ~np.isfinite(array).all(axis=1)
    if bad.any():
        k = int(bad.argmax())
        raise GridgenError(f"every point of the outline '{name}' must be finite, but point {k} is {array[k].tolist()}")
    repeated = first_repeated(array)
    if repeated is not None:
        closing = " (a closed curve does not repeat its first point)" if repeated == len(array) - 1 else ""
        following = (repeated + 1) % len(array)
        raise GridgenError(
            f"the outline '{name}' repeats a point: {repeated} and {following} are both "
            f"{array[repeated].tolist()}; "
            f"remove point {max(repeated, following)}{closing}"
        )
    return array


def checked_corners(corners: ArrayLike, count: int, name: str) -> Corners:
    """Return the corners as four whole numbers: 0 < c1 < c2 < c3 < count."""
    values = real_array(corners, f"the corners of the outline '{name}'")
    listed = values.tolist()
    whole = values.shape == (4,) and np.isfinite(values).all() and (values % 1 == 0).all()
    if not whole or values[0] != 0 or not (np.diff(values) > 0).all() or not values[-1] < count:
        raise GridgenError(
            f"the corners of the outline '{name}' must be four increasing indices from 0 to {count - 1}, "
            f"the first 0, but are {listed}: roll the points so that the first corner comes first"
        )
    c0, c1, c2, c3 = (int(value) for value in values)
    return c0, c1, c2, c3


def checked_choice(corners: ArrayLike, count: int, name: str) -> Corners:
    """Return a choice of corners: four different indices of points, counter-clockwise from any start."""
    values = real_array(corners, f"the corners for a grid of the outline '{name}'")
    whole = values.shape == (4,) and np.isfinite(values).all() and (values % 1 == 0).all()
    if not whole or values.min() < 0 or values.max() >= count or not (np.diff((values - values[0]) % count) > 0).all():
        raise GridgenError(
            f"the corners for a grid of the outline '{name}' must be 'auto' or four different indices of its points "
            f"from 0 to {count - 1}, counter-clockwise, but are {values.tolist()}"
        )
    c0, c1, c2, c3 = (int(value) for value in values)
    return c0, c1, c2, c3


def corners_of_turns(corners: ArrayLike, points: FloatArray, name: str) -> ArrayLike | None:
    """Return the indices of the corners where they are marked as pygridgen's `beta` does, or None if they are not.

    There every point has a number: 1 where the grid's boundary turns to the left, 0 where it does not turn.
    """
    values = real_array(corners, f"the corners of the outline '{name}'")
    if values.shape != (len(points),) or not np.isin(values, (-1, 0, 1)).all():
        return None
    if (values == -1).any() or values.sum() != 4:
        raise GridgenError(
            f"a grid of the outline '{name}' has four corners, marked by 1, at which it turns to the left, but the "
            f"marks hold {int((values == 1).sum())} times 1 and {int((values == -1).sum())} times -1"
        )
    return np.flatnonzero(values)


def run_backwards(points: FloatArray, corners: Corners) -> tuple[FloatArray, Corners]:
    """Run a curve backwards from its corner 1, so that bottom and top stay on their curves."""
    count, (_, c1, c2, c3) = len(points), corners
    order: NDArray[np.intp] = (c1 - np.arange(count)) % count
    return np.ascontiguousarray(points[order]), (0, c1, c1 + count - c3, c1 + count - c2)


def crossing_text(points: FloatArray, crossing: tuple[int, int]) -> str:
    """Say which two edges meet, and where."""
    edges = [f"edge {k} from {points[k].tolist()} to {points[(k + 1) % len(points)].tolist()}" for k in crossing]
    return f"{edges[0]} meets {edges[1]}"
