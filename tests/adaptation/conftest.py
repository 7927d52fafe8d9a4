"""What the tests of adaptation share: sharp functions, and the true error of bilinear interpolation on a grid."""

from __future__ import annotations

import numpy as np

import gridgen_sym as gg


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


def interpolation_error(grid: gg.Grid, function, values=None) -> float:
    """Return the L2 norm of function minus the bilinear interpolant of its (or the given) nodal values.

    By 8 x 8 Gauss points in each cell.
    """
    points, weights = np.polynomial.legendre.leggauss(8)
    nodes = np.concatenate((grid.planes, [function(*grid.planes) if values is None else values]))
    a, b, c, d = nodes[:, :-1, :-1], nodes[:, 1:, :-1], nodes[:, 1:, 1:], nodes[:, :-1, 1:]
    total = 0.0
    for p, along in zip((points + 1) / 2, weights / 2, strict=True):
        for q, across in zip((points + 1) / 2, weights / 2, strict=True):
            x, y, u = a * (1 - p) * (1 - q) + b * p * (1 - q) + c * p * q + d * (1 - p) * q
            x_xi, y_xi, _ = (b - a) * (1 - q) + (c - d) * q
            x_eta, y_eta, _ = (d - a) * (1 - p) + (c - b) * p
            total += along * across * ((function(x, y) - u) ** 2 * (x_xi * y_eta - x_eta * y_xi)).sum()
    return float(np.sqrt(total))
