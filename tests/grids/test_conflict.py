"""The search for a proof that no valid grid exists: that it is never wrong, and that it finds what is there."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support_boundaries import flat_polygon, grid_of_ring, smooth_curve, valid_grids

import gridgen_sym as gg
from gridgen_sym.grids.conflict import Conflict, contracted_places, find_conflict
from gridgen_sym.grids.lattice import Lattice, convex_hull, doubled_area, halves, possible_part, turn


def random_polygon(random, size=2**40):
    points = random.integers(-size, size, (random.integers(3, 8), 2)).tolist()
    return convex_hull([(x, y) for x, y in points])


def inside(polygon, point):
    return all(turn(p, q, point) >= 0 for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True))


def points_in(random, polygon, count):
    """Points of a polygon: rounded means of its corners that are still inside."""
    weights = random.dirichlet(np.full(len(polygon), 0.5), count)
    found = [tuple(int(value) for value in np.rint(weight @ np.array(polygon, dtype=float))) for weight in weights]
    return [point for point in found if inside(polygon, point)]


@given(st.integers(0, 2**32 - 1))
def test_no_possible_place_is_cut_off(seed):
    random = np.random.default_rng(seed)
    region, a, c = (random_polygon(random) for _ in range(3))
    a = tuple((x + 2**41, y) for x, y in a)  # Apart, or else nearly every place is possible.
    part = possible_part(region, a, c)
    part = region if part is None else part
    possible = [
        q
        for q in points_in(random, region, 40)
        if any(turn(q, p, r) > 0 for p in [*a, *points_in(random, a, 6)] for r in [*c, *points_in(random, c, 6)])
    ]
    assert all(inside(part, q) for q in possible)
    assert doubled_area(part) <= doubled_area(region) + 2**45 if part else not possible


@given(st.integers(0, 2**32 - 1))
def test_halves_hold_the_whole(seed):
    random = np.random.default_rng(seed)
    region = random_polygon(random)
    parts = halves(region, tuple(random.integers(-100, 100, 2).tolist()))
    assert all(inside(parts[0], q) or inside(parts[1], q) for q in points_in(random, region, 60))
    assert max(doubled_area(part) for part in parts) <= doubled_area(region)


@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-300, 1e-9, 1.0, 1e300]), st.sampled_from([0.0, 1.0, 1e6]))
def test_a_lattice_has_its_points_without_an_error(seed, scale, shift):
    points = (np.random.default_rng(seed).random((5, 2)) + shift) * scale
    lattice = Lattice(points)
    assert np.array_equal(lattice.coordinates(lattice.points(points)), points)


@settings(max_examples=30)
@given(valid_grids())
def test_the_nodes_of_a_valid_grid_are_where_they_can_be(grid):
    """What is contracted too far would exclude a grid that is there; in numbers of the places themselves."""
    places = contracted_places(grid, work=3000)
    assert not isinstance(places, Conflict)
    lattice = Lattice(grid.xy.reshape(-1, 2))
    for node, polygon in places.items():
        corners = lattice.points(polygon)
        (point,) = lattice.points(grid.xy[node][None])
        # Rounded to floating-point numbers, a polygon may have moved by a last bit of the largest coordinate.
        slack = np.abs(polygon).max() * 1e-12 * float(lattice.scale)
        for p, q in zip(corners, corners[1:] + corners[:1], strict=True):
            assert turn(p, q, point) >= -slack * max(abs(q[0] - p[0]), abs(q[1] - p[1]))


#: Boundaries of grids (ni, nj) without a valid grid, and how many cells are left of what conflicts, at most.
IMPOSSIBLE = {
    "a long neck": (grid_of_ring(smooth_curve(3211, 12, 0.6), 5, 3), 8),
    "a wave": (grid_of_ring(smooth_curve(2741, 16, 0.6), 5, 5), 2),
    "a band": (grid_of_ring(flat_polygon(9, 12, 1e-2), 3, 5), 3),
    "a band that only cases decide": (grid_of_ring(flat_polygon(475, 18, 1e-2), 6, 5), 20),
}


@pytest.mark.parametrize(("start", "most"), IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_cells_that_conflict_are_found(start, most):
    assert gg.certificates(start) == ()
    found = find_conflict(start)
    assert isinstance(found, Conflict)
    assert 0 < len(found.cells) <= most
    # The proof needs no other cells.
    again = contracted_places(start, found.cells)
    assert isinstance(again, Conflict)
    assert set(again.cells) <= set(found.cells)


def test_out_of_work_is_no_proof():
    start, _ = IMPOSSIBLE["a band"]
    assert find_conflict(start, work=5) is None
