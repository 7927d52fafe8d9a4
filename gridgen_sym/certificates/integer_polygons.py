"""Convex polygons with integer coordinates: every sign is exact, and what must be rounded is rounded outwards.

Floating-point numbers are multiples of a power of two. So the boundary nodes become integers without an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from ..arrays import Array

Point = tuple[int, int]
Polygon = tuple[Point, ...]

#: Smallest extent of the boundary in units, as a power of two: twenty bits more than floating-point numbers have.
_EXTENT_BITS = 72
#: A new corner is put so many units outside the polygon that is clipped. Two units cover both roundings.
OUTSIDE = 2
#: Largest number of corners, where possible. The cost of a constraint grows with it, and more corners gain little.
_MOST_CORNERS = 16


class IntegerCoordinates:
    """An exact map from floating-point coordinates to integers.

    Attributes:
        origin: the point that becomes (0, 0).
        scale: integer units per unit of length, a power of two that is at least 1.
    """

    def __init__(self, points: Array) -> None:
        """Choose the scale such that all `points` (n, 2), finite, become integers, and a unit is very small."""
        exact = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
        self.origin = exact[0]
        distances = [abs(value - zero) for point in exact for value, zero in zip(point, self.origin, strict=True)]
        denominator = max(value.denominator for value in distances)
        extent = max(distances) or Fraction(1)
        bits = extent.numerator.bit_length() - extent.denominator.bit_length()
        self.scale = Fraction(2) ** max(denominator.bit_length() - 1, _EXTENT_BITS - bits)

    def to_integers(self, points: Array) -> list[Point]:
        """Convert some of the points (n, 2) that the scale was chosen for, exactly."""
        x0, y0 = self.origin
        return [
            (int((Fraction(x) - x0) * self.scale), int((Fraction(y) - y0) * self.scale)) for x, y in points.tolist()
        ]

    def to_floats(self, points: Sequence[Point]) -> Array:
        """Return the coordinates (n, 2) of integer points, rounded."""
        # Integers are divided, which rounds once: a sum of fractions would take ten times as long.
        shifts = [value.numerator * self.scale.numerator for value in self.origin]
        factors = [value.denominator for value in self.origin]
        wholes = [factor * self.scale.numerator for factor in factors]
        return np.array(
            [
                [
                    (shift + value * factor) / whole
                    for shift, value, factor, whole in zip(shifts, point, factors, wholes, strict=True)
                ]
                for point in points
            ]
        )


def turn(p: Point, q: Point, r: Point) -> int:
    """Return twice the signed area of a triangle, positive if it is counter-clockwise: the Jacobian at a corner."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def doubled_area(polygon: Sequence[Point]) -> int:
    """Return twice the signed area of a polygon, positive if it is counter-clockwise."""
    return sum(p[0] * q[1] - p[1] * q[0] for p, q in edges(polygon))


def edges(polygon: Sequence[Point]) -> list[tuple[Point, Point]]:
    """Return the edges of a closed polygon as pairs of points, from its first corner on."""
    return list(zip(polygon, (*polygon[1:], *polygon[:1]), strict=True))


def convex_hull(points: Sequence[Point]) -> Polygon:
    """Return the corners of the convex hull counter-clockwise, without points on its edges (A. M. Andrew 1979)."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return tuple(ordered)
    chains: list[Point] = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[Point] = []
        for point in sequence:
            while len(chain) >= 2 and turn(chain[-2], chain[-1], point) <= 0:
                chain.pop()
            chain.append(point)
        chains += chain[:-1]
    return tuple(chains)


def enclosing_polygon(polygon: Polygon) -> Polygon:
    """Return a convex polygon with few corners that contains a convex one, and little more.

    An edge is removed by extending its two neighbors until they meet. Of all edges the one is removed that adds the
    least area.
    """
    while len(polygon) > _MOST_CORNERS:
        count = len(polygon)
        apices = (_apex(*(polygon[(k + m) % count] for m in range(4))) for k in range(count))
        found = [apex for apex in apices if apex is not None]
        if not found:
            break
        _, corner, edge = min(found)
        polygon = convex_hull([*(point for point in polygon if point not in edge), corner])
    return polygon


def _apex(p: Point, q: Point, r: Point, s: Point) -> tuple[int, Point, tuple[Point, Point]] | None:
    """Return twice the area that is added if the edge qr is removed, the new corner, and the edge.

    The new corner is where the edges pq and sr meet, rounded outwards. None if they do not meet behind qr, or if the
    rounded corner would leave q or r outside.
    """
    (ax, ay), (bx, by) = (q[0] - p[0], q[1] - p[1]), (s[0] - r[0], s[1] - r[1])
    whole = ax * by - ay * bx
    if whole <= 0:
        return None
    part = (r[0] - q[0]) * by - (r[1] - q[1]) * bx
    size = max(abs(ax), abs(ay), abs(bx), abs(by))
    apex = (
        q[0] + part * ax // whole + OUTSIDE * (ax - bx) // size,
        q[1] + part * ay // whole + OUTSIDE * (ay - by) // size,
    )
    contained = all(turn(p, apex, x) >= 0 and turn(apex, s, x) >= 0 for x in (q, r))
    return (turn(q, apex, r), apex, (q, r)) if contained else None
