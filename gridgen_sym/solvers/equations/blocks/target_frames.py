"""Inverse targets V = W⁻¹ of one block in the directions of another.

Before values of two blocks are compared, V is turned by what their directions xi and eta differ by. W says edge
vectors: where it is of a reference grid, they are turned back by the rotation of a periodic connection; where it is of
lengths and angles, as that of walls, each block lays the edge along xi on the x-axis, and so they are laid there again.
"""

from __future__ import annotations

import numpy as np

from ....arrays import Array
from ....topology.copies import Indices

_COSINES, _SINES = np.array([1.0, 0.0, -1.0, 0.0]), np.array([0.0, 1.0, 0.0, -1.0])


def turned_directions(inverse: Array, quarters: Indices) -> Array:
    """Return inverse targets (4, ...) for directions xi and eta that are turned back by so many quarters.

    With T = A V, the edges along xi and eta are those along eta and -xi after one quarter: V exchanges its rows.
    """
    c, s = _COSINES[quarters], _SINES[quarters]
    v11, v12, v21, v22 = inverse
    return np.stack((c * v11 - s * v21, c * v12 - s * v22, s * v11 + c * v21, s * v12 + c * v22))


def turned_edges(inverse: Array, rotation: Array) -> Array:
    """Return inverse targets (4, ...) whose edge vectors are turned back by a rotation (2, ...), cosine and sine."""
    (c, s), (v11, v12, v21, v22) = rotation, inverse
    return np.stack((c * v11 + s * v12, c * v12 - s * v11, c * v21 + s * v22, c * v22 - s * v21))


def on_the_axis(inverse: Array) -> Array:
    """Return inverse targets (4, ...) whose edge along xi lies on the x-axis."""
    v21, v22 = inverse[2:]
    found = turned_edges(inverse, np.stack((v22, -v21)) / np.hypot(v21, v22))
    found[2] = 0.0  # Not only to rounding: this is how such targets are recognized.
    return found


def of_lengths(inverse: Array) -> bool:
    """Whether inverse targets (4, nodes) of all blocks are of lengths and angles: edges along xi lie on the x-axis."""
    return not inverse[2].any()


def in_other_block(inverse: Array, quarters: Indices, turn: Array, *, of_lengths: bool) -> Array:
    """Return inverse targets (4, ...) in the directions, and at the place, of another block.

    Args:
        inverse: of one block.
        quarters: by how many quarters its directions are turned against those of the other.
        turn: cosine and sine of the rotation from the other's place to its own, (2, ...).
        of_lengths: whether they are of lengths and angles.
    """
    found = turned_directions(inverse, quarters)
    return on_the_axis(found) if of_lengths else turned_edges(found, turn)
