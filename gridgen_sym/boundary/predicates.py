"""Exact signs: orientation and area in floating point with an error bound, else in rational arithmetic."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array

# The error of the determinant of differences is below (3 + 16 u) u (|left| + |right|), u = 2**-53 (J. R. Shewchuk,
# Discrete Comput. Geom. 18 (1997) 305-363); the second number bounds what underflows after scaling.
_RELATIVE, _UNDERFLOW = 2.0**-51, 1e-300


def scaled(points: Array) -> Array:
    """Scale coordinates by a power of two, which is exact, so that the largest is in [1/2, 1): products stay finite."""
    _, exponent = math.frexp(float(np.abs(points).max(initial=0.0)))
    # In two steps: one factor alone may overflow.
    half = -exponent // 2
    return np.asarray(np.ldexp(np.ldexp(points, half), -exponent - half))


def orientation(p: Array, q: Array, r: Array) -> NDArray[np.int8]:
    """Return for each triple of points, exactly, 1 for a turn to the left, -1 to the right, 0 on one line.

    Args:
        p: shape (n, 2), or (2,) for one point in all triples; so are q and r.
        q: the second points.
        r: the third points.
    """
    p, q, r = np.broadcast_arrays(np.atleast_2d(p), np.atleast_2d(q), np.atleast_2d(r))
    a, b, c = scaled(np.stack((p, q, r)))
    u, v = b - a, c - a
    left, right = u[:, 0] * v[:, 1], u[:, 1] * v[:, 0]
    sign: NDArray[np.int8] = np.sign(left - right).astype(np.int8)
    doubtful = np.abs(left - right) <= _RELATIVE * (np.abs(left) + np.abs(right)) + _UNDERFLOW
    # Where each product has a factor that is exactly 0, both are. Scaled differences may also vanish by underflow.
    q_same, r_same = q == p, r == p
    doubtful &= ~((q_same[:, 0] | r_same[:, 1]) & (q_same[:, 1] | r_same[:, 0]))
    for k in np.flatnonzero(doubtful):
        sign[k] = _exact_orientation(p[k], q[k], r[k])
    return sign


def area_sign(points: Array) -> int:
    """Return the sign of the signed area of a closed polygon (N, 2), exactly: 1 counter-clockwise, -1 clockwise."""
    u = scaled(points)
    u = u - u[0]
    terms = u[:, 0] * np.roll(u[:, 1], -1), np.roll(u[:, 0], -1) * u[:, 1]
    area = math.fsum(terms[0].tolist()) - math.fsum(terms[1].tolist())
    # Each difference and each product is rounded once: three roundings a term, and those of the sums.
    if abs(area) > 2 * _RELATIVE * float(np.abs(terms).sum()) + len(points) * _UNDERFLOW:
        return 1 if area > 0 else -1
    exact = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
    return _sign(sum(x * t - s * y for (x, y), (s, t) in zip(exact, [*exact[1:], exact[0]], strict=True)))


def _exact_orientation(p: Array, q: Array, r: Array) -> int:
    """Return the orientation of one triple in rational arithmetic."""
    (px, py), (qx, qy), (rx, ry) = ((Fraction(float(x)), Fraction(float(y))) for x, y in (p, q, r))
    return _sign((qx - px) * (ry - py) - (qy - py) * (rx - px))


def _sign(value: Fraction | int) -> int:
    return (value > 0) - (value < 0)
