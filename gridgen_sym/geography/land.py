"""Land: which points lie on islands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array

#: So many pairs of a point and an edge are compared at a time.
_PAIRS = 1 << 22


def land_at(islands: Sequence[Array], points: Array) -> NDArray[np.bool_]:
    """Return which points (..., 2) lie within any of the closed curves (n, 2), by the parity of crossings of a ray."""
    flat = points.reshape(-1, 2)
    land = np.zeros(len(flat), dtype=bool)
    for curve in islands:
        low, high = curve.min(axis=0), curve.max(axis=0)
        near = np.flatnonzero(((flat >= low) & (flat <= high)).all(axis=1))
        for part in np.array_split(near, max(1, len(near) * len(curve) // _PAIRS)):
            land[part] |= _within(curve, flat[part])
    return land.reshape(points.shape[:-1])


def _within(curve: Array, points: Array) -> NDArray[np.bool_]:
    (x, y), (next_x, next_y) = curve.T, np.roll(curve, -1, axis=0).T
    px, py = points[:, :1], points[:, 1:]
    spans = (y > py) != (next_y > py)
    with np.errstate(divide="ignore", invalid="ignore"):  # Level edges span nothing.
        at = x + (py - y) * (next_x - x) / (next_y - y)
    return np.asarray((spans & (at > px)).sum(axis=1) % 2 == 1)
