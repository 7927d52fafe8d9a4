"""Where a corner of an outline goes at which no valid grid could exist: to the nearest convex turn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support import NO_SHARED, SHARED

import gridgen_sym as gg
from gridgen_sym.boundary.corners import settled_corners


def polygon(*steps):
    """Points on a circle, and so many degrees from each to the next."""
    angle = np.radians(np.concatenate(([0.0], np.cumsum(steps)[:-1])))
    return np.stack((np.cos(angle), np.sin(angle)), axis=-1)


#: Ten points that all turn by some 36 degrees. Seen from point 3, point 4 is nearest, then 2, then 5.
POINTS, CORNERS = polygon(36, 36, 36.5, 34, 37.5, 36, 36, 36, 36, 36), (0, 3, 6, 8)
STRAIGHT, CONVEX, RIGHT = 170.0, 150.0, 90.0


def settled(angles, corners=CORNERS, points=POINTS, nodes=(4, 3)):
    """Settle corners whose angles are given by number and point; those that are not are right."""

    def angles_of(chosen):
        assert len(set(chosen)) == 4
        return np.array([angles.get((k, point), RIGHT) for k, point in enumerate(chosen)])

    return settled_corners(points, corners, nodes, angles_of)


def test_convex_corners_stay():
    assert settled({}) == (CORNERS, ())
    assert settled({(1, 3): STRAIGHT - 0.1}) == (CORNERS, ())


def test_a_straight_corner_goes_to_the_nearest_convex_turn():
    assert settled({(1, 3): STRAIGHT}) == ((0, 4, 6, 8), (1,))
    assert settled({(1, 3): 200.0, (1, 4): CONVEX}) == ((0, 4, 6, 8), (1,))


def test_what_is_not_convex_between_its_nodes_is_passed_over():
    assert settled({(1, 3): 200.0, (1, 4): CONVEX + 0.1}) == ((0, 2, 6, 8), (1,))


def test_no_corner_goes_farther_than_half_of_the_side_that_it_shortens():
    """From point 3 that is beyond 4, which is nearer to 3 than to 6, and beyond 2, which is nearer to 3 than to 0."""
    assert settled({(1, 3): 200.0, (1, 4): 200.0, (1, 2): 200.0}) == (CORNERS, ())
    assert settled({(1, 3): 200.0, (1, 4): 200.0, (1, 2): 200.0}, (0, 3, 8, 9))[0] == (0, 5, 8, 9)


def test_no_other_corner_becomes_straight():
    def angles_of(chosen):
        angles = np.full(4, RIGHT)
        angles[1] = 200.0 if chosen[1] == 3 else RIGHT
        angles[2] = other[chosen[1]]
        return angles

    for at_4, expected in ((STRAIGHT - 0.1, 4), (STRAIGHT, 2), (200.0, 2)):
        other = {3: RIGHT, 4: at_4, 2: RIGHT}
        assert settled_corners(POINTS, CORNERS, (4, 3), angles_of) == ((0, expected, 6, 8), (1,))


@pytest.mark.parametrize("angle", [STRAIGHT, 200.0])
def test_a_corner_that_was_straight_before_is_in_nobodys_way(angle):
    """Corner 2 has no convex turn near it, and stays; corner 1 moves all the same."""
    stuck = {(2, point): angle for point in range(10)}
    assert settled({(1, 3): 200.0, **stuck}) == ((0, 4, 6, 8), (1,))


def test_each_corner_sees_where_those_before_it_have_gone():
    """Corner 0 goes to point 1: then point 2 is beyond the half of the next side."""
    angles = {(1, 3): 200.0, (1, 4): 200.0}
    assert settled(angles) == ((0, 2, 6, 8), (1,))
    assert settled({**angles, (0, 0): 200.0, (0, 9): 200.0}) == ((1, 3, 6, 8), (0,))


@pytest.mark.parametrize(("nodes", "moved"), [((4, 3), (1,)), ((9, 8), ())])
def test_turns_are_seen_over_the_length_of_a_cell(nodes, moved):
    """Of twenty points each turns by 18 degrees, which is straight; over two of them it is 36, and convex."""
    circle = polygon(*[18.2, 17.8] * 10)
    assert settled({(1, 6): 200.0}, (0, 6, 12, 16), circle, nodes)[1] == moved


def test_the_automatic_choice_leaves_out_vertices_that_are_straight_for_few_nodes():
    """The nodes at the end of an edge of the half O-grid are on one line with 30 x 20 cells."""
    outline = gg.Outline.read(Path(__file__).parents[2] / "examples" / "outlines" / "nlf416_half_o.csv")
    choice = outline.choose_corners(31, 21, corners="auto")
    assert max(choice.angles) < STRAIGHT
    assert gg.certificates(outline.grid(31, 21, corners="auto")) == ()


def test_a_triangle_has_three_corners_only():
    choice = gg.Outline([[0, 0], [1, 0], [0.75, 0.5], [0.5, 1], [0.25, 0.5]], "auto").choose_corners(9, 9, "auto")
    assert sorted(choice.angles)[2] < STRAIGHT
    assert max(choice.angles) == pytest.approx(180)


OUTLINES = sorted(path.stem for path in (SHARED / "domains" / "outlines").glob("*.csv") if path.stem != "index")


@pytest.mark.slow
@pytest.mark.parametrize("cells", [(40, 40), (60, 40), (30, 20)])
@pytest.mark.parametrize("name", OUTLINES or ["none"])
def test_the_automatic_choice_is_never_proved_impossible(name, cells):
    path = SHARED / "domains" / "outlines" / f"{name}.csv"
    if not path.exists():
        pytest.skip(NO_SHARED.format(path.name))
    nodes = (cells[0] + 1, cells[1] + 1)
    outline = gg.Outline.read(path)
    choice = outline.choose_corners(*nodes, corners="auto")
    assert max(choice.angles) < STRAIGHT
    assert [f.message for f in gg.certificates(outline.grid(*nodes, corners="auto")) if f.impossible] == []
