"""Lengths and directions between points: on the ellipsoid of the Earth, or in a plane."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..errors import MissingExtraError

#: The Earth's angular velocity in radians per second, of the IERS conventions.
ROTATION = 7.292115e-5


def lengths(start: Array, end: Array, *, geographic: bool) -> tuple[Array, Array]:
    """Return distances in meters and directions in radians, from east (or x) counter-clockwise, between points.

    Args:
        start: (..., 2), longitude and latitude in degrees, or x and y.
        end: the same.
        geographic: whether they are longitude and latitude: then distances are those of the shortest way on the WGS 84
            ellipsoid, and directions those in its middle.

    Raises:
        MissingExtraError: if pyproj is needed and is not installed.
    """
    if not geographic:
        dx, dy = np.moveaxis(end - start, -1, 0)
        return np.hypot(dx, dy), np.arctan2(dy, dx)
    try:
        from pyproj import Geod
    except ImportError:
        raise MissingExtraError("lengths on the Earth", "geo", "pyproj") from None
    a, b, c, d = (np.ascontiguousarray(one).ravel() for at in (start, end) for one in np.moveaxis(at, -1, 0))
    ahead, back, length = (np.reshape(one, start.shape[:-1]) for one in Geod(ellps="WGS84").inv(a, b, c, d))
    # The direction turns along the way; its middle is the mean of those at both ends.
    ends = np.exp(1j * np.radians(90 - np.asarray(ahead))) - np.exp(1j * np.radians(90 - np.asarray(back)))
    return np.asarray(length), np.angle(ends)
