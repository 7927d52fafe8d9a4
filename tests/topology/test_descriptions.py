"""Layouts in TOML: the committed examples, every kind of curve, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gridgen_sym as gg

EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "layouts").glob("*.toml"))
#: Blocks, connections, names of boundaries.
KNOWN = {
    "airfoil_c": (1, 1, ["wall", "farfield", "outlet"]),
    "cascade": (2, 3, ["inlet", "outlet", "blade"]),
    "duct": (2, 1, ["inlet", "outlet", "wall"]),
    "pipe_in_box": (4, 4, ["wall", "pipe"]),
    "river": (2, 2, ["inlet", "outlet", "bank", "island"]),
}
SQUARE = """
[points]
A = [0, 0]
B = [1, 0]
C = [1, 1]
D = [0, 1]
[blocks]
square = ["A", "B", "C", "D"]
[cells]
A-B = 4
B-C = 4
"""


def read(tmp_path, text, **given):
    path = tmp_path / "layout.toml"
    path.write_text(text, encoding="utf-8")
    return gg.read_layout(path, **given)


def with_curve(curve):
    """A square whose bottom is a curve."""
    return SQUARE.replace("[blocks]", f"[curves]\nbottom = {curve}\n[blocks]")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_read_and_solved(path):
    start = gg.read_layout(path)
    assert (len(start), len(start.bonds), list(start.boundaries)) == KNOWN[path.stem]
    named = sum(part.count - 1 for parts in start.boundaries.values() for part in parts)
    joined = sum(2 * (bond.one.count - 1) for bond in start.bonds)
    assert named + joined == sum(2 * (grid.shape[0] + grid.shape[1] - 2) for grid in start.blocks)
    found = gg.optimize(start, "winslow")
    assert found.converged
    assert found.quality.valid
    assert found.quality.min_scaled_jacobian > 0.35


def test_an_interface_that_nobody_drew_becomes_smooth():
    """Before the island lines bend by many degrees at the straight interface; solved, only beside its tip."""
    start = gg.read_layout(EXAMPLES[[path.stem for path in EXAMPLES].index("river")])

    def bend(layout):
        north, south = layout["north"].xy, layout["south"].xy
        up, down = north[1:11, 1] - north[1:11, 0], south[1:11, -1] - south[1:11, -2]
        cross = up[:, 0] * down[:, 1] - up[:, 1] * down[:, 0]
        return np.degrees(np.abs(np.arctan2(cross, (up * down).sum(axis=1)))).max()

    assert bend(start) > 10
    assert bend(gg.optimize(start, "winslow").grid) < 2


def test_all_numbers_of_cells_can_be_multiplied(tmp_path):
    assert read(tmp_path, SQUARE, refine=3)["square"].shape == (13, 13)


def test_every_kind_of_curve(tmp_path):
    (tmp_path / "bed.csv").write_text("x,y\n0,0\n0.5,-0.2\n1,0\n", encoding="utf-8")
    for curve, middle in (
        ('{ line = ["A", "B"], spacing = "geometric:first=0.1" }', None),
        ('{ polyline = ["A", [0.5, -0.2], "B"] }', (0.5, -0.2)),
        ('{ polyline = "bed.csv", ends = ["A", "B"] }', (0.5, -0.2)),
        ('{ spline = "bed.csv", ends = ["A", "B"] }', (0.5, -0.2)),
        ('{ spline = ["B", [0.5, -0.2], "A"] }', (0.5, -0.2)),
        ('{ arc = ["A", "B"], center = [0.5, 0] }', (0.5, -0.5)),
        ('{ arc = ["B", "A"], center = [0.5, 0], clockwise = true }', (0.5, -0.5)),
        ('{ formula = ["t", "-0.3*sin(pi*t)"], ends = ["A", "B"] }', (0.5, -0.3)),
        ('{ formula = ["1 - t", "0"], ends = ["B", "A"] }', (0.5, 0)),
        ('{ section = "naca0012", part = "lower", ends = ["A", "B"] }', None),
    ):
        bottom = read(tmp_path, with_curve(curve))["square"].xy[:, 0]
        assert bottom[[0, -1]] == pytest.approx(np.array([[0, 0], [1, 0]]), abs=1e-6)
        if middle:
            assert bottom[2] == pytest.approx(middle, abs=1e-3)
        elif "line" in curve:
            assert bottom[1] == pytest.approx([0.1, 0])
        else:
            assert bottom[1:-1, 1].max() < -0.02


def test_a_curve_may_make_its_points(tmp_path):
    text = SQUARE.replace("A = [0, 0]\nB = [1, 0]\n", "")
    text = text.replace("[blocks]", '[curves]\nbottom = { formula = ["t", "-0.1*t"], ends = ["A", "B"] }\n[blocks]')
    assert read(tmp_path, text)["square"].xy[-1, 0] == pytest.approx([1, -0.1])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[points", "layout.toml: it is no TOML file"),
        (f"a = {'9' * 5000}", "layout.toml: it is no TOML file"),
        (SQUARE + "[wall]\n", "unknown key 'wall' in a layout; known: points, curves, blocks"),
        ("points = 3\n" + SQUARE.replace("[points]", "[p]"), "unknown key 'p' in a layout"),
        ("[points]\nA = [0, 0]\n", "a layout has no blocks; expected at least blocks and cells"),
        (SQUARE.replace("A = [0, 0]", "A = [0]"), r"the point A must be two numbers \[x, y\]; came \[0\]"),
        (SQUARE.replace("A = [0, 0]", "A = [0, nan]"), "y of the point A must be a finite number; came nan"),
        (SQUARE.replace("A = [0, 0]", f"A = [{10**400}, 0]"), "x of the point A must be a finite number"),
        (SQUARE.replace("A = [0, 0]", "A-1 = [0, 0]"), "the point 'A-1' has a dash in its name"),
        (SQUARE.replace("A-B = 4", "A-B = 4.5"), "cells of A-B must be a whole number"),
        (SQUARE.replace("B-C = 4", ""), "no number of cells follows for B-C, D-A"),
        (SQUARE + "C-D = 5", r"those of block square cannot: bottom \(A-B: 4\) and top \(C-D: 5\)"),
        (SQUARE + "[boundaries]\nwall = 'A-B'", r"the boundary wall must be a list of curves, such as \['A-B'\]"),
        (SQUARE + "[periodic]\ncurves = []", r"periodic must be written \[\[periodic\]\]"),
        (SQUARE + "[[periodic]]\ncurves = ['A-B']", "periodic takes two curves"),
        (SQUARE + "[[periodic]]\ncurves = ['A-B', 'D-C']\nshift = [0, 1]", "unknown key 'shift' in periodic"),
        (SQUARE + "[[periodic]]\ncurves = ['A-B', 'D-C']\nrotation = 'x'", "rotation of periodic must be a finite"),
        (
            SQUARE + "[[periodic]]\ncurves = ['A-B', 'D-C']\ntranslation = [0, 2]",
            "connected nodes must be at one place",
        ),
        (with_curve("3"), "the curve bottom must have one of line, polyline, spline, arc, formula, section; came 3"),
        (with_curve('{ line = ["A", "X"] }'), "unknown point 'X' in the curve bottom: the points are A, B, C, D"),
        (with_curve('{ line = "AB" }'), "line of the curve bottom must be the names of two points"),
        (with_curve('{ line = ["A", "B"], spacing = 3 }'), "spacing of the curve bottom must be a law as text; came 3"),
        (with_curve('{ line = ["A", "B"], spcing = "x" }'), "unknown key 'spcing' in the curve bottom.*Did you mean"),
        (with_curve('{ line = ["A", "B"], spacing = "x" }'), "unknown law 'x' in the spacing"),
        (with_curve('{ polyline = [[0, 0], "B"] }'), "must begin and end with the name of a point"),
        (with_curve('{ polyline = ["A"] }'), "polyline of the curve bottom must be a list of points and pairs"),
        (with_curve('{ spline = ["A", [1, 0], "B"] }'), "places 1 and 2 are equal"),
        (with_curve('{ spline = "none.csv", ends = ["A", "B"] }'), "none.csv"),
        (with_curve('{ arc = ["A", "B"] }'), "center of the curve bottom must be two numbers"),
        (with_curve('{ arc = ["A", "B"], center = [0, 1] }'), "ends of the arc bottom must be equally far from its"),
        (with_curve('{ arc = ["A", "B"], center = [0.5, 1], clockwise = 1 }'), "must be true or false; came 1"),
        (with_curve('{ formula = ["t"], ends = ["A", "B"] }'), "formula of the curve bottom must be two formulas of t"),
        (
            with_curve('{ formula = ["t", "x"], ends = ["A", "B"] }'),
            "unknown name 'x' in the formula 'x'; known: pi, t",
        ),
        (with_curve('{ formula = ["t", "0/t"], ends = ["A", "B"] }'), "has no finite value at t = 0"),
        (with_curve('{ formula = ["t", "t"], ends = ["A", "B"] }'), "the curve bottom must end at the point B"),
        (with_curve('{ formula = ["t", "0"] }'), "ends of the curve bottom must be the names of two points"),
        (with_curve('{ section = "naca0012", ends = ["A", "B"] }'), "part of the section bottom must be 'lower' or"),
        (with_curve('{ section = "x.dat", part = "lower", ends = ["A", "B"] }'), "x.dat"),
    ],
)
def test_what_is_no_layout_is_told(tmp_path, text, told):
    with pytest.raises(gg.GridgenError, match=f"(?s){told}"):
        read(tmp_path, text)


def test_other_files_are_told(tmp_path):
    with pytest.raises(gg.GridgenError, match=r"expected a description \(.toml\) or a mesh of quadrilaterals"):
        gg.read_layout(tmp_path / "grid.xyz")
    with pytest.raises(
        gg.GridgenError, match=r"it describes a layout, which gridgen_sym\.read_layout reads; use one of"
    ):
        gg.read(EXAMPLES[0])
    with pytest.raises(gg.GridgenError, match=r"refine must be a whole number, at least 1 for .toml; came 0"):
        read(tmp_path, SQUARE, refine=0)


WALLED = SQUARE + '[boundaries]\nfloor = ["A-B"]\n[walls]\nfloor = {}\n'


def test_walls_are_those_of_boundaries(tmp_path):
    path = tmp_path / "layout.toml"
    path.write_text(WALLED.format("{ first = 0.01, growth = 1.2, layers = 2, orthogonal = false }"), encoding="utf-8")
    (name,), (wall,) = zip(*gg.read_walls(path).items(), strict=True)
    assert (name, wall.first, wall.growth, wall.layers, wall.orthogonal) == ("floor", 0.01, 1.2, 2, False)
    assert gg.read_layout(path).boundaries.keys() == {"floor"}
    assert set(gg.read_walls(EXAMPLES[2])) == {"wall"}
    assert gg.read_walls(EXAMPLES[0]) == {}
    with pytest.raises(gg.GridgenError, match=r"cannot read walls from .*x.mesh: expected a layout's description"):
        gg.read_walls("x.mesh")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (WALLED.format("{ first = -1 }"), "the wall floor: first of the wall must be a positive height"),
        (WALLED.format("{ growth = 1.2 }"), "the wall floor has no first"),
        (WALLED.format("{ first = 1, hight = 2 }"), "unknown key 'hight' in the wall floor"),
        (WALLED.format("0.01"), "the wall floor must be a table with first"),
        (WALLED.format("{ first = 1 }").replace("[walls]\nfloor", "[walls]\nroof"), "unknown boundary 'roof' in walls"),
    ],
)
def test_what_is_no_wall_is_told(tmp_path, text, told):
    with pytest.raises(gg.GridgenError, match=told):
        read(tmp_path, text)
