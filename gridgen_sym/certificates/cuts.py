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


def possible_part(region: Polygon, a: Polygon, c: Polygon, least: int = 0) -> Polygon | None:
    """Return a polygon with all q in `region` for which turn(q, p, r) > `least` for some p in `a` and r in `c`.

    turn(q, p, r) is affine in each of the three. So it is larger for some p in `a` and r in `c` exactly if it is for
    corners of them. Where it is for none, q is in a convex set, and at the corners of what is left of the region
    are corners of it and points on its edges.

    Returns:
        The convex hull of what is left; without corners if that is nothing, and None if it is all.
    """
    return _left_over(region, _turning_left(region, a, c, least), lambda u, v: _last_part(u, v, a, c, least))


def visible_part(region: Polygon, a: Polygon, obstacle: Polygon) -> Polygon | None:
    """Return a polygon with all q in `region` that see some point of `a` past an obstacle, a convex polygon.

    The points hidden by the obstacle from one point form a convex set, and what hides q from all corners of `a` hides
    it from `a`.

    Returns:
        As `possible_part`.
    """
    # Who is to the right of one line of one shadow is in the light.
    lines = [line for p in a for line in _shadow(p, obstacle)]
    return _left_over(region, [_in_light(q, lines) for q in region], lambda u, v: _lit_part(u, v, lines))


def halves(region: Polygon, along: tuple[int, int]) -> tuple[Polygon, Polygon]:
    """Return the parts of a region on either side of the line through its middle in the direction `along`."""
    dx, dy = along
    middle = sum(dx * y - dy * x for x, y in region)
    heights = {(x, y): len(region) * (dx * y - dy * x) - middle for x, y in region}
    return _above(region, heights), _above(region, {point: -height for point, height in heights.items()})


def common_part(region: Polygon, other: Polygon) -> Polygon:
    """Return a polygon that holds what two convex polygons have in common, and little more; () if that is nothing."""
    for p, q in zip(other, other[1:] + other[:1], strict=True):
        heights = {point: turn(p, q, point) for point in region}
        if max(heights.values()) <= 0:
            return ()
        region = _above(region, heights)
    return region


def _above(region: Polygon, heights: dict[Point, int]) -> Polygon:
    """Return a polygon that holds the part of a region where an affine function is not negative."""
    inside = [heights[point] >= 0 for point in region]
    if all(inside):
        return region
    return _cut(region, inside, lambda u, v: (abs(heights[u]), abs(heights[u] - heights[v])))


def _left_over(
    region: Polygon, left: Sequence[bool], part: Callable[[Point, Point], tuple[int, int]]
) -> Polygon | None:
    """Return what is left of a region, given for each corner; the impossible points are a convex set."""
    if all(left):
        return None
    if not any(left):
        return ()
    return None if _width(region) < _SMALLEST else _cut(region, left, part)


def _turning_left(region: Polygon, a: Polygon, c: Polygon, least: int) -> list[bool]:
    """Say for each corner q of a region whether turn(q, p, r) > `least` for some corners p of `a` and r of `c`."""
    found = []
    pair = None
    for q in region:
        # What turns to the left from one corner mostly does so from the next.
        if pair is None or turn(q, *pair) <= least:
            pair = _left_turn(q, a, c, least)
        found.append(pair is not None)
    return found


def _left_turn(q: Point, a: Polygon, c: Polygon, least: int) -> tuple[Point, Point] | None:
    """Return corners p of `a` and r of `c` for which turn(q, p, r) > `least`; None if it is for none."""
    x, y = q
    ends = [(r[0] - x, r[1] - y) for r in c]
    for p in a:
        px, py = p[0] - x, p[1] - y
        for k, (rx, ry) in enumerate(ends):
            if px * ry - py * rx > least:
                return p, c[k]
    return None


def _last_part(u: Point, v: Point, a: Polygon, c: Polygon, least: int) -> tuple[int, int]:
    """Return how far from u to v, as a fraction, some turn(q, p, r) with p in `a`, r in `c` stays above `least`."""
    x, y = u
    dx, dy = v[0] - x, v[1] - y
    # From u to v a turn falls by as much as r is higher than p.
    ends = [(r[0] - x, r[1] - y, dx * (r[1] - y) - dy * (r[0] - x)) for r in c]
    best, whole = 0, 1
    for p in a:
        px, py = p[0] - x, p[1] - y
        height = dx * py - dy * px
        for rx, ry, other in ends:
            at_u = px * ry - py * rx - least
            if at_u > 0 and at_u * whole > best * (other - height):
                best, whole = at_u, other - height
    return best, whole


@lru_cache(maxsize=1 << 16)
def _shadow(p: Point, obstacle: Polygon) -> tuple[Line, ...]:
    """Return lines to the left of all of which an open obstacle hides what is there from p.

    None are needed if p is inside the obstacle: everything is hidden.
    """
    edges = list(zip(obstacle, obstacle[1:] + obstacle[:1], strict=True))
    sides = [turn(q, r, p) for q, r in edges]
    if min(sides) > 0:
        return ()
    lines = [edge for edge, side in zip(edges, sides, strict=True) if side < 0]
    for k, q in enumerate(obstacle):
        # A line from p that touches the obstacle does so where its edges begin, or cease, to face p.
        if q != p and sides[k - 1] <= 0 <= sides[k]:
            lines.append((p, q))
        if q != p and sides[k - 1] >= 0 >= sides[k]:
            lines.append((q, p))
    return tuple((t[0] - s[0], t[1] - s[1], (t[0] - s[0]) * s[1] - (t[1] - s[1]) * s[0]) for s, t in lines)


def _in_light(q: Point, lines: list[Line]) -> bool:
    """Say whether q is not to the left of some line: outside an open shadow."""
    x, y = q
    return any(dx * y - dy * x <= c for dx, dy, c in lines)


def _lit_part(u: Point, v: Point, lines: list[Line]) -> tuple[int, int]:
    """Return how far from u, which is outside some shadow, to v, which is in all, some point is outside one."""
    best = (0, 1)
    for dx, dy, c in lines:
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
