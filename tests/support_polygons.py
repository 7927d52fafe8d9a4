"""Random convex polygons with whole-number corners, and points in them."""

from __future__ import annotations

import numpy as np

from gridgen_sym.certificates.integer_polygons import convex_hull, turn


def random_polygon(random, corners=8, size=2**40):
    points = random.integers(-size, size, (random.integers(3, corners), 2)).tolist()
    return convex_hull([(x, y) for x, y in points])


def moved(polygon, x, y):
    return tuple((p + x, q + y) for p, q in polygon)


def inside(polygon, point, strictly=False):
    turns = [turn(p, q, point) for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True)]
    return min(turns) > 0 if strictly else min(turns) >= 0


def points_in(random, polygon, count):
    """The corners of a polygon, and rounded means of these that are still inside."""
    weights = random.dirichlet(np.full(len(polygon), 0.5), count)
    found = [tuple(int(value) for value in np.rint(weight @ np.array(polygon, dtype=float))) for weight in weights]
    return [*polygon, *(point for point in found if inside(polygon, point))]
