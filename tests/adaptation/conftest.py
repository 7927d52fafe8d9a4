"""What the tests of adaptation share: grids of the square, sharp functions, and the true error of interpolation."""

from __future__ import annotations

import numpy as np

import gridgen_sym as gg
from gridgen_sym import interpolation_error as interpolation_error

#: Monitors of features, by name.
MEASURES = ("gradient", "arc_length", "curvature", "recovery_error", "hierarchical_error")


def square(nodes=33):
    return gg.domain("square", nodes, nodes)


def folded_square(nodes):
    """Return the unit square's grid with two neighbors that have changed places."""
    xy = square(nodes).xy
    xy[5, 5], xy[6, 5] = xy[6, 5].copy(), xy[5, 5].copy()
    return gg.Grid(xy)


def front(x, y):
    """Change by 2 within 1/25, across a diagonal of the unit square."""
    return np.tanh(50 * (x + y - 1))


def shock(x, y):
    """Change by 2 across a quarter of a circle, and so at the boundary."""
    return np.tanh(50 * (np.hypot(x, y) - 0.5))


def ring(x, y):
    """Change by 2 across a circle."""
    return np.tanh(50 * (np.hypot(x - 0.5, y - 0.5) - 0.3))


def two_scales(x, y):
    """Return a wide hill with a wavy front in it."""
    return np.sin(np.pi * x) * np.sin(np.pi * y) + 0.5 * np.tanh(60 * (y - 0.5 - 0.2 * np.sin(2 * np.pi * x)))


#: An L: the square of side 2 without its lower right quarter; the reflex corner is the origin.
L_SHAPE = np.array([(0, 0), (1, 0), (1, 1), (-1, 1), (-1, -1), (0, -1)], dtype=float)
#: Which four of its points are the corners of the grid. Two, one and no turn of the L stand on the side of the origin.
L_CORNERS = {"on a long side": (2, 3, 4, 5), "on a side with a turn": (3, 4, 5, 1), "between two": (4, 5, 1, 2)}


def l_shape(nodes=33, corners=(2, 3, 4, 5)):
    """Return the smooth grid of the L."""
    start = gg.Outline(L_SHAPE, corners).grid(nodes, nodes)
    return gg.optimize(start, "winslow").grid


def corner_singularity(x, y):
    """Return r^(2/3) sin(2 theta/3), harmonic in the L and zero at both sides of its reflex corner."""
    angle = np.arctan2(y, x) % (2 * np.pi)
    return np.hypot(x, y) ** (2 / 3) * np.sin(2 * angle / 3)


SHARP = {"front": front, "shock": shock, "ring": ring, "two scales": two_scales}
