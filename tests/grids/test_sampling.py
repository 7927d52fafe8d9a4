"""Where boundary nodes are placed, and where the corners of a grid are put."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import NO_SHARED, SHARED
from support_boundaries import SEEDS, closed_curves, star_polygon

import gridgen_sym as gg
from gridgen_sym.errors import GridgenError
from gridgen_sym.grids.corners import automatic_corners, corner_penalty
from gridgen_sym.grids.sampling import arc_lengths, sample

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
    with pytest.raises(GridgenError, match="5 times 1 and 1 times -1"):
        gg.Outline(NOTCHED, [1, 1, 0, -1, 1, 0, 1, 1])


@pytest.mark.parametrize(
    ("corners", "sampling", "message"),
    [
        ((0, 4, 6, 8), "features", "from 0 to 7, counter-clockwise, but are"),
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
