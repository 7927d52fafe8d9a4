"""Boundary nodes that slide round several blocks: known answers, and what stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from layouts import assembled, cut

import gridgen_sym as gg
from gridgen_sym.boundary.slide_curve import SlideCurve, chord_fractions
from gridgen_sym.solvers.layout.slide_choice import make_layout_slide
from gridgen_sym.solvers.sliding.side import SlidingSide
from gridgen_sym.topology.directions import direction_groups
from gridgen_sym.topology.lines import Lines

LINES = (0, 6, 16), (0, 10, 16)
FOUR = gg.Grid(np.stack(np.meshgrid(*[np.linspace(0, 1, 17)] * 2, indexing="ij"), axis=-1))


def arc(radius, angle=np.pi / 2):
    """A part of a circle from `angle` back to the x axis; it may be a whole one."""
    return lambda t: radius * np.stack([np.cos(angle * (1 - np.asarray(t))), np.sin(angle * (1 - np.asarray(t)))], -1)


QUARTER = {
    "bottom": arc(1),
    "top": arc(2),
    "left": lambda t: np.stack([0 * t, 1 + t], -1),
    "right": lambda t: np.stack([1 + t, 0 * t], -1),
}


def uneven_quarter():
    """A quarter of an annulus whose boundary nodes are far from where they belong."""
    u = np.linspace(0, 1, 17)
    v = u + np.sin(2 * np.pi * u) / 40
    return gg.transfinite(**{side: QUARTER[side](t) for side, t in zip(QUARTER, (v, u**1.1, v, u), strict=True)})


def with_sides(layout):
    """Blocks of `cut` whose boundaries have the names of the sides of the whole."""
    last = layout.names[-1].split("-")
    on = {"bottom": (1, "0"), "right": (0, last[0]), "top": (1, last[1]), "left": (0, "0")}
    parts = {
        side: [(name, side) for name in layout.names if name.split("-")[axis] == at] for side, (axis, at) in on.items()
    }
    return gg.MultiBlock(dict(zip(layout.names, layout.blocks, strict=True)), boundaries=parts)


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("apart", [{}, {"fixed": {}}], ids=["put together", "apart"])
def test_cut_is_uncut(apart, backend):
    start = with_sides(cut(uneven_quarter(), *LINES))
    found = gg.optimize(start, "winslow", slide=QUARTER, tolerance=1e-12, backend=backend, **apart)
    assert found.converged
    assert found.iterations <= 7  # Newton's method sees how the curves bend.
    x, y = assembled(found.grid, *LINES)
    u = np.linspace(0, 1, 17)
    np.testing.assert_allclose(np.hypot(x, y), np.broadcast_to(2**u, x.shape), atol=1e-11)
    np.testing.assert_allclose(np.arctan2(y, x), np.broadcast_to(np.pi / 2 * (1 - u[:, None]), x.shape), atol=1e-11)


SIDES = [("0-0", "left"), ("0-1", "left"), "right"]


@pytest.mark.parametrize("slide", ["all", SIDES])
def test_cut_is_uncut_on_own_curves(slide):
    start = uneven_quarter()
    of_one = ("left", "right") if slide is SIDES else slide
    one = gg.optimize(start, "winslow", slide=of_one, tolerance=1e-10).grid
    found = gg.optimize(with_sides(cut(start, *LINES)), "winslow", slide=slide, fixed={}, tolerance=1e-10).grid
    np.testing.assert_allclose(assembled(found, *LINES), one.planes, atol=1e-8)
    assert np.abs(one.planes - gg.optimize(start, "winslow").grid.planes).max() > 1e-3


def test_blocks_that_are_one_are_solved_as_that():
    """Also in that other nodes come to hold the sharp turns of the swan; a part of a side is for the other solver."""
    start = gg.domain("swan", 9, 9)
    lines = (0, 2, 8), (0, 4, 8)
    one = gg.optimize(start, "winslow", slide="all")
    found = gg.optimize(with_sides(cut(start, *lines)), "winslow", slide="all")
    assert np.array_equal(assembled(found.grid, *lines), one.grid.planes)
    assert found.message == one.message
    part = gg.optimize(with_sides(cut(start, *lines)), "winslow", slide=("1-0", "bottom"))
    moved = (assembled(part.grid, *lines) != start.planes).any(axis=0)
    moved[1:-1, 1:-1] = False
    assert {(i, j) for i, j in np.argwhere(moved)} <= {(i, 0) for i in range(3, 8)}


def test_cut_is_uncut_with_walls():
    lines, wall = ((0, 6, 12), (0, 16)), gg.Wall(first=0.02)
    start = gg.domain("quarter_annulus", 13, 17)
    one = gg.optimize(start, "winslow", walls={"bottom": wall}, slide=("left", "right")).grid
    blocks = with_sides(cut(start, *lines))
    found = gg.optimize(blocks, "winslow", walls={"bottom": wall}, slide=("left", "right")).grid
    np.testing.assert_allclose(assembled(found, *lines), one.planes, atol=1e-7)


def o_grid(around=48, outwards=12):
    """An O-grid between circles of radii 1 and 2, the outer nodes of which are far from where they belong."""
    angle, part = np.linspace(0, 2 * np.pi, around + 1), np.linspace(0, 1, outwards + 1)
    inner, outer = np.exp(-1j * angle), 2 * np.exp(-1j * (angle + 0.3 * np.sin(angle) + 0.1))
    nodes = inner[:, None] * (1 - part) + outer[:, None] * part
    nodes[-1] = nodes[0]
    ends = gg.Connection(("ring", "left"), ("ring", "right"))
    return gg.MultiBlock(
        {"ring": gg.Grid.from_planes(nodes.real, nodes.imag)}, [ends], boundaries={"outer": [("ring", "top")]}
    )


@pytest.mark.parametrize(
    ("curve", "error"),
    [
        (None, 2e-5),
        (arc(2, 2 * np.pi), 1e-10),
        (lambda t: arc(2, 2 * np.pi)(t + 0.3)[::1], 1e-10),
        (arc(2, -2 * np.pi)(np.linspace(0, 1, 401)), 1e-7),
    ],
    ids=["own", "function", "from elsewhere", "points, the other way"],
)
def test_the_outer_circle_of_an_o_grid_slides_all_round(curve, error):
    """The inner circle stays, and every outer node comes to stand above its inner one, also that on the cut."""
    found = gg.optimize(o_grid(), "winslow", slide={"outer": curve}, tolerance=1e-10)
    assert found.converged
    x, y = found.grid["ring"].planes
    nodes = x + 1j * y
    np.testing.assert_allclose(np.angle(nodes[:, -1] / nodes[:, 0]), 0, atol=error)
    np.testing.assert_allclose(np.abs(nodes[:, -1]), 2, atol=error)


def test_nodes_slide_from_block_to_block_and_corners_of_the_domain_stay():
    start = with_sides(cut(gg.Grid(FOUR.xy + 0.05 * np.sin(np.pi * FOUR.xy[..., ::-1]) * FOUR.xy), *LINES))
    slide = make_layout_slide(start, "all")
    assert [len(line.at) for line in slide.lines] == [17] * 4
    assert sorted(side.free.sum() for side in slide.slide.sides) == [15] * 4
    between = start.names.index("0-0"), 6, 0
    assert between in set(zip(slide.copies.block, slide.copies.i, slide.copies.j, strict=True))
    found = gg.optimize(start, "winslow", slide="all").grid
    before, after = (assembled(layout, *LINES) for layout in (start, found))
    np.testing.assert_array_equal(after[:, ::16, ::16], before[:, ::16, ::16])
    assert np.abs(after - before)[:, 6, 0].max() > 1e-4
    assert (np.diff(after[0][:, 0]) > 0).all()


def test_sharp_turns_and_ends_of_what_slides_stay():
    """The wall of the step turns at its edge, where two blocks meet, and at its foot, a corner of the domain."""
    sides = make_layout_slide(gg.layout("step"), "wall").slide.sides
    held = [np.round(side.curve.point(side.at[~side.free]), 12).tolist() for side in sides]
    assert held == [[[-3, 1], [0, 1], [0, 0]], [[9, 2], [-3, 2]], [[0, 0], [9, 0]]]


def test_periodic_nodes_stay():
    sector = gg.layout("sector", around=8, outwards=4)
    moved = sector.moved([grid.planes for grid in sector.blocks])
    slide = make_layout_slide(moved, "all")
    assert [(len(side.at), int(side.free.sum())) for side in slide.slide.sides] == [(9, 7)] * 2


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_nodes_that_slide_untangle_what_else_is_impossible(backend):
    """The bend whose inner nodes crowd at its beginning, and outer ones at its end; see test_sliding_untangling.py."""
    u, v, angle = np.linspace(0, 1, 9), np.linspace(0, 1, 3)[:, None], 1.5 * np.pi
    inner, outer = arc(1, angle)(u**3), arc(2, angle)(1 - (1 - u) ** 3)
    left, right = (inner[end] + v * (outer[end] - inner[end]) for end in (0, -1))
    start = with_sides(cut(gg.transfinite(bottom=inner, top=outer, left=left, right=right), (0, 3, 8), (0, 2)))
    curves = {"bottom": arc(1, angle), "top": arc(2, angle)}
    for fixed in (None, {}):
        found = gg.untangle(start, slide=curves, fixed=fixed, backend=backend)
        assert found.converged
        assert found.quality.valid
        x, y = assembled(found.grid, (0, 3, 8), (0, 2))
        np.testing.assert_allclose(np.hypot(x, y)[:, ::2], np.broadcast_to([1, 2], (9, 2)), atol=1e-12)


def test_boundary_nodes_stay_where_that_is_enough_to_untangle():
    start = gg.layout("pipe", across=4, outwards=4)
    planes = [np.array(grid.planes) for grid in start.blocks]
    planes[0][:, 2, 2] = 0.9
    found = gg.untangle(start.moved(planes), slide="wall")
    assert found.converged
    for before, after, outer in zip(start.blocks, found.grid.blocks, start.outer, strict=True):
        np.testing.assert_allclose(after.planes[:, outer], before.planes[:, outer], atol=1e-14)


def test_a_valid_layout_is_returned_as_it_is():
    start = gg.layout("annulus", around=12, outwards=4)
    found = gg.untangle(start, slide={"outer": lambda t: 1.001 * arc(2, 2 * np.pi)(t)})
    assert np.array_equal(found.grid["ring"].planes, start["ring"].planes)


def test_nodes_keep_their_order_round_a_closed_curve():
    points = arc(1, 2 * np.pi)(np.linspace(0, 1, 25))
    curve = SlideCurve.round_points(points)
    side = SlidingSide("ring", (np.arange(25) % 24,), curve, chord_fractions(points))
    random = np.random.default_rng(0)
    for size in (0.01, 0.2, 2.0):
        wanted = side.with_free(side.at[:-1] + size * random.normal(size=24))
        found = side.in_order(wanted)
        assert found[-1] == pytest.approx(found[0] + 1)
        assert (np.diff(found) > 0.1 * np.diff(side.at) * (1 - 1e-9)).all()
    near = side.with_free(side.at[:-1] + 0.3)  # All round, and across where the parameter begins again.
    np.testing.assert_allclose(side.in_order(near), near, rtol=1e-13)
    np.testing.assert_allclose(curve.point(side.at + 7), curve.point(side.at), atol=1e-12)


def test_coarse_layouts_have_every_second_sliding_node():
    grid = o_grid()
    slide = make_layout_slide(grid, "all")
    lines = Lines.of(grid.bonds, direction_groups(grid.bonds, 1), [(49, 13)])
    half = slide.coarsened(lines.coarsening(lines.groups(1, 1), 1))
    assert half.shapes == ((25, 7),)
    for side, line in zip(half.slide.sides, half.lines, strict=True):
        assert side.at[-1] == side.at[0] + 1
        nodes = grid["ring"].xy[::2, ::2][line.places[1], line.places[2]]
        np.testing.assert_allclose(side.curve.point(side.at), nodes, atol=1e-12)
    assert (len(half.copies.starts), len(half.copies.block)) == (2 * 24, 2 * 24 + 2)


@pytest.mark.parametrize(
    ("slide", "match"),
    [
        ("below", "unknown boundary 'below' in slide; the boundaries are: bottom, right, top, left; a side is named"),
        (3, "slide must be 'all', names of boundaries, sides such as"),
        (("0-0", "right"), "right of block 0-0 cannot slide: all of it is connected"),
        (["left", ("0-0", "left")], "left of block 0-0 slides twice"),
        ([("x", "left")], "unknown block 'x'"),
        ({"all": arc(1)}, "the boundary all consists of 4 parts between corners, and one curve is given"),
        ({"bottom": [[0, 0], [5, 0]]}, "the curve of the boundary bottom must begin and end at the corners"),
    ],
)
def test_what_cannot_slide_is_refused(slide, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.optimize(with_sides(cut(FOUR, *LINES)), "winslow", slide=slide)


@pytest.mark.parametrize(
    ("curve", "match"),
    [
        (arc(2), "the curve of the boundary outer must end where it begins"),
        (arc(2.5, 2 * np.pi), "the nodes of the boundary outer must lie on its curve"),
        ([[2, -2], [2, 2], [-2, 2], [-2, -2], [2, -2]], "must be smooth all round"),
    ],
)
def test_the_curve_of_a_closed_boundary_is_closed_and_smooth(curve, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.optimize(o_grid(12, 4), "winslow", slide={"outer": curve})


def test_results_say_where_edges_cut_off_bends():
    """Few nodes round a section crowd at its nose, or leave it to one edge; the message names the boundary."""
    slide = make_layout_slide(o_grid(24, 6), "outer")
    (line,) = slide.lines
    coarse = replace(line, places=line.places[:, [0, 8, 16, 24]], at=line.at[[0, 8, 16, 24]])
    few = type(slide)([coarse], o_grid(24, 6).copies, slide.shapes)
    grid = o_grid(24, 6)["ring"]
    assert "Edges at outer cut off bends" in few.caution(grid.planes.ravel())
    assert slide.caution(grid.planes.ravel()) == ""
