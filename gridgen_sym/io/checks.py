"""What all formats check: that a file asks for no more memory than a grid needs, and that its points lie in a plane."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..errors import GridgenError
from ..grids.grid import Grid

#: Data that need at most so many bytes are unpacked, whatever they were packed into.
_HARMLESS = 1 << 28
#: Coordinates of nodes that differ do not become shorter than by this factor.
_MOST_PACKED = 200


def check_packing(packed: int, unpacked: int, what: str) -> None:
    """Refuse what would fill the memory from a small file.

    Args:
        packed: bytes in the file.
        unpacked: bytes that these announce.
        what: names the data.

    Raises:
        GridgenError: if no coordinates of a grid can be packed like this.
    """
    if unpacked > _HARMLESS and unpacked > _MOST_PACKED * packed:
        raise GridgenError(
            f"{what} would need {unpacked} bytes of memory, but has {packed} in the file: no grid can be packed so "
            "tightly. If it is one, write it without compression"
        )


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
