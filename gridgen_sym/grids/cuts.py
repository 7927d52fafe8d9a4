"""What is left of a convex polygon with whole-number corners: of a node's place, where it is possible, or seen.

A polygon that is cut has new corners, which need not be whole numbers: they are replaced by such a little outside, and
that the polygon then holds what was left is checked. So a polygon may hold too much, never too little.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

from .lattice import OUTSIDE, Point, Polygon, convex_hull, simpler, turn

#: (dx, dy, c): the points with dx y - dy x > c are to its left.
Line = tuple[int, int, int]

#: Polygons less wide than so many units, one way, are not cut any more: rounding would count.
_SMALLEST = 1 << 12


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


def common_part(region: Polygon, other: Polygon) -> Polygon:
    """Return a polygon that holds what two convex polygons have in common, and little more; () if that is nothing."""
    for p, q in zip(other, other[1:] + other[:1], strict=True):
        heights = {point: turn(p, q, point) for point in region}
        inside = [heights[point] >= 0 for point in region]
        if max(heights.values()) <= 0:
            return ()
        if not all(inside):
            region = _cut(region, inside, lambda u, v: (abs(heights[u]), _gap(heights, u, v)))  # noqa: B023
    return region


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
            further = OUTSIDE * (dx + v[1] - u[1]) // size, OUTSIDE * (dy + u[0] - v[0]) // size
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


def _gap(heights: dict[Point, int], u: Point, v: Point) -> int:
    return abs(heights[u] - heights[v])


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
