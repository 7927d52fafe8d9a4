"""How large the cells of a grid would be if the spacing of its boundary nodes alone decided that."""

from __future__ import annotations

import numpy as np

from .grid import FloatArray, Grid
from .predicates import scaled


def expected_areas(grid: Grid) -> FloatArray:
    """Return the area (ni-1, nj-1) that the boundary's spacing gives each cell, as a fraction of the whole inside.

    A cell is as wide as its edges of the two opposite sides, each as a part of its side, and the nearer side counts the
    more: the areas of a transfinite grid of the unit square that is spaced as the boundary is. Where cells are narrow
    at a wall, they are expected to be small there. Where the boundary itself is narrow, they are not: a neck, or one
    side much shorter than the opposite one, makes cells small that are well shaped.

    Args:
        grid: any grid with the boundary; its inner nodes do not matter. A side without length says nothing.
    """
    xy = grid.xy
    bottom, top, left, right = (_widths(side) for side in (xy[:, 0], xy[:, -1], xy[0], xy[-1]))
    xi, eta = (((np.arange(count - 1) + 0.5) / (count - 1)) for count in grid.shape)
    across = np.outer(bottom, 1 - eta) + np.outer(top, eta)
    along = np.outer(1 - xi, left) + np.outer(xi, right)
    return np.asarray(across * along)


def _widths(side: FloatArray) -> FloatArray:
    """Return the length of each edge of a side as a part of the whole; 0 if that is 0."""
    # Not differences of arc lengths, in which very short edges are lost; scaled, so that none overflows.
    lengths = np.hypot(*np.diff(scaled(side), axis=0).T)
    return np.asarray(lengths / (lengths.sum() or 1.0))
