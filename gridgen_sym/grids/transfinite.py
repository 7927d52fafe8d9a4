"""Transfinite interpolation: the grid that follows from four boundary curves alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, real_array
from ..errors import GridgenError
from .grid import SMALLEST, Grid

CORNER_TOLERANCE = 1e-9  # Relative to the extent of the boundary: looser than rounding, far below a cell.
_ROWS = 32  # Rows of nodes that are computed at once.


def transfinite(bottom: ArrayLike, top: ArrayLike, left: ArrayLike, right: ArrayLike) -> Grid:
    """Fill four boundary curves with a grid by linear (Coons) transfinite interpolation.

    With the parameters s = i/(ni-1) and t = j/(nj-1), uniform in the index,
    ``r = (1-t) bottom(s) + t top(s) + (1-s) left(t) + s right(t)`` minus the bilinear map of the four
    corners. The boundary nodes are kept as they came; where corners agree only within the tolerance, bottom
    and top win.

    Args:
        bottom: shape (ni, 2), from left to right.
        top: shape (ni, 2), from left to right.
        left: shape (nj, 2), upwards.
        right: shape (nj, 2), upwards.

    Returns:
        The grid of ni x nj nodes, which may hold folded cells.

    Raises:
        GridgenError: for a side that is no (n, 2) array of at least 3 finite points, opposite sides of
            different length, or two sides that do not meet at their corner (named, with both points and their
            distance).

    Source: W. J. Gordon and C. A. Hall, Int. J. Numer. Methods Eng. 7 (1973) 461-477.
    """
    sides = {
        name: _side(name, points)
        for name, points in (("bottom", bottom), ("top", top), ("left", left), ("right", right))
    }
    b, t, le, r = sides.values()
    for (first, one), (second, other) in ((("bottom", b), ("top", t)), (("left", le), ("right", r))):
        if len(one) != len(other):
            raise GridgenError(
                f"opposite sides need the same number of points, but {first} has {len(one)} and {second} has "
                f"{len(other)}: sample both alike"
            )
    _check_corners(b, t, le, r)
    return Grid.from_planes(*_coons(b, t, le, r))


def _side(name: str, points: ArrayLike) -> Array:
    """Return one side as a checked array of shape (n, 2)."""
    side = real_array(points, f"the side '{name}'")
    if side.ndim != 2 or side.shape[1] != 2 or len(side) < SMALLEST:
        raise GridgenError(
            f"the side '{name}' must have the shape (n, 2) with n >= {SMALLEST}, but came with {side.shape}"
        )
    bad = ~np.isfinite(side).all(axis=1)
    if bad.any():
        k = int(bad.argmax())
        raise GridgenError(f"every point of the side '{name}' must be finite, but point {k} is {_text(side[k])}")
    return side


def _check_corners(b: Array, t: Array, le: Array, r: Array) -> None:
    """Raise an error for the first corner at which two sides do not meet."""
    points = np.concatenate((b, t, le, r))
    with np.errstate(over="ignore", invalid="ignore"):
        allowed = CORNER_TOLERANCE * float(np.ptp(points, axis=0).max())
        for corner, one, other, p, q in (
            ("bottom left", "bottom[0]", "left[0]", b[0], le[0]),
            ("bottom right", "bottom[-1]", "right[0]", b[-1], r[0]),
            ("top left", "top[0]", "left[-1]", t[0], le[-1]),
            ("top right", "top[-1]", "right[-1]", t[-1], r[-1]),
        ):
            distance = float(np.hypot(*(p - q)))
            if not distance <= allowed:
                raise GridgenError(
                    f"the sides must meet at the {corner} corner, but {one} is {_text(p)} and {other} is "
                    f"{_text(q)}, {distance:.3g} apart ({allowed:.3g} is allowed): bottom and top must run "
                    "from left to right, left and right upwards; reverse a side with side[::-1]"
                )


def _coons(b: Array, t: Array, le: Array, r: Array) -> Array:
    """Return the interpolated nodes, planes (2, ni, nj), with the given boundary put back bit by bit."""
    s, u = np.linspace(0.0, 1.0, len(b))[:, None], np.linspace(0.0, 1.0, len(le))
    planes = np.empty((2, len(b), len(le)))
    # Plane by plane, along pairs (x, y) the same sums would take ten times as long; and few rows at once, which stay
    # in the processor's cache.
    for c, plane in enumerate(planes):
        with np.errstate(over="ignore", invalid="ignore"):  # Grid() reports what overflows.
            # Bottom and top without what left and right give at their corners.
            low, high = (side[:, None, c] - (1 - s) * side[0, c] - s * side[-1, c] for side in (b, t))
            for begin in range(0, len(b), _ROWS):
                k = slice(begin, begin + _ROWS)
                np.multiply(u, high[k] - low[k], out=plane[k])
                plane[k] += low[k]
                plane[k] += s[k] * (r[:, c] - le[:, c])
                plane[k] += le[:, c]
        plane[0], plane[-1] = le[:, c], r[:, c]
        plane[:, 0], plane[:, -1] = b[:, c], t[:, c]
    return planes


def _text(point: Array) -> str:
    """Return a point as text for a message."""
    return f"({point[0]:.9g}, {point[1]:.9g})"
