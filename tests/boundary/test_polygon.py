"""Closed polygons against plain rational arithmetic: of few whole numbers, all degenerate, and at any scale."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gridgen_sym.boundary import predicates
from gridgen_sym.boundary.polygon import (
    first_crossing,
    first_repeated,
    inner_angles,
    is_clockwise,
    proper_crossings,
    turns,
    winding_number,
)
from gridgen_sym.boundary.predicates import area_sign, orientation, scaled

#: So few that most triples are on one line, and many points on an edge.
FEW = st.integers(-2, 2).map(float)
#: So far apart that products, and even differences, overflow or vanish in floating-point numbers.
SIZES = (0.0, 5e-324, 1e-308, 3e-200, 1e-100, 1e-17, 1.0, 1e17, 1e100, 3e200, 1.7e308)
FAR_APART = st.tuples(st.sampled_from(SIZES), st.sampled_from([1.0, -1.0])).map(np.prod).map(float)
COORDINATES = st.sampled_from([FEW, FAR_APART]).flatmap(lambda numbers: st.tuples(numbers, numbers))
POINTS = st.sampled_from([FEW, FAR_APART]).flatmap(
    lambda numbers: st.lists(st.tuples(numbers, numbers), min_size=3, max_size=9)
)


def sign(value):
    return (value > 0) - (value < 0)


def exact(points):
    return [(Fraction(x), Fraction(y)) for x, y in points]


def cross(p, q, r):
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def edges_of(points):
    return list(zip(points, points[1:] + points[:1], strict=True))


def on_edge(p, q, at):
    return cross(p, q, at) == 0 and all(min(p[k], q[k]) <= at[k] <= max(p[k], q[k]) for k in (0, 1))


def revolutions(directions):
    """How often vectors turn round, each by less than half a turn after the one before; exact: by the ray (1, 0)."""
    count = 0
    for (a, b), (c, d) in edges_of(directions):
        turn = sign(a * d - b * c)
        if turn > 0 and b < 0 <= d:
            count += 1
        if turn < 0 and d < 0 <= b:
            count -= 1
    return count


@given(st.lists(st.tuples(COORDINATES, COORDINATES, COORDINATES), min_size=1, max_size=5))
def test_orientations_are_exact(triples):
    found = orientation(*(np.array([triple[k] for triple in triples]) for k in range(3)))
    assert found.tolist() == [sign(cross(*exact(triple))) for triple in triples]


@pytest.mark.parametrize("size", [5e-324, 1e-308, 3e-200, 0.75, 1.0, 3e200, 1.7e308])
def test_what_is_scaled_is_of_size_1_and_keeps_its_digits(size):
    numbers = size * np.array([[1.0, 0.3], [-0.7, 0.0]])
    found = scaled(numbers)
    assert 0.5 <= np.abs(found).max() < 1
    assert (np.frexp(found)[0] == np.frexp(numbers)[0]).all()
    assert orientation(numbers[0], numbers[1], numbers[1][::-1] - numbers[0]) == orientation(
        found[0], found[1], found[1][::-1] - found[0]
    )


def test_the_error_bound_is_that_of_the_literature():
    unit = 2.0**-53
    assert (3 + 16 * unit) * unit <= predicates._RELATIVE


@given(POINTS)
def test_the_sign_of_the_area_is_exact(points):
    doubled = sum(p[0] * q[1] - p[1] * q[0] for p, q in edges_of(exact(points)))
    assert area_sign(np.array(points)) == sign(doubled)


@given(POINTS, st.data())
def test_windings_are_exact(points, data):
    """At corners, in the middle of edges, level ones, too, and elsewhere."""
    middles = [(p[0] / 2 + q[0] / 2, p[1] / 2 + q[1] / 2) for p, q in edges_of(points)]
    at = data.draw(st.sampled_from(points + middles) | COORDINATES)
    (center,), corners = exact([at]), exact(points)
    on = any(on_edge(p, q, center) for p, q in edges_of(corners))
    expected = None if on else revolutions([(x - center[0], y - center[1]) for x, y in corners])
    assert winding_number(np.array(points), np.array(at)) == expected


@given(POINTS)
def test_a_polygon_is_clockwise_if_its_area_is_negative(points):
    assert is_clockwise(np.array(points)) == (area_sign(np.array(points)) < 0)


def meet(one, other):
    """Whether two edges have a point in common."""
    (p, q), (r, s) = one, other
    if sign(cross(p, q, r)) * sign(cross(p, q, s)) < 0 and sign(cross(r, s, p)) * sign(cross(r, s, q)) < 0:
        return True
    return on_edge(p, q, r) or on_edge(p, q, s) or on_edge(r, s, p) or on_edge(r, s, q)


def runs_back(p, q, r):
    return cross(p, q, r) == 0 and (q[0] - p[0]) * (r[0] - q[0]) + (q[1] - p[1]) * (r[1] - q[1]) < 0


@given(POINTS)
def test_where_a_polygon_meets_itself_is_exact(points):
    array, corners = np.array(points), exact(points)
    edges, count = edges_of(corners), len(points)
    repeated = [k for k in range(count) if corners[k] == corners[(k + 1) % count]]
    assert first_repeated(array) == (repeated[0] if repeated else None)
    assume(not repeated)
    back = [runs_back(corners[k - 1], corners[k], corners[(k + 1) % count]) for k in range(count)]
    turn, found = turns(array)
    assert found.tolist() == back
    assert (turn[found] == np.pi).all()
    wrong = []
    for a, b in combinations(range(count), 2):
        if b - a == 1 or (a, b) == (0, count - 1):
            shared = b if b - a == 1 else a
            wrong += [(a, b)] if back[shared] else []
        elif meet(edges[a], edges[b]):
            wrong.append((a, b))
    assert first_crossing(array) == (min(wrong) if wrong else None)
    proper = [
        (a, b)
        for a, b in combinations(range(count), 2)
        for (p, q), (r, s) in [(edges[a], edges[b])]
        if cross(p, q, r) * cross(p, q, s) < 0 and cross(r, s, p) * cross(r, s, q) < 0
    ]
    assert proper_crossings(array) == proper


@given(POINTS)
def test_turns_add_up_to_whole_revolutions(points):
    corners = exact(points)
    count = len(points)
    assume(all(corners[k] != corners[k - 1] for k in range(count)))
    turn, back = turns(np.array(points))
    assume(not back.any())
    expected = revolutions([(q[0] - p[0], q[1] - p[1]) for p, q in edges_of(corners)])
    assert turn.sum() / (2 * np.pi) == pytest.approx(expected, abs=1e-6)
    signs = [sign(cross(corners[k - 1], corners[k], corners[(k + 1) % count])) for k in range(count)]
    sharp = np.abs(turn) > 3
    assert np.sign(turn)[sharp].tolist() == np.array(signs)[sharp].tolist()


@pytest.mark.parametrize(("x", "winding"), [(-1.0, 0), (0.0, None), (1.0, None), (2.0, None), (3.0, 0)])
@pytest.mark.parametrize("level", [0.0, 2.0])
def test_a_point_on_a_level_edge_is_on_the_polygon(level, x, winding):
    """On its ends, between them, and beside them, where the line of the edge goes on; so of an upright edge."""
    square = np.array([(0, 0), (2, 0), (2, 2), (0, 2)], dtype=float)
    for ring in (square, square[::-1]):
        assert winding_number(ring, np.array([x, level])) == winding
        assert winding_number(ring, np.array([level, x])) == winding


@pytest.mark.parametrize("count", [3, 4, 5, 12, 100])
def test_the_turns_of_a_regular_polygon(count):
    angles = 2 * np.pi * np.arange(count) / count + 0.1
    ring = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    assert turns(ring)[0] == pytest.approx(2 * np.pi / count)
    assert turns(ring[::-1])[0] == pytest.approx(-2 * np.pi / count)


def test_differences_that_overflow_are_halved():
    square = 1.7e308 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    assert turns(square)[0] == pytest.approx(np.pi / 2)
    assert inner_angles(np.roll(square, 1, axis=0), square, np.roll(square, -1, axis=0)) == pytest.approx(90)


def test_edges_on_one_line_meet_only_where_they_overlap():
    bracket = np.array([(0, 0), (4, 0), (4, 5), (0, 5), (0, 3), (2, 3), (2, 2), (0, 2)], dtype=float)
    for ring in (bracket, bracket[::-1], bracket[:, ::-1]):
        assert first_crossing(ring) is None
    bracket[4, 1] = 2  # Both prongs end at one point.
    for ring in (bracket, bracket[::-1], bracket[:, ::-1], bracket * [1, -1], bracket[:, ::-1] * [-1, 1]):
        assert first_crossing(ring) is not None
