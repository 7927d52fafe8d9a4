"""Layouts from points, curves and blocks: how sides join, cells are carried over, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.boundary.curve_nodes import nodes_on, nodes_on_polyline, straight
from gridgen_sym.topology.curve_names import Curve
from gridgen_sym.topology.wireframe import Periodic, Wireframe

POINTS = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1), "e": (2, 0), "f": (2, 1)}
BLOCKS = {"one": ["a", "b", "c", "d"], "two": ["b", "e", "f", "c"]}
CELLS = {"a-b": 4, "b-c": 5, "f-c": 6}


def half_circle(radius, start):
    """From an angle on over half a turn, counter-clockwise."""
    return nodes_on(lambda s: radius * np.stack((np.cos(start + np.pi * s), np.sin(start + np.pi * s)), axis=-1))


def test_blocks_share_the_curves_between_their_points():
    layout = Wireframe(POINTS, {}, BLOCKS, CELLS, {"wall": ["a-b", "e-b"], "outlet": ["f-e"]}).layout()
    assert [grid.shape for grid in layout.blocks] == [(5, 6), (7, 6)]
    (bond,) = layout.bonds
    assert (bond.one.side, bond.other.side) == ("right", "left")
    assert [(part.block, part.side) for part in layout.boundaries["wall"]] == [(0, "bottom"), (1, "bottom")]
    assert layout["two"].xy[:, -1] == pytest.approx(np.stack((1 + np.arange(7) / 6, np.ones(7)), axis=-1))


def test_blocks_may_be_turned_and_sides_may_have_parts():
    """The second block begins at another corner; the third lies over both."""
    points = POINTS | {"g": (2, 2), "h": (0, 2)}
    blocks = {"one": BLOCKS["one"], "two": ["e", "f", "c", "b"], "over": [["d-c", "c-f"], ["f-g"], "g-h", "h-d"]}
    layout = Wireframe(points, {}, blocks, CELLS | {"d-h": 3}, {}).layout()
    assert [grid.shape for grid in layout.blocks] == [(5, 6), (6, 7), (11, 4)]
    assert layout.node_count == 11 * 9
    sides = {frozenset(((bond.one.block, bond.one.side), (bond.other.block, bond.other.side))) for bond in layout.bonds}
    assert sides == {
        frozenset(((0, "right"), (1, "top"))),
        frozenset(((0, "top"), (2, "bottom"))),
        frozenset(((1, "right"), (2, "bottom"))),
    }
    assert gg.quality(layout).valid


def test_a_drawn_curve_is_taken_between_its_points():
    bent = Curve(("c", "b"), nodes_on_polyline(np.array([[1, 1], [1.2, 0.5], [1, 0]])))
    layout = Wireframe(POINTS, {"bent": bent}, BLOCKS, CELLS | {"bent": 4, "b-c": 4}, {}).layout()
    assert layout["one"].xy[-1, 2] == pytest.approx([1.2, 0.5])
    assert np.array_equal(layout["one"].xy[-1], layout["two"].xy[0])


def test_the_ends_of_a_curve_are_its_points_bit_by_bit():
    near = Curve(("b", "c"), straight(np.array([1 + 1e-7, 0.0]), np.array([1.0, 1 - 1e-7])))
    layout = Wireframe(POINTS, {"near": near}, BLOCKS, CELLS, {}).layout()
    assert layout["one"].xy[-1, [0, -1]].tolist() == [[1, 0], [1, 1]]


def test_a_block_may_close_round_a_hole():
    points = {"p": (1, 0), "q": (-1, 0), "u": (3, 0), "v": (-3, 0)}
    curves = {}
    for name, radius, a, b in (("inner", 1, "p", "q"), ("outer", 3, "u", "v")):
        curves[f"{name} upper"] = Curve((a, b), half_circle(radius, 0))
        curves[f"{name} lower"] = Curve((b, a), half_circle(radius, np.pi))
    blocks = {"ring": [["inner upper", "inner lower"], "p-u", ["outer upper", "outer lower"], "u-p"]}
    cells = {"inner upper": 6, "inner lower": 8, "p-u": 4, "outer upper": 6}
    layout = Wireframe(points, curves, blocks, cells, {}).layout()
    assert gg.quality(layout).valid
    assert len(layout.bonds) == 1
    assert not layout.outer[0][0, 1:-1].any()


def test_periodic_curves_are_connected():
    pair = Periodic(("a-b", "d-c"), translation=(0.0, 1.0))
    layout = Wireframe(POINTS, {}, BLOCKS, CELLS, {}, [pair]).layout()
    assert [bond.motion.shift for bond in layout.bonds] == [(0.0, 0.0), (0.0, 1.0)]


def test_nodes_lie_on_a_curve_at_equal_lengths_or_by_a_law():
    quarter = nodes_on(lambda s: np.stack((s**2, np.sqrt(1 - s**4)), axis=-1))
    for nodes in (quarter(7), nodes_on(lambda s: np.stack((s**2, np.sqrt(1 - s**4)), axis=-1), "tanh:first=0.01")(7)):
        assert np.hypot(*nodes.T) == pytest.approx(np.ones(8), abs=1e-14)
    assert np.ptp(np.hypot(*np.diff(quarter(7), axis=0).T)) < 1e-4
    line = straight(np.zeros(2), np.array([2.0, 0.0]), "geometric:first=0.1")(6)
    assert line[1] == pytest.approx([0.1, 0])


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (
            {"cells": CELLS | {"e-f": 7}},
            r"those of block two cannot: left \(b-c: 5\) and right \(e-f: 7\). These numbers follow from what cells "
            r"says of b-c, e-f",
        ),
        ({"cells": {"a-b": 4, "b-c": 5}}, "no number of cells follows for b-e, f-c: cells must name one of every"),
        ({"cells": CELLS | {"a-b": 2.5}}, "cells of a-b must be a whole number, at least 1; came 2.5"),
        ({"cells": CELLS | {"b-a": 5}}, "cells of a-b are said twice: 4 and 5"),
        ({"cells": CELLS | {"a-b": 1}}, "bottom of block one has 1 cell; expected at least 2"),
        ({"cells": CELLS | {"a-c": 5}}, "the curve a-c belongs to no block"),
        (
            {"cells": CELLS | {"wall": 5}},
            "unknown curve 'wall' in cells: expected one of a-b, b-c",
        ),
        ({"cells": CELLS | {"a-x": 5}}, "unknown point 'x' in a-x of cells: the points are a, b"),
        ({"blocks": {"one": ["d", "c", "b", "a"]}}, "block one runs clockwise"),
        ({"blocks": {"one": ["a-b", "b-c", "d-a", "c-d"]}}, "the sides of block one do not join: bottom: a to b"),
        ({"blocks": {"one": [["a-b", "e-f"], "f-c", "c-d", "d-a"]}}, "curves of bottom of block one do not follow"),
        ({"blocks": {"one": ["a", "b", "c"]}}, "block one must be four points, counter-clockwise, or the curves of"),
        ({"blocks": {"one": [3, "b-c", "c-d", "d-a"]}}, "a side of block one must be a curve, or a list of curves"),
        (
            {"blocks": BLOCKS | {"three": ["b", "e", "f", "c"]}},
            "the curve b-c is in 3 sides, right of one, left",
        ),
        ({"boundaries": {"wall": ["b-c"]}}, "b-c of boundary wall must be a side of one block, and no connection"),
        ({"curves": {"x": Curve(("a", "a"), straight(np.zeros(2), np.zeros(2)))}}, "begins and ends at a: divide it"),
        (
            {"curves": {"x": Curve(("b", "c"), straight(np.array([1.0, 0.1]), np.ones(2)))}},
            r"the curve x must begin at the point b, \(1.0, 0.0\), but is 0.1 away from it",
        ),
        (
            {"curves": {k: Curve(("b", "c"), straight(np.array([1.0, 0.0]), np.ones(2))) for k in "xy"}},
            "b-c of block one can be x or y: give the name of the curve",
        ),
    ],
)
def test_what_does_not_fit_is_told(changed, told):
    given = {"points": POINTS, "curves": {}, "blocks": BLOCKS, "cells": CELLS, "boundaries": {}} | changed
    with pytest.raises(gg.GridgenError, match=told):
        Wireframe(**given).layout()
