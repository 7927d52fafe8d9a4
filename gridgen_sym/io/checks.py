"""What all formats check: that the points of a file lie in a plane."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..errors import GridgenError
from ..grids.grid import Grid


def plane_grid(x: Array, y: Array, z: Array | None = None) -> Grid:
    """Return the grid of planes of coordinates, each of shape (ni, nj), of which z must be constant.

    Raises:
        GridgenError: if a coordinate is not finite, or z varies.
    """
    grid = Grid.from_planes(x, y)
    if z is None:
        return grid
    bad = ~np.isfinite(z)
    if bad.any():
        i, j = (int(index) for index in np.argwhere(bad)[0])
        raise GridgenError(f"every z must be finite, but that of node ({i}, {j}) is {z[i, j]}: write it again")
    if (z != z[0, 0]).any():
        raise GridgenError("it is a surface in space, its z varies; expected a plane grid")
    return grid
