"""Convex polygons with whole-number corners: what is cut off is never possible, and pieces fill what they are of."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support_boundaries import SEEDS, star_polygon
from support_polygons import inside, moved, points_in, random_polygon

from gridgen_sym.certificates import convex_decomposition
from gridgen_sym.certificates.clipping import (
    _contains,
    _last_positive,
    _last_visible,
    _shadow,
    _visible,
    bisect,
    clip_to_positive,
    clip_to_visible,
    intersection,
)
from gridgen_sym.certificates.convex_decomposition import decompose_inside, decompose_outside
from gridgen_sym.certificates.integer_polygons import (
    IntegerCoordinates,
    convex_hull,
    doubled_area,
    enclosing_polygon,
    turn,
)


def assert_kept(part, region, possible):
    """Check that what is left of a region has all its possible points, and hardly more than the region."""
    part = region if part is None else part
    if possible:
        assert all(inside(part, q) for q in possible)
    if part:
        assert doubled_area(part) <= doubled_area(region) + 2**45


@given(SEEDS, st.sampled_from([2**40, 2**10, 6]))
def test_no_feasible_position_is_clipped(seed, size):
    """Nor of a region so small that it is not clipped any more."""
    random = np.random.default_rng(seed)
    region, a, c = (random_polygon(random, size=size) for _ in range(3))
    a = moved(a, 2 * size, 0)  # Apart, or else nearly every position is feasible.
    near, others = points_in(random, a, 6), points_in(random, c, 6)
    possible = [q for q in points_in(random, region, 40) if any(turn(q, p, r) > 0 for p in near for r in others)]
    assert_kept(clip_to_positive(region, a, c, 0), region, possible)


@given(SEEDS, st.floats(0.01, 0.99))
def test_just_what_exceeds_the_least_area_is_left(seed, part):
    """The least is chosen so that some corners of the region stay, and others do not."""
    random, size = np.random.default_rng(seed), 2**40
    region, a, c = (random_polygon(random, size=size) for _ in range(3))

    def largest(q):
        return max(turn(q, p, r) for p in a for r in c)

    heights = sorted(map(largest, region))
    least = heights[0] + int(part * (heights[-1] - heights[0]))
    kept = clip_to_positive(region, a, c, least)
    assert all(inside(kept, q) for q in points_in(random, region, 40) if largest(q) > least)
    assert min(map(largest, kept)) > least - 2**6 * size
    assert clip_to_positive(region, a, c, heights[0] - 1) is None
    assert clip_to_positive(region, a, c, heights[-1]) == ()


def along(u, v, part):
    return tuple(p + part * (q - p) for p, q in zip(u, v, strict=True))


def tiny_points(random, count):
    """Points of a few units, of which many are on one line."""
    return [(int(x), int(y)) for x, y in random.integers(-3, 4, (count, 2))]


def test_an_edge_is_clipped_just_where_its_last_point_is_feasible():
    """Exact, of polygons of a few units: one unit too much would be a wrong proof."""
    random, tested = np.random.default_rng(0), 0
    while tested < 300:
        (u, v), a, c = (tiny_points(random, count) for count in (2, random.integers(1, 4), random.integers(1, 4)))
        least = int(random.integers(-1, 3))

        def height(q, a=a, c=c, least=least):
            return max(turn(q, p, r) for p in a for r in c) - least

        if height(u) > 0 >= height(v):
            tested += 1
            part = Fraction(*_last_positive(u, v, a, c, least))
            assert 0 < part <= 1
            assert height(along(u, v, part)) <= 0 < height(along(u, v, part * (1 - Fraction(1, 10**6))))


def test_an_edge_is_clipped_just_where_its_last_point_is_visible():
    random, tested = np.random.default_rng(0), 0
    while tested < 300:
        (u, v, p), obstacle = tiny_points(random, 3), convex_hull(tiny_points(random, random.integers(3, 7)))
        if len(obstacle) > 2 and is_hidden(p, v, obstacle) and not is_hidden(p, u, obstacle):
            tested += 1
            lines = list(_shadow(p, obstacle))
            assert _visible(u, lines)
            assert not _visible(v, lines)
            part = Fraction(*_last_visible(u, v, lines))
            assert 0 <= part < 1
            assert not is_hidden(p, along(u, v, part), obstacle)
            assert is_hidden(p, along(u, v, part + (1 - part) / 1000), obstacle)


def test_a_position_without_a_positive_jacobian_is_infeasible():
    """To the right of a line, and on it."""
    below, a, c = ((0, 0), (8 << 20, 0), (4 << 20, -9 << 20)), ((-1, 0),), ((-9 << 20, 0),)
    kept = clip_to_positive(below, a, c, 0)
    assert kept is None or all(inside(kept, q) for q in below)
    assert clip_to_positive(below, c, a, 0) == ()
    assert clip_to_positive(below, a, a, 0) == ()


def is_hidden(p, q, obstacle):
    """Whether the segment from p to q leads through the inside of a convex polygon: it is clipped, edge after edge."""
    low, high = Fraction(0), Fraction(1)
    for s, t in zip(obstacle, obstacle[1:] + obstacle[:1], strict=True):
        at_p, at_q = turn(s, t, p), turn(s, t, q)
        if at_p <= 0 and at_q <= 0:
            return False
        if at_p < 0 or at_q < 0:
            meets = Fraction(at_p) / (at_p - at_q)
            low, high = (max(low, meets), high) if at_p < 0 else (low, min(high, meets))
    return high > low


@given(SEEDS, st.sampled_from(["apart", "a corner of it", "anywhere"]))
def test_no_visible_position_is_clipped(seed, where):
    random = np.random.default_rng(seed)
    region, a, obstacle = (random_polygon(random) for _ in range(3))
    if where == "apart":
        region, a = moved(region, 2**42, 0), moved(a, -(2**42), 0)
        obstacle = moved(tuple((x, 4 * y) for x, y in obstacle), 0, 0)
    elif where == "a corner of it":
        a = obstacle[:1]
    from_where = points_in(random, a, 6)
    visible = [q for q in points_in(random, region, 40) if any(not is_hidden(p, q, obstacle) for p in from_where)]
    part = clip_to_visible(region, a, obstacle)
    assert_kept(part, region, visible)
    if where == "apart" and part is not None and not part:
        assert not visible


@given(SEEDS)
def test_halves_hold_the_whole(seed):
    random = np.random.default_rng(seed)
    region = random_polygon(random)
    parts = bisect(region, tuple(random.integers(-100, 100, 2).tolist()))
    assert all(inside(parts[0], q) or inside(parts[1], q) for q in points_in(random, region, 60))
    assert max(doubled_area(part) for part in parts) <= doubled_area(region)


@given(SEEDS)
def test_rounding_loses_no_point(seed):
    """Of polygons so small that one unit counts."""
    random = np.random.default_rng(seed)
    region = random_polygon(random, size=12)
    dx, dy = random.integers(-9, 10, 2).tolist()
    parts = bisect(region, (dx, dy))
    middle = sum(dx * y - dy * x for x, y in region)
    for x in range(-12, 13):
        for y in range(-12, 13):
            if inside(region, (x, y)):
                side = len(region) * (dx * y - dy * x) - middle
                assert side < 0 or inside(parts[0], (x, y))
                assert side > 0 or inside(parts[1], (x, y))


@given(SEEDS, st.sampled_from([2**40, 3]))
def test_what_two_polygons_have_in_common_is_kept(seed, size):
    random = np.random.default_rng(seed)
    region, other = random_polygon(random, size=size), random_polygon(random, size=size)
    assume(len(region) > 2)
    part = intersection(region, other)
    common = [q for q in points_in(random, region, 60) + points_in(random, other, 60)]
    common = [q for q in common if inside(region, q) and inside(other, q, strictly=True)]
    assert not common or all(inside(part, q) for q in common)
    if part:
        assert doubled_area(part) <= min(doubled_area(region), doubled_area(other)) + 2**45
    right = max(x for x, _ in region) - min(x for x, _ in other)
    assert intersection(region, moved(other, right + 2**20, 0)) == ()


def test_polygons_with_a_common_edge_have_nothing_else_in_common():
    square = ((0, 0), (2**40, 0), (2**40, 2**40), (0, 2**40))
    assert intersection(square, moved(square, 2**40, 0)) == ()
    assert intersection(square, moved(square, 2**40, 2**40)) == ()
    assert intersection(square, square) == square
    unit = ((0, 0), (1, 0), (1, 1), (0, 1))
    assert intersection(unit, unit) == unit, "however small, it is not empty"


@given(SEEDS)
def test_an_enclosing_polygon_contains_the_whole(seed):
    random = np.random.default_rng(seed)
    angles = (np.arange(30) + 0.5 * random.random(30)) * np.pi / 15
    region = convex_hull([(round(2**40 * np.cos(angle)), round(2**40 * np.sin(angle))) for angle in angles])
    simple = enclosing_polygon(region)
    assert len(simple) <= 16
    assert all(inside(simple, point) for point in region)
    assert doubled_area(simple) < 1.2 * doubled_area(region)


@given(SEEDS, st.integers(5, 40))
def test_what_is_outside_and_inside_of_a_polygon_is_cut_into_convex_pieces(seed, count):
    points = np.rint(star_polygon(seed, count, 0.1) * 2**30)
    ring = [(int(x), int(y)) for x, y in points]
    pieces = decompose_outside(ring, nothing)
    assert all(convex_hull(piece) == piece or set(convex_hull(piece)) == set(piece) for piece in pieces)
    assert all(doubled_area(piece) > 0 for piece in pieces)
    assert sum(map(doubled_area, pieces)) == doubled_area(convex_hull(ring)) - doubled_area(tuple(ring))
    # A star is seen from its center.
    assert not any(inside(piece, (0, 0), strictly=True) for piece in pieces)
    assert all(point in ring for piece in pieces for point in piece)
    pieces = decompose_inside(ring, nothing)
    assert all(doubled_area(piece) > 0 and set(convex_hull(piece)) == set(piece) for piece in pieces)
    assert sum(map(doubled_area, pieces)) == doubled_area(tuple(ring))
    assert any(inside(piece, (0, 0)) for piece in pieces)


def nothing():
    pass


def test_a_decomposition_with_a_gap_is_refused(monkeypatch):
    """What is inside must be covered, or a feasible position could be excluded."""
    ring = [(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)]
    assert decompose_inside(ring, nothing)
    triangulate = convex_decomposition._triangulate
    monkeypatch.setattr(convex_decomposition, "_triangulate", lambda *arguments: triangulate(*arguments)[1:])
    assert decompose_inside(ring, nothing) == []


def skyline(heights):
    """A simple polygon, counter-clockwise, of towers two units wide, with a point at every second unit."""
    count = len(heights)
    ring = [(2 * x, 0) for x in range(1, count)]
    for x, (low, high) in enumerate(zip([*heights, 0][::-1], [0, *heights][::-1], strict=True)):
        ring += [(2 * (count - x), 2 * y) for y in range(low, high, 1 if low < high else -1)]
        ring.append((2 * (count - x), 2 * high))
    return ring


@given(
    st.lists(st.integers(1, 4), min_size=1, max_size=8), st.sampled_from([(1, 0, 0, 1), (0, -1, 1, 0), (2, 1, -3, 1)])
)
def test_many_points_on_one_line_are_cut_into_convex_pieces(heights, matrix):
    """Each piece has an area, and together they have every unit of the inside, and none of the outside."""
    a, b, c, d = matrix
    ring = [(a * x + b * y, c * x + d * y) for x, y in skyline(heights)]
    within, outside = decompose_inside(ring, nothing), decompose_outside(ring, nothing)
    for pieces, area in (
        (within, doubled_area(tuple(ring))),
        (outside, doubled_area(convex_hull(ring)) - doubled_area(tuple(ring))),
    ):
        assert all(doubled_area(piece) > 0 for piece in pieces)
        assert all(set(convex_hull(piece)) == set(piece) for piece in pieces)
        assert sum(map(doubled_area, pieces)) == area
        assert all(point in ring for piece in pieces for point in piece)
    for x, height in enumerate(heights):
        for y in range(4):
            u, v = 2 * x + 1, 2 * y + 1
            center = a * u + b * v, c * u + d * v
            assert y >= height or any(inside(piece, center) for piece in within)
            assert y >= height or not any(inside(piece, center, strictly=True) for piece in outside)


@pytest.mark.parametrize(
    ("point", "hidden", "seen"),
    [
        ((0, 0), ((9, 8), (15, 9), (9, 15)), ((0, 0), (-3, 8), (-8, -8), (8, -3))),
        ((0, 4), ((9, 2), (15, 1), (15, 9), (9, 6)), ((0, -9), (0, 9), (-9, 0))),
        ((0, -4), ((1, 9), (2, 9), (2, 20)), ((0, -4), (8, -8), (8, 0))),
    ],
    ids=["from its corner", "from its edge", "from behind its edge"],
)
def test_an_obstacle_hides_what_is_behind_it(point, hidden, seen):
    """And not what the line of sight reaches along its edge."""
    p, obstacle, behind, beside = (
        tuple((x << 20, y << 20) for x, y in polygon)
        for polygon in ((point,), ((0, 0), (8, 0), (8, 8), (0, 8)), hidden, seen)
    )
    assert clip_to_visible(behind, p, obstacle) == ()
    assert clip_to_visible(convex_hull(beside), p, obstacle) is None


@pytest.mark.parametrize("unit", [1 << 20, 1])
def test_what_is_on_both_sides_of_a_shadow_is_kept(unit):
    """The shadow hides two opposite corners of a region; nor is a region clipped that is small beside rounding."""
    eye, obstacle, region = (
        tuple((x * unit, y * unit) for x, y in polygon)
        for polygon in (((0, -100),), ((-1, 0), (1, 0), (1, 1), (-1, 1)), ((0, 2), (9, 11), (0, 20), (-9, 11)))
    )
    part = clip_to_visible(region, eye, obstacle)
    part = region if part is None else part
    assert all(inside(part, point) for point in (region[1], region[3]))
    assert doubled_area(part) <= doubled_area(region)


def test_a_hull_has_no_corner_between_others():
    assert set(convex_hull([(x, y) for x in range(3) for y in range(3)])) == {(0, 0), (2, 0), (2, 2), (0, 2)}
    assert convex_hull([(2, 2), (0, 0), (1, 1)]) == ((0, 0), (2, 2))


def test_a_polygon_with_parallel_edges_gets_few_corners():
    """The edges above and below never meet behind the one between them."""
    round_end = [(y**2, 1000 * y) for y in range(-10, 11)]
    region = convex_hull([*round_end, (2**20, -10_000), (2**20, 10_000)])
    simple = enclosing_polygon(region)
    assert len(region) > 16 == len(simple)
    assert all(inside(simple, point) for point in region)


@given(SEEDS, st.sampled_from([1e-300, 1e-9, 1.0, 1e300]), st.sampled_from([0.0, 1.0, 1e6]))
def test_integer_coordinates_are_exact(seed, scale, shift):
    points = (np.random.default_rng(seed).random((5, 2)) + shift) * scale
    coordinates = IntegerCoordinates(points)
    assert np.array_equal(coordinates.to_floats(coordinates.to_integers(points)), points)
    # And it is fine enough for what is rounded to be little.
    assert max(abs(value) for point in coordinates.to_integers(points) for value in point) >= 2**70


def test_integer_coordinates_of_very_different_sizes_are_exact():
    points = np.array([(0.1, 5e-324), (1e300, -1.0), (1 + 2**-52, 1e-300), (-1e-17, 3e200)])
    coordinates = IntegerCoordinates(points)
    for (x, y), integers in zip(points.tolist(), coordinates.to_integers(points), strict=True):
        for value, zero, integer in zip((x, y), coordinates.origin, integers, strict=True):
            assert (Fraction(value) - zero) * coordinates.scale == integer
    assert np.array_equal(coordinates.to_floats(coordinates.to_integers(points)), points)


def test_a_polygon_without_area_holds_nothing():
    assert not any(_contains(polygon, (3, 0, 1)) for polygon in ((), ((3, 0),), ((0, 0), (2, 0)), ((0, 0), (9, 0))))
    assert _contains(((0, 0), (4, 0), (0, 4)), (7, 0, 2))
    assert not _contains(((0, 0), (4, 0), (0, 4)), (9, 0, 2))


def test_whether_a_polygon_contains_a_point_is_exact():
    random = np.random.default_rng(0)
    for _ in range(300):
        polygon = convex_hull(tiny_points(random, random.integers(3, 7)))
        if len(polygon) > 2:
            x, y, d = (int(value) for value in (*random.integers(-12, 13, 2), random.integers(1, 5)))
            assert _contains(polygon, (x, y, d)) == inside(polygon, (Fraction(x, d), Fraction(y, d)))
