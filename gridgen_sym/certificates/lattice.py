"""Convex polygons with whole-number corners: every sign is exact, and what must be rounded is rounded outwards.

Floating-point numbers are multiples of a power of two, so that points become whole numbers without an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from ..arrays import Array

Point = tuple[int, int]
Polygon = tuple[Point, ...]

#: The extent of a lattice in units, at least: 2 to this power.
_BITS = 72
#: So many units outside the polygon that is cut, a new corner is put.
OUTSIDE = 2
#: A polygon has no more corners than these, if possible: work grows with their number, and more of them tell little.
_MOST_CORNERS = 16


class Lattice:
    """The whole numbers that stand for the coordinates near some points."""

    def __init__(self, points: Array) -> None:
        """Choose a lattice that has all `points` (n, 2), finite, and is much finer than their extent."""
        exact = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
        self.origin = exact[0]
        apart = [abs(value - zero) for point in exact for value, zero in zip(point, self.origin, strict=True)]
        denominator = max(value.denominator for value in apart)
        extent = max(apart) or Fraction(1)
        bits = extent.numerator.bit_length() - extent.denominator.bit_length()
        self.scale = Fraction(2) ** max(denominator.bit_length() - 1, _BITS - bits)

    def points(self, points: Array) -> list[Point]:
        """Return some of the points of the lattice, (n, 2), without an error."""
        x0, y0 = self.origin
        return [
            (int((Fraction(x) - x0) * self.scale), int((Fraction(y) - y0) * self.scale)) for x, y in points.tolist()
        ]

    def coordinates(self, points: Sequence[Point]) -> Array:
        """Return the coordinates (n, 2) of points, rounded."""
        x0, y0 = self.origin
        return np.array([(float(x0 + x / self.scale), float(y0 + y / self.scale)) for x, y in points])


def turn(p: Point, q: Point, r: Point) -> int:
    """Return twice the area of a triangle, positive where it runs counter-clockwise: the Jacobian at a corner."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def doubled_area(polygon: Polygon) -> int:
    """Return twice the area of a polygon, positive where it runs counter-clockwise."""
    return sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True))


def convex_hull(points: Sequence[Point]) -> Polygon:
    """Return the corners of the convex hull counter-clockwise, none on a line between others (A. M. Andrew 1979)."""
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


def simpler(polygon: Polygon) -> Polygon:
    """Return a polygon with not too many corners that holds a convex one, and little more.

    An edge goes where its two neighbors are prolonged until they meet; of all edges, that which adds the least area.
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
    """Return the area added, twice, where the edges pq and rs meet behind the edge qr, rounded outwards, and that edge.

    None if they do not meet there.
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
    holds = all(turn(p, apex, x) >= 0 and turn(apex, s, x) >= 0 for x in (q, r))
    return (turn(q, apex, r), apex, (q, r)) if holds else None
