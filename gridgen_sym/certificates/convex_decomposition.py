"""Convex decomposition of the inside of a simple polygon, and of what its convex hull has outside of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from .integer_polygons import Point, Polygon, convex_hull, doubled_area, turn


def decompose_outside(ring: list[Point], check: Callable[[], object]) -> list[Polygon]:
    """Return convex polygons, without common inner points, that fill the convex hull of a polygon outside of it.

    Args:
        ring: the corners of a simple polygon, counter-clockwise.
        check: called often; what it raises ends the work.
    """
    hull = set(convex_hull(ring))
    first = next(k for k, point in enumerate(ring) if point in hull)
    ring = ring[first:] + ring[: first + 1]
    corners = [k for k, point in enumerate(ring) if point in hull]
    return [
        piece
        for start, end in pairwise(corners)
        for piece in _merge(_triangulate(ring[start : end + 1][::-1], check), check)
    ]


def decompose_inside(ring: list[Point], check: Callable[[], object]) -> list[Polygon]:
    """Return convex polygons, without common inner points, that fill a simple polygon; arguments as above.

    That they fill it is verified by their area: a gap in them could exclude what is possible.
    """
    pieces = _merge(_triangulate(ring, check), check)
    return pieces if sum(map(doubled_area, pieces)) == doubled_area(ring) else []


def _triangulate(polygon: Sequence[Point], check: Callable[[], object]) -> list[Polygon]:
    """Decompose a simple polygon, counter-clockwise, into triangles by ear clipping (G. H. Meisters 1975)."""
    triangles: list[Polygon] = []
    left, k = list(polygon), 0
    while len(left) > 2 and k < len(left):
        check()
        p, q, r = left[k - 1], left[k], left[(k + 1) % len(left)]
        area = turn(p, q, r)
        ear = area > 0 and not any(
            min(turn(p, q, x), turn(q, r, x), turn(r, p, x)) >= 0 for x in left if x not in (p, q, r)
        )
        if ear:
            triangles.append((p, q, r))
        if ear or area == 0:
            del left[k]
        k = 0 if ear or area == 0 else k + 1
    return triangles


def _merge(pieces: Sequence[Polygon], check: Callable[[], object]) -> list[Polygon]:
    """Merge polygons with a common edge as long as they stay convex (S. Hertel, K. Mehlhorn 1983)."""
    pieces, k = list(pieces), 0
    while k < len(pieces):
        check()
        for other in pieces[k + 1 :]:
            union = convex_hull(pieces[k] + other)
            if doubled_area(union) == doubled_area(pieces[k]) + doubled_area(other):
                pieces.remove(other)
                pieces[k] = union
                break
        else:
            k += 1
    return pieces
