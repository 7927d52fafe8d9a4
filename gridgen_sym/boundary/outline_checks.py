"""What makes points and corners an outline: the checks, and the repair of a curve that runs clockwise."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, real_array
from ..errors import GridgenError
from .corners import Corners
from .polygon import first_repeated


def checked_points(points: ArrayLike, name: str) -> Array:
    """Return a copy of the vertices: finite, enough of them, none repeated at once, the first not again at the end."""
    array = _opened(real_array(points, f"the points of the outline '{name}'")).copy()
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
        raise GridgenError(
            f"the outline '{name}' repeats a point: {repeated} and {repeated + 1} are both "
            f"{array[repeated].tolist()}; remove point {repeated + 1}"
        )
    return array


def _opened(points: Array) -> Array:
    """Return a curve without copies of its first point at the end, by which many programs say that it is closed."""
    while points.ndim == 2 and len(points) > 1 and np.array_equal(points[-1], points[0]):
        points = points[:-1]
    return points


def checked_corners(corners: ArrayLike, count: int, name: str) -> Corners:
    """Return corners as four different indices of points, in the order of the points from any start."""
    values = real_array(corners, f"the corners of the outline '{name}'")
    whole = values.shape == (4,) and np.isfinite(values).all() and (values % 1 == 0).all()
    if not whole or values.min() < 0 or values.max() >= count or not (np.diff((values - values[0]) % count) > 0).all():
        raise GridgenError(
            f"the corners of the outline '{name}' must be 'auto' or four different indices of its points from 0 to "
            f"{count - 1}, in the order of the points, but are {_listed(values)}"
        )
    c0, c1, c2, c3 = (int(value) for value in values)
    return c0, c1, c2, c3


def _listed(values: Array) -> str:
    """Return numbers as a list, whole ones without a point."""
    return f"[{', '.join(f'{value:.15g}' for value in values.ravel())}]"


def corners_of_turns(corners: ArrayLike, points: Array, name: str) -> ArrayLike | None:
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


def run_backwards(points: Array, corners: Corners) -> tuple[Array, Corners]:
    """Run a curve backwards from its corner 1, so that bottom and top stay on their curves."""
    count, (_, c1, c2, c3) = len(points), corners
    order: NDArray[np.intp] = (c1 - np.arange(count)) % count
    return np.ascontiguousarray(points[order]), (0, c1, c1 + count - c3, c1 + count - c2)


def crossing_text(points: Array, crossing: tuple[int, int]) -> str:
    """Say which two edges meet, and where."""
    edges = [f"edge {k} from {points[k].tolist()} to {points[(k + 1) % len(points)].tolist()}" for k in crossing]
    return f"{edges[0]} meets {edges[1]}"
