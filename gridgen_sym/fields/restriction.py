"""Arrays of one grid on a coarser grid of the same logical square."""

from __future__ import annotations

import numpy as np

from ..arrays import Array


def restricted(plane: Array, home: tuple[int, ...], shape: tuple[int, ...]) -> Array:
    """Return a plane of a grid, per node, cell or corner, on another grid of the same logical square.

    Interpolated linearly between nodes, or between the middles of cells.

    Args:
        plane: (ni, nj), (ni-1, nj-1) or (4, ni-1, nj-1).
        home: (ni, nj), the shape of its grid.
        shape: that of the other grid.
    """
    if plane.ndim == 3:
        return np.stack([restricted(corner, home, shape) for corner in plane])
    from scipy.ndimage import map_coordinates

    shift = 0.0 if plane.shape == home else 0.5
    places = [
        (np.arange(new - 2 * shift) + shift) / (new - 1) * (old - 1) - shift
        for old, new in zip(home, shape, strict=True)
    ]
    return np.asarray(map_coordinates(plane, np.meshgrid(*places, indexing="ij"), order=1, mode="nearest"))
