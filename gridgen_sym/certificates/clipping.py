"""Clipping of convex polygons with integer corners: by Jacobians, by visibility, by half-planes.

The corners of a clipped polygon need not be integers. They are replaced by integer points a little outside, and it is
verified that the polygon then contains what was left. So a result may be too large, and is never too small.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

from .integer_polygons import OUTSIDE, Point, Polygon, convex_hull, edges, enclosing_polygon, turn

#: (dx, dy, c): the points with dx y - dy x > c are to its left.
Line = tuple[int, int, int]

#: Polygons whose smaller extent has fewer units are not clipped any more: rounding outwards would cancel the gain.
_SMALLEST = 1 << 12


def clip_to_positive(region: Polygon, a: Polygon, c: Polygon, least: int) -> Polygon | None:
    """Return a polygon that contains all q in `region` with turn(q, p, r) > `least` for some p in `a` and r in `c`.

    turn(q, p, r) is affine in each of the three points. So it exceeds `least` for some p in `a` and r in `c` exactly
    if it does for corners of them. The q for which it does not form a convex set. So the convex hull of the others
    has as corners only corners of the region and points on its edges.

    Returns:
        A convex polygon that contains what is left; () if nothing is, and None if everything is.
    """
    inside = _positive(region, a, c, least)
    return _clip_by_convex_set(region, inside, lambda u, v: _last_positive(u, v, a, c, least))


def clip_to_visible(region: Polygon, a: Polygon, obstacle: Polygon) -> Polygon | None:
    """Return a polygon that contains all q in `region` that see some point of `a` past a convex obstacle.

    The obstacle is an open set: a segment along its boundary is not blocked. The points that it hides from one point
    form a convex set, and so do the points from which it hides q. So q is hidden from `a` exactly if it is hidden from
    all corners of `a`.

    Returns:
        As `clip_to_positive`.
    """
    # A point that is not to the left of one line of one shadow is visible.
    lines = [line for p in a for line in _shadow(p, obstacle)]
    return _clip_by_convex_set(region, [_visible(q, lines) for q in region], lambda u, v: _last_visible(u, v, lines))


def bisect(region: Polygon, along: tuple[int, int]) -> tuple[Polygon, Polygon]:
    """Return two polygons that contain what is on either side of the line through the mean corner, in a direction."""
    dx, dy = along
    middle = sum(dx * y - dy * x for x, y in region)
    heights = {(x, y): len(region) * (dx * y - dy * x) - middle for x, y in region}
    return _non_negative(region, heights), _non_negative(region, {point: -height for point, height in heights.items()})


def intersection(region: Polygon, other: Polygon) -> Polygon:
    """Return a polygon that contains the intersection of two convex polygons, and little more; () if it has no area."""
    for p, q in edges(other):
        heights = {point: turn(p, q, point) for point in region}
        if max(heights.values()) <= 0:
            return ()
        region = _non_negative(region, heights)
    return region


def _non_negative(region: Polygon, heights: dict[Point, int]) -> Polygon:
    """Return a polygon that contains the part of a region where an affine function, given at its corners, is >= 0."""
    inside = [heights[point] >= 0 for point in region]
    if all(inside):
        return region
    return _clip(region, inside, lambda u, v: (abs(heights[u]), abs(heights[u] - heights[v])))


def _clip_by_convex_set(
    region: Polygon, inside: Sequence[bool], part: Callable[[Point, Point], tuple[int, int]]
) -> Polygon | None:
    """Return what is left of a region when a convex set is removed; arguments as for `_clip`."""
    if all(inside):
        return None
    if not any(inside):
        return ()
    return None if _width(region) < _SMALLEST else _clip(region, inside, part)


def _positive(region: Polygon, a: Polygon, c: Polygon, least: int) -> list[bool]:
    """Return for each corner q of a region whether turn(q, p, r) > `least` for some corners p of `a` and r of `c`."""
    found = []
    pair = None
    for q in region:
        # The pair of the corner before mostly does it for this one, too.
        if pair is None or turn(q, *pair) <= least:
            pair = _positive_pair(q, a, c, least)
        found.append(pair is not None)
    return found


def _positive_pair(q: Point, a: Polygon, c: Polygon, least: int) -> tuple[Point, Point] | None:
    """Return corners p of `a` and r of `c` with turn(q, p, r) > `least`, or None."""
    x, y = q
    ends = [(r[0] - x, r[1] - y) for r in c]
    for p in a:
        px, py = p[0] - x, p[1] - y
        for k, (rx, ry) in enumerate(ends):
            if px * ry - py * rx > least:
                return p, c[k]
    return None


def _last_positive(u: Point, v: Point, a: Polygon, c: Polygon, least: int) -> tuple[int, int]:
    """Return how far from u to v, as a fraction, some turn(q, p, r) with p in `a` and r in `c` stays above `least`."""
    x, y = u
    dx, dy = v[0] - x, v[1] - y
    # From u to v a turn decreases by the height of r minus that of p, both measured from the line uv.
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
    """Return lines such that an open obstacle hides from p what is to the left of all of them.

    There are none if p is inside the obstacle, which then hides everything.
    """
    sides_of = edges(obstacle)
    sides = [turn(q, r, p) for q, r in sides_of]
    if min(sides) > 0:
        return ()
    lines = [edge for edge, side in zip(sides_of, sides, strict=True) if side < 0]
    for k, q in enumerate(obstacle):
        # A line from p touches the obstacle where its edges begin to face p, or cease to.
        if q != p and sides[k - 1] <= 0 <= sides[k]:
            lines.append((p, q))
        if q != p and sides[k - 1] >= 0 >= sides[k]:
            lines.append((q, p))
    return tuple((t[0] - s[0], t[1] - s[1], (t[0] - s[0]) * s[1] - (t[1] - s[1]) * s[0]) for s, t in lines)


def _visible(q: Point, lines: list[Line]) -> bool:
    """Return whether q is not to the left of some line: outside some shadow."""
    x, y = q
    return any(dx * y - dy * x <= c for dx, dy, c in lines)


def _last_visible(u: Point, v: Point, lines: list[Line]) -> tuple[int, int]:
    """Return how far from u, which is visible, to v, which is not, some point is visible, as a fraction."""
    best = (0, 1)
    for dx, dy, c in lines:
        outside = c - (dx * u[1] - dy * u[0])
        if outside >= 0:
            rise = dx * v[1] - dy * v[0] - c + outside
            if outside * best[1] > best[0] * rise:
                best = (outside, rise)
    return best


def _clip(region: Polygon, inside: Sequence[bool], part: Callable[[Point, Point], tuple[int, int]]) -> Polygon:
    """Return a polygon that contains the corners that are `inside`, and the parts that are left of the clipped edges.

    Args:
        region: the polygon.
        inside: for each of its corners, whether it stays.
        part: for an edge from a corner inside to one outside, the fraction of it that stays, as (part, whole).
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
            # Outwards: a little further along the edge, and to its right.
            size = max(abs(dx), abs(dy))
            further = OUTSIDE * (dx + v[1] - u[1]) // size, OUTSIDE * (dy + u[0] - v[0]) // size
            x, y, whole = ends[-1]
            corners.append((x // whole + further[0], y // whole + further[1]))
        if inside[k]:
            corners.append(v)
    polygon = convex_hull(corners)
    if all(_contains(polygon, end) for end in ends):
        return enclosing_polygon(polygon)
    kept = [v for v, stays_in in zip(region, inside, strict=True) if stays_in]
    around = [(x // d + right, y // d + up) for x, y, d in ends for right in (0, 1) for up in (0, 1)]
    return convex_hull(kept + around)


def _contains(polygon: Polygon, end: tuple[int, int, int]) -> bool:
    """Return whether a convex polygon contains the point (x, y) / d."""
    x, y, d = end
    return len(polygon) > 2 and all(
        (q[0] - p[0]) * (y - d * p[1]) - (q[1] - p[1]) * (x - d * p[0]) >= 0 for p, q in edges(polygon)
    )


def _width(region: Polygon) -> int:
    """Return the smaller extent of a polygon along the axes."""
    return min(max(p[k] for p in region) - min(p[k] for p in region) for k in (0, 1))
