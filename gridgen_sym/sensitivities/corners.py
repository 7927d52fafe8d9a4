"""Values at the corners of cells, as kernels count these, and at nodes and in cells."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

#: The corners of a cell as kernels count them: the offsets of their nodes.
OFFSETS = ((0, 0), (1, 0), (0, 1), (1, 1))
#: Their places in arrays that a user gives per corner, which are counter-clockwise; it is its own inverse.
COUNTER_CLOCKWISE = (0, 1, 3, 2)


def at_corners(plane: Array, shape: tuple[int, int]) -> Array:
    """Return a plane per node, cell or corner (counter-clockwise) at the corners as kernels count them."""
    ni, nj = shape
    if plane.shape == shape:
        return np.stack([plane[i : ni - 1 + i, j : nj - 1 + j] for i, j in OFFSETS])
    if plane.ndim == 3:
        return plane[list(COUNTER_CLOCKWISE)]
    return np.broadcast_to(plane, (4, *plane.shape))


def sum_at_nodes(corners: Array) -> Array:
    """Return the sum (ni, nj) over the corners at each node."""
    _, rows, columns = corners.shape
    total = np.zeros((rows + 1, columns + 1))
    for (i, j), part in zip(OFFSETS, corners, strict=True):
        total[i : rows + i, j : columns + j] += part
    return total


def sum_like(corners: Array, plane: Array) -> Array:
    """Return the sums over the corners that a number of a plane per node, cell or corner stands for."""
    if plane.ndim == 3:
        return corners[list(COUNTER_CLOCKWISE)]
    return corners.sum(axis=0) if plane.shape == corners.shape[1:] else sum_at_nodes(corners)
