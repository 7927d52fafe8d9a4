"""Lagrange interpolation at the points of Gauss and Lobatto."""

from __future__ import annotations

import numpy as np

from ..arrays import Array


def lobatto_points(order: int) -> Array:
    """Return the points of Gauss and Lobatto of an order in [0, 1], (order + 1,): the ends, and where P' is zero."""
    inner = np.polynomial.legendre.Legendre.basis(order).deriv().roots()
    return np.concatenate(([0.0], (1 + np.sort(np.real(inner))) / 2, [1.0]))


def interpolation(points: Array, at: Array) -> Array:
    """Return the matrix (len(at), len(points)) from values at points to those of their polynomial at others."""
    matrix = np.ones((len(at), len(points)))
    for k, point in enumerate(points):
        others = np.delete(points, k)
        matrix[:, k] = np.prod((at[:, None] - others) / (point - others), axis=1)
    return matrix
