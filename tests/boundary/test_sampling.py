"""Where boundary nodes are placed, and where the corners of a grid are put."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import NO_SHARED, SHARED
from support_boundaries import SEEDS, closed_curves, star_polygon

import gridgen_sym as gg
from gridgen_sym.boundary.corners import automatic_corners, corner_penalty
from gridgen_sym.boundary.sampling import arc_lengths, sample, turns_at
from gridgen_sym.errors import GridgenError

OUTLINES = SHARED / "domains" / "outlines"

#: A rectangle whose bottom has a notch, and a corner that stands on its straight right side.
NOTCHED = np.array([[0, 0], [2.9, 0], [3.1, 0.7], [3.3, 0], [6, 0], [6, 1.5], [6, 3], [0, 3]], dtype=float)
SHARP = [1, 2, 3]


def spacings(line, side):
    """The arc lengths between nodes of a polyline that is a graph over its arc length."""
    length = arc_lengths(line)
    fine = np.linspace(0, length[-1], 20001)
    dense = np.stack([np.interp(fine, length, line[:, axis]) for axis in (0, 1)], axis=-1)
    at = fine[[np.abs(dense - node).sum(axis=1).argmin() for node in side]]
    return np.diff(at)


@pytest.mark.parametrize("count", [7, 12, 25, 64, 101])
def test_sharp_turns_are_nodes(count):
    line = NOTCHED[:5]
    side = sample(line, count, "features")
    assert side.shape == (count, 2)
    kept = [k for k in SHARP if (side == line[k]).all(axis=1).any()]
    assert len(kept) == (3 if count > 10 else 1)
    equal = sample(line, count, "equal")
    assert not any((equal == line[k]).all(axis=1).any() for k in SHARP)
    steps = spacings(line, side)
    assert (steps > 0).all()
    assert np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:]).max() < 2.3


@given(SEEDS, st.integers(6, 60), st.integers(3, 80), st.sampled_from([0.9, 0.3, 1e-3]))
def test_spacing_varies_smoothly_and_ends_are_kept(seed, points, count, flatness):
    line = star_polygon(seed, points, flatness)
    for sampling in ("features", "equal"):
        side = sample(line, count, sampling)
        assert np.array_equal(side[[0, -1]], line[[0, -1]])
        assert np.isfinite(side).all()
    # The nodes of a polyline stretched to a straight line stand at its arc lengths.
    length = arc_lengths(line)
    straight = np.stack((length, 0 * length), axis=-1)
    assert sample(straight, count, "features") == pytest.approx(sample(straight, count, "equal"))


def cost_of(places, worth, chosen):
    """The cost of a choice {vertex: node}, as the module `sampling` defines it; infinite if it is not allowed."""
    vertices = sorted(chosen)
    cells = np.diff([chosen[v] for v in vertices])
    if (cells < 1).any() or any(abs(node - np.rint(places[v])) > 3 for v, node in chosen.items()):
        return np.inf
    log = np.log(np.diff(places[vertices]) / cells)
    if (np.abs(log) > np.log(1.5)).any():
        return np.inf
    return (cells * log**2).sum() + sum(worth[v] for v in range(len(places)) if v not in chosen)


@pytest.mark.parametrize("seed", range(20))
def test_the_cheapest_choice_of_vertices_is_taken(seed):
    """All choices are tried, of polylines with a few turns, some blunt, some nearer to each other than a cell."""
    random = np.random.default_rng(seed)
    cells, steps = 12, random.choice((0.15, 0.8, 2.0, 3.0), 5) * random.uniform(0.8, 1.2, 5)
    direction = np.cumsum(np.radians(random.uniform(10, 70, 5)) * random.choice((-1, 1), 5))
    line = np.cumsum([[0, 0], *np.stack((steps * np.cos(direction), steps * np.sin(direction)), axis=1)], axis=0)
    length = arc_lengths(line)
    turn = np.abs(turns_at(line, length, length, length[-1] / cells))
    places = length / length[-1] * cells
    near = np.abs(places[1:-1, None] - places[1:-1]) <= 1 / 3
    sharpest = turn[1:-1] == np.where(near, turn[1:-1], 0).max(axis=1)
    sharp = [k for k in range(1, 5) if turn[k] >= np.radians(20) and sharpest[k - 1]]
    places, worth = places[[0, *sharp, 5]], [0, *turn[sharp] ** 2, 0]
    side = sample(line, cells + 1, "features")
    found = {v: int(k) for v, at in enumerate(line[[0, *sharp, 5]]) for k in np.flatnonzero((side == at).all(axis=1))}
    options = [[None, *(int(np.rint(place)) + shift for shift in range(-3, 4))] for place in places[1:-1]]
    best = min(
        cost_of(places, worth, {0: 0, len(places) - 1: cells} | {v: k for v, k in enumerate(nodes, 1) if k is not None})
        for nodes in product(*options)
    )
    assert cost_of(places, worth, found) == pytest.approx(best, abs=1e-12)


def test_two_near_vertices_far_from_all_others_do_not_end_the_search():
    """The one that is nearer to the end has only the other before it within reach, and cannot be reached from there."""
    bend = np.radians([0, 25, 50])
    steps = np.array([40.8, 0.4, 23.8])
    line = np.cumsum([[0, 0], *np.stack((steps * np.cos(bend), steps * np.sin(bend)), axis=1)], axis=0)
    side = sample(line, 66, "features")
    assert [int(np.flatnonzero((side == at).all(axis=1))[0]) for at in line[[0, 3]]] == [0, 65]
    assert sum((side == at).all(axis=1).any() for at in line[1:3]) == 1


def test_a_smooth_curve_is_sampled_at_equal_arc_length():
    angle = np.linspace(0, 2, 400)
    line = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    assert np.array_equal(sample(line, 30, "features"), sample(line, 30, "equal"))


def test_sampling_does_not_depend_on_scale_and_place():
    outline = gg.Outline(NOTCHED, (0, 4, 6, 7))
    xy = outline.grid(40, 20).xy
    for scale, shift in ((1e-9, 0.0), (1e9, 0.0), (1.0, 1e6)):
        moved = gg.Outline(scale * NOTCHED + shift, (0, 4, 6, 7)).grid(40, 20).xy
        assert moved == pytest.approx(scale * xy + shift, rel=1e-9, abs=1e-9 * scale)


def test_a_straight_corner_moves_to_the_nearest_convex_turn(capsys):
    outline = gg.Outline(NOTCHED, (0, 4, 5, 7), "notched")
    choice = outline.choose_corners(31, 16)
    assert (choice.corners, choice.moved) == ((0, 4, 6, 7), (2,))
    assert choice.angles == pytest.approx((90, 90, 90, 90))
    assert "corner 2 of 'notched' is moved from point 5" in choice.message
    assert "180 degrees, to point 6" in choice.message
    grid = outline.grid(31, 16)
    assert "corner 2 of 'notched' is moved" in capsys.readouterr().err
    assert grid.xy[-1, -1].tolist() == [6, 3]
    assert gg.certificates(grid) == ()
    kept = outline.choose_corners(31, 16, outline.corners)
    assert (kept.corners, kept.moved, kept.message) == (outline.corners, (), "")
    assert kept.penalty > choice.penalty
    assert [c.kind for c in gg.certificates(outline.grid(31, 16, outline.corners))] == ["corner"]
    assert capsys.readouterr().err == ""


def test_a_good_corner_does_not_move():
    assert gg.Outline(NOTCHED, (0, 4, 6, 7)).choose_corners(31, 16).moved == ()
    blunt = np.array([[0, 0], [6, 0], [6.3, 1.5], [6, 3], [0, 3]])
    assert gg.Outline(blunt, (0, 2, 3, 4)).choose_corners(31, 16).moved == ()


def test_automatic_corners_are_those_of_a_rectangle():
    outline = gg.Outline(NOTCHED, "auto")
    assert outline.corners == (0, 4, 6, 7)
    choice = outline.choose_corners(61, 31, "auto")
    assert choice.corners == (0, 4, 6, 7)
    rolled = gg.Outline(np.roll(NOTCHED, 3, axis=0), "auto")
    assert sorted(map(tuple, rolled.points[list(rolled.corners)])) == [(0, 0), (0, 3), (6, 0), (6, 3)]
    rectangle = gg.Outline([[0, 0], [6, 0], [6, 3], [0, 3]], "auto")
    assert rectangle.choose_corners(61, 31).penalty == pytest.approx(0, abs=1e-12)
    # The longer direction gets the more cells.
    assert rectangle.choose_corners(31, 61, "auto").corners in ((1, 2, 3, 0), (3, 0, 1, 2))


def angle_seen(points, vertex, reach):
    """The inner angle in degrees between the points that are a way of `reach` along the polygon from a vertex."""
    ends = []
    for order in (1, -1):
        way, here, k = reach, points[vertex], vertex
        while True:
            k = (k + order) % len(points)
            step = np.hypot(*(points[k] - here))
            if step >= way:
                ends.append((points[k] - here) * way / step + here - points[vertex])
                break
            way, here = way - step, points[k]
    ahead, behind = (complex(*end) for end in ends)
    return np.degrees(np.angle(behind / ahead)) % 360


@given(SEEDS, st.integers(5, 30), st.integers(3, 40), st.integers(3, 40))
@settings(max_examples=40)
def test_the_penalty_is_that_of_its_definition(seed, count, ni, nj):
    points = star_polygon(seed, count, 0.3)
    corners = np.arange(4) * len(points) // 4
    perimeter = np.hypot(*np.diff(points, axis=0, append=points[:1]).T).sum()
    expected = 0.0
    for corner in corners:
        narrow, wide = (angle_seen(points, corner, perimeter / cells) for cells in (2 * (ni + nj) - 4, 24))
        expected += ((narrow + wide) / 2 / 90 - 1) ** 2 + 25 * max(narrow - 150, 0) ** 2 / 900
    sides = [points[first : last + 1] for first, last in pairwise(corners)]
    sides.append(np.concatenate((points[corners[3] :], points[:1])))
    bottom, right, top, left = (np.hypot(*np.diff(side, axis=0).T).sum() for side in sides)
    expected += np.log(bottom / top) ** 2 + np.log(left / right) ** 2
    expected += np.log((bottom + top) / (ni - 1) / (left + right) * (nj - 1)) ** 2 / 4
    assert corner_penalty(points, corners[None], ni, nj)[0] == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_sides_that_rounding_leaves_nothing_of_cannot_be_chosen():
    points = np.array([[-1, 0], [0, 0], [1e-30, 0], [1, 0], [1, 1], [0, 1], [0, 1 + 1e-16], [-1, 1]])
    assert corner_penalty(points, np.array([[1, 2, 5, 6]]), 9, 9)[0] == np.inf


@pytest.mark.parametrize("degrees", range(0, 90, 7))
def test_of_equal_numberings_the_one_that_starts_nearest_to_the_start_is_taken(degrees):
    turn = np.exp(1j * np.radians(degrees)) * np.array([0, 1, 1 + 1j, 1j])
    square = np.stack((turn.real, turn.imag), axis=1)
    assert gg.Outline(square, "auto").choose_corners(9, 9, "auto").corners == (0, 1, 2, 3)
    late = np.concatenate((0.9 * square[:1] + 0.1 * square[1:2], square[1:], square[:1]))
    assert automatic_corners(late, 9, 9) == (4, 1, 2, 3)


def test_automatic_corners_of_a_circle_balance_its_sides():
    angle = 2 * np.pi * np.arange(240) / 240
    circle = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    assert np.diff(gg.Outline(circle, "auto").corners).tolist() == [60, 60, 60]


@given(closed_curves(st.integers(4, 30)))
@settings(max_examples=50)
def test_the_automatic_choice_is_the_best_of_its_kind(points):
    chosen = automatic_corners(points, 9, 9)
    assert len({*chosen}) == 4
    penalty = corner_penalty(points, np.array([chosen]), 9, 9)[0]
    even = [[k * len(points) // 4 for k in range(4)]]
    if len(points) <= 12:  # All are candidates.
        assert penalty <= corner_penalty(points, np.array(even), 9, 9)[0] + 1e-9


def test_corners_marked_as_in_pygridgen():
    marks = [1, 0, 0, 0, 1, 0, 1, 1]
    assert gg.Outline(NOTCHED, marks) == gg.Outline(NOTCHED, (0, 4, 6, 7))
    rolled = gg.Outline(np.roll(NOTCHED, 3, axis=0), np.roll(marks, 3))
    assert rolled.points[0].tolist() == [6, 3]
    assert rolled.corners == (0, 1, 2, 6)
    with pytest.raises(GridgenError, match="5 times 1 and 0 times -1"):
        gg.Outline(NOTCHED, [1, 1, 0, 0, 1, 0, 1, 1])


@pytest.mark.parametrize(
    ("corners", "sampling", "message"),
    [
        ((0, 4, 6, 8), "features", "from 0 to 7, in the order of the points, but are"),
        ((0, 6, 4, 7), "features", "four different indices"),
        ((0, 4, 4, 7), "features", "four different indices"),
        ((0, 4, 7), "features", "four different indices"),
        ("best", "features", "array of real numbers"),
        (None, "even", "sampling must be 'features' or 'equal', but is 'even'"),
    ],
)
def test_bad_choices(corners, sampling, message):
    with pytest.raises(GridgenError, match=message):
        gg.Outline(NOTCHED, (0, 4, 6, 7)).grid(9, 9, corners, sampling)


@settings(max_examples=50)
@given(closed_curves(), st.sampled_from(["features", "equal"]), st.sampled_from([None, "auto"]))
def test_any_curve_gives_a_grid_or_a_clear_message(points, sampling, corners):
    try:
        outline = gg.Outline(points, "auto" if corners == "auto" else (0, 1, 2, 3), reorient=True)
        grid = outline.grid(7, 5, corners, sampling)
    except GridgenError:
        return  # A curve that crosses itself, repeats a point, or does so with as few nodes.
    assert np.isfinite(grid.planes).all()
    assert all(found.kind != "crossing" for found in gg.certificates(grid))


@pytest.mark.slow
@pytest.mark.skipif(not OUTLINES.is_dir(), reason=NO_SHARED.format("domains/outlines"))
@pytest.mark.parametrize(("corners", "cells"), [(None, 64), (None, 128), ("auto", 64)])
def test_sampled_outlines_have_no_certificate(corners, cells):
    moved = {}
    for path in sorted(OUTLINES.glob("*.csv")):
        if path.stem != "index" and (corners is None or path.stem in ("australia", "poland", "lake_victoria")):
            outline = gg.Outline.read(path)
            choice = outline.choose_corners(cells + 1, cells + 1, corners)
            moved[path.stem] = choice.moved
            assert max(choice.angles) < 170
            assert gg.certificates(outline.grid(cells + 1, cells + 1, choice.corners)) == ()
    if corners is None:
        expected = {"australia": (2,), "lake_victoria": (1, 2), "lake_superior": (0,)}
        assert {name: where for name, where in moved.items() if where} == expected
