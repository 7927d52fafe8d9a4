"""The inside of a boundary that does not meet itself, and what its convex hull has outside of it, in convex pieces."""

from __future__ import annotations

from itertools import pairwise

from .lattice import Point, Polygon, convex_hull, doubled_area, turn


def outside_pieces(ring: list[Point]) -> list[Polygon]:
    """Return convex polygons that fill the convex hull of a simple polygon, counter-clockwise, outside of it."""
    hull = set(convex_hull(ring))
    first = next(k for k, point in enumerate(ring) if point in hull)
    ring = ring[first:] + ring[: first + 1]
    corners = [k for k, point in enumerate(ring) if point in hull]
    return [piece for start, end in pairwise(corners) for piece in _united(_triangles(ring[start : end + 1][::-1]))]


def inside_pieces(ring: list[Point]) -> list[Polygon]:
    """Return convex polygons that fill a simple polygon, counter-clockwise."""
    return _united(_triangles(ring))


def _triangles(polygon: list[Point]) -> list[Polygon]:
    """Cut a simple polygon, counter-clockwise, into triangles: one ear after the other."""
    triangles: list[Polygon] = []
    left, k = list(polygon), 0
    while len(left) > 2 and k < len(left):
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


def _united(pieces: list[Polygon]) -> list[Polygon]:
    """Unite polygons with a common edge as long as they stay convex (S. Hertel, K. Mehlhorn 1983)."""
    pieces, k = list(pieces), 0
    while k < len(pieces):
        for other in pieces[k + 1 :]:
            union = convex_hull(pieces[k] + other)
            if doubled_area(union) == doubled_area(pieces[k]) + doubled_area(other):
                pieces.remove(other)
                pieces[k] = union
                break
        else:
            k += 1
    return pieces
