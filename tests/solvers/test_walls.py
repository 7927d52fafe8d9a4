"""Walls: first heights and right angles that were asked for, at aspect ratios of 1e5 and on grids of any size."""

import numpy as np
import pytest
from support_walls import channel, heights, nasa

import gridgen_sym as gg
from gridgen_sym.boundary.wall import walls_by_side
from gridgen_sym.fields.wall_cells import own_cells, wall_cells
from gridgen_sym.solvers.multilevel.nested import coarse_shapes
from gridgen_sym.solvers.multilevel.prolongation import coarse_start
from gridgen_sym.solvers.multilevel.wall_continuation import between
from gridgen_sym.solvers.multilevel.wall_prolongation import finer_grid


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_the_first_heights_and_right_angles_that_were_asked_for(backend):
    result = gg.optimize(channel(first=1e-5), walls={"bottom": gg.Wall(1e-5)}, functional="winslow", backend=backend)
    assert result.converged
    assert result.quality.valid
    height, off = heights(result.grid)
    np.testing.assert_allclose(height, 1e-5, rtol=0.01)
    assert off.max() < 1.0


@pytest.mark.parametrize("law", ["geometric", "tanh", "sinh"])
def test_every_law_keeps_the_heights(law):
    result = gg.optimize(channel(first=1e-4), "winslow", walls={"bottom": gg.Wall(1e-4, law=law)})
    assert result.converged
    np.testing.assert_allclose(heights(result.grid)[0], 1e-4, rtol=0.02)


def test_heights_that_vary_along_the_wall():
    start = channel(first=1e-4)
    first = np.geomspace(1e-4, 4e-4, start.shape[0])
    result = gg.optimize(start, "winslow", walls={"bottom": gg.Wall(first)})
    np.testing.assert_allclose(heights(result.grid)[0][2:-2], first[3:-3], rtol=0.02)


def test_growth_that_reaches_the_other_side_is_kept():
    result = gg.optimize(channel(33, 33), "winslow", walls={"bottom": gg.Wall(2e-3, growth=1.25)})
    y = result.grid.xy[16, :, 1]
    step = np.diff(y)
    np.testing.assert_allclose(step[1:8] / step[:7], 1.25, rtol=0.03)
    np.testing.assert_allclose(step[-1] / step[-2], 1, rtol=0.03)


def test_two_walls_have_their_own_heights():
    walls = {"bottom": gg.Wall(1e-4), "top": gg.Wall(1e-3)}
    result = gg.optimize(channel(41, 41), "winslow", walls=walls)
    assert result.quality.valid
    np.testing.assert_allclose(heights(result.grid)[0][3:-3], 1e-4, rtol=0.02)
    np.testing.assert_allclose(heights(result.grid, "top")[0][3:-3], 1e-3, rtol=0.02)


def test_walls_at_left_are_walls_at_bottom_seen_from_the_side():
    start = channel(first=1e-4)
    turned = gg.Grid(start.xy.swapaxes(0, 1)[::-1] * [1, 1])
    turned = gg.Grid.from_planes(start.y.T, start.x.T)
    bottom = gg.optimize(start, "winslow", walls={"bottom": gg.Wall(1e-4)}).grid
    left = gg.optimize(turned, "winslow", walls={"left": gg.Wall(1e-4)}).grid
    np.testing.assert_allclose(left.x.T, bottom.y, atol=1e-9)


def test_a_part_of_a_side_is_a_wall():
    result = gg.optimize(channel(), "winslow", walls={"bottom": gg.Wall(1e-3, nodes=(10, 31))})
    height = np.hypot(*(result.grid.xy[:, 1] - result.grid.xy[:, 0]).T)
    np.testing.assert_allclose(height[10:31], 1e-3, rtol=0.02)
    # Beside it heights pass to those of the ends.
    assert (np.diff(height[30:]) > 0).all()


def test_the_start_is_the_minimum_for_its_own_cells():
    start = channel(17, 13)
    own = own_cells(start.planes)
    cells = wall_cells(walls_by_side({"bottom": gg.Wall(1e-3)}), start.planes, start.shape)
    at_start = between(own, cells, 0.0)
    target = gg.Target.matrix(at_start.matrix())
    assert np.abs(gg.gradient(start, "winslow", target=target)).max() < 1e-9
    np.testing.assert_allclose(between(own, cells, 1.0).along_eta, cells.along_eta)


def test_the_law_is_evaluated_on_coarse_grids():
    start = channel(65, 65, first=1e-5)
    walls = walls_by_side({"bottom": gg.Wall(1e-5)})
    fine = wall_cells(walls, start.planes, start.shape)
    for shape in coarse_shapes(start.shape):
        coarse = wall_cells(walls, coarse_start(start.planes, shape), start.shape)
        step = 64 // (shape[1] - 1)
        np.testing.assert_allclose(coarse.eta, fine.eta[:: 64 // (shape[0] - 1), ::step], rtol=1e-9, atol=1e-12)


def test_a_finer_grid_starts_with_the_heights():
    start = channel(65, 65, first=1e-5)
    walls = walls_by_side({"bottom": gg.Wall(1e-5)})
    coarse = coarse_start(start.planes, (33, 33))
    cells = wall_cells(walls, coarse, start.shape)
    solved = gg.optimize(gg.Grid.from_planes(*coarse), "winslow", target=gg.Target.of_cells(cells), tolerance=1e-4).grid
    found = finer_grid(solved.planes, cells, start.planes, wall_cells(walls, start.planes, start.shape))
    grid = gg.Grid.from_planes(*found)
    assert gg.quality(grid).valid
    np.testing.assert_allclose(heights(grid)[0], 1e-5, rtol=0.05)


def test_every_solver_takes_walls():
    start, walls = channel(25, 17), {"bottom": gg.Wall(5e-3)}
    solved = gg.optimize(start, "winslow", walls=walls).grid
    assert gg.energy(solved, "winslow", walls=walls) < gg.energy(start, "winslow", walls=walls)
    assert gg.gradient(solved, "winslow", walls=walls).shape == (25, 17, 2)
    assert gg.hessian(solved, "winslow", walls=walls).shape == (2 * 23 * 15, 2 * 23 * 15)
    swept = gg.optimize(start, "winslow", "local", walls=walls, max_iterations=400).grid
    # Only Newton's method corrects the heights where a wall is short of nodes.
    np.testing.assert_allclose(heights(swept)[0][4:-4], heights(solved)[0][4:-4], rtol=0.05)
    equations = gg.solve_euler_lagrange(start, "winslow", walls=walls)
    assert equations.converged
    assert equations.quality.valid


@pytest.mark.parametrize(
    ("walls", "match"),
    [
        ({"below": gg.Wall(1e-3)}, "unknown side 'below' in walls: the sides are bottom, right, top, left"),
        ({"bottom": 1e-3}, "the wall of the side bottom must be a Wall"),
        (gg.Wall(1e-3), "walls must map sides to walls"),
        ({"bottom": gg.Wall([1e-3, 1e-3])}, r"first of the wall must be a number or have one value per node"),
        ({"bottom": gg.Wall(1e-3, nodes=(5, 90))}, "nodes of the wall must be two numbers"),
        (
            {"bottom": gg.Wall(1e-300)},
            "first of the wall at bottom is 1e-300, but coordinates of this size",
        ),
        ({"bottom": gg.Wall(2.0)}, "the first cell of line 0 has 2.00001 of the line's length"),
    ],
)
def test_walls_that_cannot_be_are_refused(walls, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.optimize(channel(), "winslow", walls=walls)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ((0.0,), "first of the wall must be a positive height"),
        ((1e-3, -1.2), "growth of the wall must be a positive factor"),
        ((1e-3, None, "cubic"), "the law of the wall must be one of geometric, tanh, sinh"),
        ((1e-3, None, "geometric", 5), "layers and share of the wall belong to a growth"),
        ((1e-3, 1.2, "geometric", 5, 0.5), "layers and share of the wall say the same thing"),
        ((1e-3, 1.2, "geometric", None, 1.5), "share of the wall must be between 0 and 1"),
        ((1e-3, 1.2, "geometric", None, "half"), "share of the wall must be between 0 and 1; came 'half'"),
        ((1e-3, 1.2, "geometric", 1.5), "layers of the wall must be a whole number of cells; came 1.5"),
        ((1e-3, 1.2, "geometric", -3), "layers of the wall must be a whole number of cells"),
        ((np.array([1e-3, np.nan]),), "first of the wall must be a positive height"),
        ((1e-3, None, "geometric", None, None, True, (1.5, 9)), "nodes of the wall must be two numbers of nodes"),
        ((1e-3, None, "geometric", None, None, True, 3), "nodes of the wall must be two numbers of nodes; came 3"),
    ],
)
def test_what_is_no_wall_is_refused(arguments, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.Wall(*arguments)


def test_walls_and_a_target_exclude_each_other():
    with pytest.raises(gg.GridgenError, match="walls become a target: give walls or a target, not both"):
        gg.optimize(channel(), "winslow", walls={"bottom": gg.Wall(1e-3)}, target=gg.Target(1, 1))


def test_the_first_height_of_a_yplus():
    # Re = 1e6: c_f = 0.00375, u_tau = 0.0433 U, y = 1/(1e6 * 0.0433).
    assert gg.first_height(1e6) == pytest.approx(2.31e-5, rel=2e-3)
    assert gg.first_height(1e6, yplus=30, length=2) == pytest.approx(60 * gg.first_height(1e6))
    with pytest.raises(gg.GridgenError, match="reynolds must be a positive number"):
        gg.first_height(-1)


@pytest.mark.parametrize(
    ("name", "wall", "off_normal", "most"),
    [
        ("n0012_113-33", (26, 87), 1.2, 95),
        ("n4412_225-65", (50, 175), 0.7, 110),
        ("bump_3levelsdown_177x81", (2, 175), 0.05, 45),
        ("flatplate_clust2_3levelsdown_69x49", (2, 67), 0.01, 30),
    ],
)
def test_the_heights_of_real_grids_from_their_boundary_alone(name, wall, off_normal, most):
    start, first = nasa(name)
    steps = []
    result = gg.optimize(start, "winslow", walls={"bottom": gg.Wall(first)}, callback=steps.append)
    assert sum(step.iteration > 0 for step in steps) <= most  # On all grids.
    assert result.converged
    assert result.quality.valid
    height, off = heights(result.grid)
    at = slice(wall[0] - 1, wall[1] - 1)
    wrong = np.abs(height / first[1:-1] - 1)[at]
    assert np.percentile(wrong, 99) < 0.01
    assert np.percentile(off[at], 95) < off_normal


def test_a_side_that_is_spaced_otherwise_than_its_wall_is_told():
    told = gg.optimize(channel(25, 17), "winslow", walls={"bottom": gg.Wall(1e-3)})
    assert "those of left begin with 0.0" in told.message
    assert "where bottom asks for 0.001" in told.message
    quiet = gg.optimize(channel(25, 17, first=1e-3), "winslow", walls={"bottom": gg.Wall(1e-3)})
    assert "Boundary nodes stay" not in quiet.message


@pytest.mark.parametrize("steps", [1, 25, 60])
@pytest.mark.parametrize("stop", [StopIteration, KeyboardInterrupt, ValueError])
def test_an_interrupted_run_gives_a_valid_grid(steps, stop):
    seen = []

    def callback(step):
        seen.append(step)
        if len(seen) == steps:
            raise stop

    start, walls = channel(33, 33), {"bottom": gg.Wall(1e-4)}
    try:
        result = gg.optimize(start, "winslow", walls=walls, callback=callback)
    except ValueError as error:
        result = error.result
    assert result.interrupted
    assert result.quality.valid
    assert result.change.after.wall_factors["bottom"] <= 1.01 * result.change.before.wall_factors["bottom"]


@pytest.mark.parametrize("shape", [(3, 3), (3, 40), (40, 3)])
@pytest.mark.parametrize("slide", [None, "all"])
def test_the_smallest_grids(shape, slide):
    result = gg.optimize(channel(*shape), "winslow", walls={"bottom": gg.Wall(1e-2)}, slide=slide)
    assert result.converged
    assert result.quality.valid


def test_walls_at_all_sides_that_slide():
    walls = {side: gg.Wall(1e-3) for side in ("bottom", "right", "top", "left")}
    result = gg.optimize(channel(33, 25), "winslow", walls=walls, slide="all")
    assert result.converged
    assert result.quality.valid
    assert max(result.change.after.wall_factors.values()) < 1.05
    assert "First heights differ" not in result.message


def test_a_folded_start_with_walls_that_slides():
    xy = channel().xy
    xy[10:14, 5:9] = xy[20:24, 5:9][::-1]
    result = gg.optimize(gg.Grid(xy), "winslow", walls={"bottom": gg.Wall(1e-3)}, slide=("left", "right"))
    assert result.converged
    assert result.quality.valid
    assert result.change.after.wall_factors["bottom"] < 1.02
