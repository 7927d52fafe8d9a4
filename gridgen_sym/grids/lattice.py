"""Convex polygons with whole-number corners: every sign is exact, and what must be rounded is rounded outwards.

Floating-point numbers are multiples of a power of two, so that points become whole numbers without an error. A polygon
that is cut has new corners, which need not be whole numbers: they are replaced by such a little outside, and that the
polygon then holds what was left is checked. So a polygon may hold too much, never too little.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache

import numpy as np

from .grid import FloatArray

Point = tuple[int, int]
Polygon = tuple[Point, ...]
#: (dx, dy, c): the points with dx y - dy x > c are to its left.
Line = tuple[int, int, int]

#: The extent of a lattice in units, at least: 2 to this power.
_BITS = 72
#: Polygons less wide than so many units, one way, are not cut any more: rounding would count.
_SMALLEST = 1 << 12
#: So many units outside the polygon that is cut, a new corner is put.
_OUTSIDE = 2
#: A polygon has no more corners than these, if possible: work grows with their number, and more of them tell little.
_MOST_CORNERS = 8


class Lattice:
    """The whole numbers that stand for the coordinates near some points."""

    def __init__(self, points: FloatArray) -> None:
        """Choose a lattice that has all `points` (n, 2), finite, and is much finer than their extent."""
        exact = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
        self.origin = exact[0]
        apart = [abs(value - zero) for point in exact for value, zero in zip(point, self.origin, strict=True)]
        denominator = max(value.denominator for value in apart)
        extent = max(apart) or Fraction(1)
        bits = extent.numerator.bit_length() - extent.denominator.bit_length()
        self.scale = Fraction(2) ** max(denominator.bit_length() - 1, _BITS - bits)

    def points(self, points: FloatArray) -> list[Point]:
        """Return some of the points of the lattice, (n, 2), without an error."""
        x0, y0 = self.origin
        return [
            (int((Fraction(x) - x0) * self.scale), int((Fraction(y) - y0) * self.scale)) for x, y in points.tolist()
        ]

    def coordinates(self, points: Sequence[Point]) -> FloatArray:
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


def possible_part(region: Polygon, a: Polygon, c: Polygon) -> Polygon | None:
    """Return a polygon with all q in `region` that turn to the left to some point of `a` and on to one of `c`.

    turn(q, p, r) is affine in each of the three. So it is positive for some p in `a` and r in `c` exactly if it is for
    corners of them. Where it is for none, q is in a convex set, and at the corners of what is left of the region
    are corners of it and points on its edges.

    Returns:
        The convex hull of what is left; without corners if that is nothing, and None if it is all.
    """
    return _left_over(region, lambda q: _turns_left(q, a, c), lambda u, v: _last_part(u, v, a, c))


def visible_part(region: Polygon, a: Polygon, obstacle: Polygon) -> Polygon | None:
    """Return a polygon with all q in `region` that see some point of `a` past an obstacle, a convex polygon.

    The points hidden by the obstacle from one point form a convex set, and what hides q from all corners of `a` hides
    it from `a`.

    Returns:
        As `possible_part`.
    """
    shadows = [shadow for p in a if (shadow := _shadow(p, obstacle)) is not None]
    return _left_over(region, lambda q: _in_light(q, shadows), lambda u, v: _lit_part(u, v, shadows))


def _left_over(
    region: Polygon, possible: Callable[[Point], bool], part: Callable[[Point, Point], tuple[int, int]]
) -> Polygon | None:
    """Return what is left of a region whose impossible points are a convex set; see `possible_part`."""
    left = [possible(q) for q in region]
    if all(left):
        return None
    if not any(left):
        return ()
    return None if _width(region) < _SMALLEST else _cut(region, left, part)


@lru_cache(maxsize=1 << 16)
def _shadow(p: Point, obstacle: Polygon) -> tuple[Line, ...] | None:
    """Return lines to the left of all of which an open obstacle hides what is there from p.

    None if p is inside the obstacle, which hides everything.
    """
    edges = list(zip(obstacle, obstacle[1:] + obstacle[:1], strict=True))
    sides = [turn(q, r, p) for q, r in edges]
    if min(sides) > 0:
        return None
    lines = [edge for edge, side in zip(edges, sides, strict=True) if side < 0]
    for q in obstacle:
        if q != p:
            turns = [turn(p, q, r) for r in obstacle]
            if min(turns) >= 0:
                lines.append((p, q))
            if max(turns) <= 0:
                lines.append((q, p))
    return tuple((t[0] - s[0], t[1] - s[1], (t[0] - s[0]) * s[1] - (t[1] - s[1]) * s[0]) for s, t in lines)


def _in_light(q: Point, shadows: list[tuple[Line, ...]]) -> bool:
    """Say whether q is outside some of the open shadows."""
    x, y = q
    return any(dx * y - dy * x <= c for shadow in shadows for dx, dy, c in shadow)


def _lit_part(u: Point, v: Point, shadows: list[tuple[Line, ...]]) -> tuple[int, int]:
    """Return how far from u, which is outside some shadow, to v, which is in all, some point is outside one."""
    best = (0, 1)
    for shadow in shadows:
        for dx, dy, c in shadow:
            outside = c - (dx * u[1] - dy * u[0])
            if outside >= 0:
                rise = dx * v[1] - dy * v[0] - c + outside
                if outside * best[1] > best[0] * rise:
                    best = (outside, rise)
    return best


def halves(region: Polygon, along: tuple[int, int]) -> tuple[Polygon, Polygon]:
    """Return the parts of a region on either side of the line through its middle in the direction `along`."""
    dx, dy = along
    middle = sum(dx * y - dy * x for x, y in region)
    heights = {(x, y): len(region) * (dx * y - dy * x) - middle for x, y in region}
    parts = []
    for sign in (1, -1):
        inside = [sign * heights[point] >= 0 for point in region]
        whole = all(inside)
        parts.append(region if whole else _cut(region, inside, lambda u, v: (abs(heights[u]), _gap(heights, u, v))))
    return parts[0], parts[1]


def _gap(heights: dict[Point, int], u: Point, v: Point) -> int:
    return abs(heights[u] - heights[v])


def _turns_left(q: Point, a: Polygon, c: Polygon) -> bool:
    """Say whether turn(q, p, r) > 0 for some corners p of `a` and r of `c`."""
    x, y = q
    ends = [(r[0] - x, r[1] - y) for r in c]
    return any((p[0] - x) * s - (p[1] - y) * r > 0 for p in a for r, s in ends)


def _last_part(u: Point, v: Point, a: Polygon, c: Polygon) -> tuple[int, int]:
    """Return how far from u to v, as a fraction, some turn(q, p, r) with p in `a` and r in `c` stays positive."""
    best = (0, 1)
    for p in a:
        for r in c:
            at_u = turn(u, p, r)
            if at_u > 0:
                fall = at_u - turn(v, p, r)
                if at_u * best[1] > best[0] * fall:
                    best = (at_u, fall)
    return best


def _cut(region: Polygon, inside: Sequence[bool], part: Callable[[Point, Point], tuple[int, int]]) -> Polygon:
    """Return a polygon with the corners that are `inside`, and with a part of each edge that leads out.

    Args:
        region: the polygon.
        inside: for each of its corners, whether it stays.
        part: for an edge from a corner inside to one outside, the fraction of it that stays.
    """
    corners: list[Point] = []
    ends: list[tuple[int, int, int]] = []  # As (x, y, common denominator).
    for k, v in enumerate(region):
        u = region[k - 1]
        if inside[k - 1] != inside[k]:
            stays, goes = (u, v) if inside[k - 1] else (v, u)
            fraction, whole = part(stays, goes)
            dx, dy = goes[0] - stays[0], goes[1] - stays[1]
            ends.append((stays[0] * whole + fraction * dx, stays[1] * whole + fraction * dy, whole))
            # A little further, and to the right of the edge.
            size = max(abs(dx), abs(dy))
            further = _OUTSIDE * (dx + v[1] - u[1]) // size, _OUTSIDE * (dy + u[0] - v[0]) // size
            x, y, whole = ends[-1]
            corners.append((x // whole + further[0], y // whole + further[1]))
        if inside[k]:
            corners.append(v)
    polygon = convex_hull(corners)
    if all(_holds(polygon, end) for end in ends):
        return simpler(polygon)
    kept = [v for v, stays_in in zip(region, inside, strict=True) if stays_in]
    around = [(x // d + right, y // d + up) for x, y, d in ends for right in (0, 1) for up in (0, 1)]
    return convex_hull(kept + around)


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
        q[0] + part * ax // whole + _OUTSIDE * (ax - bx) // size,
        q[1] + part * ay // whole + _OUTSIDE * (ay - by) // size,
    )
    holds = all(turn(p, apex, x) >= 0 and turn(apex, s, x) >= 0 for x in (q, r))
    return (turn(q, apex, r), apex, (q, r)) if holds else None


def _holds(polygon: Polygon, end: tuple[int, int, int]) -> bool:
    """Say whether a convex polygon holds the point (x, y) / d."""
    x, y, d = end
    return len(polygon) > 2 and all(
        (q[0] - p[0]) * (y - d * p[1]) - (q[1] - p[1]) * (x - d * p[0]) >= 0
        for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    )


def _width(region: Polygon) -> int:
    """Return the smaller extent of a polygon along the axes."""
    return min(max(p[k] for p in region) - min(p[k] for p in region) for k in (0, 1))
