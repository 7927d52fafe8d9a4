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


SHARP = {"front": front, "shock": shock, "ring": ring, "two scales": two_scales}
