"""Walls through the equations: known control functions, every side, heights and angles, and how it ends otherwise."""

from dataclasses import replace

import numpy as np
import pytest
from support import kernel_set, observed_order
from support_walls import channel, heights, nasa

import gridgen_sym as gg
from gridgen_sym.boundary.laws import geometric, two_ended
from gridgen_sym.boundary.wall import walls_by_side
from gridgen_sym.fields.wall_cells import wall_cells
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.equations.algebraic_grid import holding_controls, law_controls, law_grid, line_fractions
from gridgen_sym.solvers.equations.control import Controlled
from gridgen_sym.solvers.equations.residual import Equations
from gridgen_sym.solvers.equations.wall_controls import Relaxed, seen_from, wall_controls
from gridgen_sym.solvers.equations.wall_iteration import Background
from gridgen_sym.solvers.run.checks import fixed_mask

SIDES = ("bottom", "right", "top", "left")


def solve(start, walls, **options):
    return gg.solve_euler_lagrange(
        start, "winslow", control="hilgenstock-white", walls=walls, progress=False, **options
    )


def equations(grid):
    problem = make_problem(grid, "winslow")
    return Equations(problem, Controlled(kernel_set("winslow", "control"), np.zeros_like(grid.planes)))


def rectangle(ni=9, nj=13, first=1e-2):
    """A rectangle of 2 x 1 whose lines are geometric along eta, and their ratio."""
    fractions = geometric(first, nj - 1)[0]
    x, y = np.meshgrid(2 * np.linspace(0, 1, ni), fractions, indexing="ij")
    return gg.Grid(np.stack([x, y], axis=-1)), (fractions[2] - fractions[1]) / first


def test_the_control_functions_of_a_geometric_law_are_known():
    """Central differences of lengths 1, r, r², ...: Q = -(2/h) (r - 1)/(r + 1) everywhere, and P = 0."""
    grid, ratio = rectangle()
    expected = np.zeros_like(grid.planes)
    expected[1] = -2 * 12 * (ratio - 1) / (ratio + 1)
    assert np.abs(holding_controls(equations(grid), grid.planes) - expected).max() < 1e-10
    law = law_controls(grid.planes, line_fractions(grid.planes), None, (1 / 8, 1 / 12))
    assert np.abs(law - expected).max() < 1e-10


def test_the_control_functions_of_an_annulus_are_known():
    """Radii R(eta) at even angles: Q = -R''/R' + R'/R (angle)², here with R = exp(2 eta) and an angle of 1: Q = 0.

    With R' instead of R in the last term: r = 1 + eta has Q = 1/(1 + eta).
    """
    errors = []
    for n in (11, 21):
        xi, eta = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
        for radius, expected in ((np.exp(2 * eta), 0 * eta), (1 + eta, 1 / (1 + eta))):
            grid = gg.Grid(np.stack([radius * np.sin(xi), radius * np.cos(xi)], axis=-1)[::-1])
            p, q = holding_controls(equations(grid), grid.planes)[:, 1:-1, 1:-1]
            errors.append(max(np.abs(p).max(), np.abs(q - expected[1:-1, 1:-1]).max()))
    assert observed_order(errors[0], errors[2]) > 1.8
    assert observed_order(errors[1], errors[3]) > 1.8


def test_a_grid_solves_the_equations_that_it_is_held_by():
    start = channel(17, 13)
    held = equations(start)
    planes = holding_controls(held, start.planes)
    assert np.abs(planes).max() > 0.5
    before = np.abs(held.residual(start.planes)).max()
    held.controlled = replace(held.controlled, planes=planes)
    assert np.abs(held.residual(start.planes)).max() < 1e-12 * before


def test_the_law_of_a_rectangle_is_met_at_once():
    grid, _ = rectangle()
    moved = grid.xy
    moved[1:-1, 1:-1] += 0.004 * np.random.default_rng(0).normal(size=moved[1:-1, 1:-1].shape)
    result = solve(gg.Grid(moved), {"bottom": gg.Wall(1e-2)})
    assert result.converged
    assert np.abs(result.grid.xy - grid.xy).max() < 1e-11


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_heights_and_right_angles_come_out(backend):
    start = channel(25, 17, first=1e-3)
    result = solve(start, {"bottom": gg.Wall(1e-3)}, backend=backend)
    assert result.converged, result.message
    assert result.quality.valid
    height, off = heights(result.grid)
    np.testing.assert_allclose(height, 1e-3, rtol=1e-3)
    assert off.max() < 0.11  # 0.1 degrees, and what the ends of the wall lean.
    assert "updates of the control functions" in result.message
    assert result.change.after.wall_factors["bottom"] < 1.001
    assert np.array_equal(result.grid.xy[:, [0, -1]], start.xy[:, [0, -1]])


def test_it_is_the_solution_of_the_controlled_equations():
    """Control functions read off the result give it back, from another start."""
    result = solve(channel(25, 17, first=1e-2), {"bottom": gg.Wall(1e-2)})
    planes = holding_controls(equations(result.grid), result.grid.planes)
    again = gg.solve_euler_lagrange(result.grid, "winslow", control=tuple(planes), progress=False)
    assert np.abs(again.grid.xy - result.grid.xy).max() < 1e-9
    # They change no more than smoothly along the wall: nothing of the transfinite lines' kinks is left.
    assert np.abs(np.diff(planes[1, 3:-3, 4])).max() < 0.3 * np.abs(planes[1]).max()


def half_turned(xy):
    """Turn a grid by 180 degrees, with both of its coordinates: its bottom becomes the top."""
    return -xy[::-1, ::-1]


def mirrored(xy):
    """Exchange x and y, and xi and eta: the bottom becomes the left."""
    return xy.swapaxes(0, 1)[..., ::-1]


@pytest.mark.parametrize(
    ("side", "moves"), [("top", (half_turned,)), ("left", (mirrored,)), ("right", (mirrored, half_turned))]
)
def test_every_side_can_be_the_wall(side, moves):
    start, first = channel(21, 15).xy, np.linspace(1e-2, 2e-2, 21)
    start = gg.Grid(start + [0.2, 0] * start[..., 1:])  # Sheared, so that no symmetry hides a sign.
    expected = solve(start, {"bottom": gg.Wall(first)})
    xy = start.xy
    for move in moves:
        xy = move(xy)
    found = solve(gg.Grid(xy), {side: gg.Wall(first if side == "left" else first[::-1])})
    assert expected.converged
    assert found.converged
    xy = found.grid.xy
    for move in moves:
        xy = move(xy)
    assert np.abs(xy - expected.grid.xy).max() < 1e-7  # Linear systems are solved to a part.


def test_two_walls_and_arrays_of_heights():
    start, first = channel(25, 25), np.geomspace(4e-3, 1e-2, 25)
    result = solve(start, {"bottom": gg.Wall(first), "top": gg.Wall(1e-2)})
    assert result.converged, result.message
    np.testing.assert_allclose(heights(result.grid)[0], first[1:-1], rtol=1e-3)
    np.testing.assert_allclose(heights(result.grid, "top")[0], 1e-2, rtol=1e-3)


def test_four_walls():
    low = channel(29, 25).xy
    across, along = two_ended(2e-2, 2e-2, 24)[0], 3 * two_ended(1e-2, 1e-2, 28)[0]
    bottom, top = (np.stack([along, np.interp(along, low[:, k, 0], low[:, k, 1])], -1) for k in (0, -1))
    left, right = (np.stack([np.full(25, x), y + across * (1 - y)], -1) for x, y in (bottom[0], bottom[-1]))
    start = gg.transfinite(bottom, top, left, right)
    walls = dict.fromkeys(("bottom", "top"), gg.Wall(2e-2)) | dict.fromkeys(("left", "right"), gg.Wall(3e-2))
    result = solve(start, walls)
    assert result.converged, result.message
    for side, first in (("bottom", 2e-2), ("top", 2e-2), ("left", 3e-2)):
        height, off = heights(result.grid, side)
        np.testing.assert_allclose(height, first, rtol=1e-3)
        assert off[1:-1].max() < 0.2


def test_a_part_of_a_side_is_a_wall():
    result = solve(channel(25, 17), {"bottom": gg.Wall(5e-3, nodes=(8, 17))})
    assert result.converged, result.message
    height, off = heights(result.grid)
    np.testing.assert_allclose(height[7:16], 5e-3, rtol=1e-3)
    assert off[7:16].max() < 0.1
    assert (np.diff(height[16:]) > 0).all()


def test_a_wall_that_is_not_orthogonal_keeps_the_heights_alone():
    start, walls = channel(25, 17, first=1e-2), {"bottom": gg.Wall(1e-2, orthogonal=False)}
    result = solve(start, walls)
    assert result.converged
    height, off = heights(result.grid)
    np.testing.assert_allclose(height, 1e-2, rtol=1e-3)
    assert off.max() > 3


def test_the_sign_of_control_is_toward_the_wall():
    """Too high cells call for control toward the wall, leaning lines for control against it, at every side."""
    start = rectangle(9, 9)[0]
    walls = walls_by_side({side: gg.Wall(0.05) for side in SIDES})
    cells = wall_cells(walls, start.planes, start.shape)
    xy = start.xy
    xy[1:-1, 1:-1] += [0.03, 0.02]
    tall = gg.Grid(xy).planes
    fixed = fixed_mask(start, None)
    for wall in wall_controls(walls, start.planes, cells, (1 / 8, 1 / 8), fixed):
        errors, planes = wall.errors(tall), np.zeros_like(tall)
        wall.aim(tall, accelerate=False)
        wall.add_to(planes, 1.0)
        across, along = planes[::-1] if wall.side in ("bottom", "top") else planes
        toward = -1 if wall.side in ("bottom", "left") else 1
        inner = (seen_from(wall.side, plane)[wall.index, 0] for plane in (across, along))
        assert (np.sign(next(inner)) == toward * np.sign(errors[0])).all()
        assert (np.sign(next(inner)) == -np.sign(errors[1])).all()
        assert (errors[1] > 0).all()  # All were moved toward larger xi and eta.


def test_smooth_control_functions_are_those_of_the_law_whatever_the_start():
    start, wanted = rectangle(first=3e-2)[0], rectangle(first=1e-2)[0]
    cells = wall_cells(walls_by_side({"bottom": gg.Wall(1e-2)}), start.planes, start.shape)
    background = Background.of(equations(start), start.planes, cells)
    held = equations(wanted)
    np.testing.assert_allclose(background.smooth, holding_controls(held, wanted.planes), atol=1e-9)
    np.testing.assert_allclose(background.at(0.0), holding_controls(held, start.planes), atol=1e-9)


@pytest.mark.parametrize("lean", [0.5, -0.5])
def test_right_angles_begin_beside_the_corners_of_the_block(lean):
    """At the corners of a parallelogram lines lean, and the angles that are asked for pass from there to right ones."""
    grid = rectangle(33, 9)[0]
    start = gg.Grid(grid.xy + [lean, 0] * grid.xy[..., 1:])
    walls = walls_by_side({"bottom": gg.Wall(1e-2)})
    cells = wall_cells(walls, start.planes, start.shape)
    wall = wall_controls(walls, start.planes, cells, (1 / 32, 1 / 8), fixed_mask(start, None))[0]
    corner = np.arctan(lean)
    np.testing.assert_allclose(wall.tilt[[0, -1]], corner * np.exp(-0.5), rtol=1e-6)
    assert np.abs(wall.tilt[15]) < 1e-3 * abs(corner)
    result = solve(start, {"bottom": gg.Wall(1e-2)})
    assert result.converged


def test_factors_are_those_of_aitken():
    """For errors that are linear in the control, the second factor meets the solution."""
    control = Relaxed(np.zeros(2), gain=1.0)
    for _ in range(3):
        control.aim(0.3 * (control.values - 1), accelerate=True)
        control.accept(1.0)
    np.testing.assert_allclose(control.values, 1.0, rtol=1e-12)


def test_an_algebraic_grid_has_the_heights_of_the_walls():
    start = channel(33, 25)
    walls = walls_by_side({"bottom": gg.Wall(1e-4), "top": gg.Wall(1e-3)})
    found = law_grid(start.planes, wall_cells(walls, start.planes, start.shape))
    grid = gg.Grid.from_planes(*found)
    assert gg.quality(grid).valid
    assert np.array_equal(found[:, :, [0, -1]], start.planes[:, :, [0, -1]])
    assert np.array_equal(found[:, [0, -1]], start.planes[:, [0, -1]])
    np.testing.assert_allclose(heights(grid)[0], 1e-4, rtol=1e-6)
    np.testing.assert_allclose(heights(grid, "top")[0], 1e-3, rtol=1e-6)


def test_a_limit_gives_the_best_valid_grid_and_says_so():
    start, walls = channel(25, 17), {"bottom": gg.Wall(1e-3)}
    ended = solve(start, walls, max_iterations=2)
    assert not ended.converged
    assert ended.status is gg.Status.ITERATION_LIMIT
    assert ended.quality.valid
    assert "after 2 updates of the control functions" in ended.message
    assert "This is the best valid grid." in ended.message
    better = solve(start, walls, max_iterations=7)
    assert heights(better.grid)[1].max() < heights(ended.grid)[1].max()
    nothing = solve(start, walls, max_iterations=0)
    assert np.array_equal(nothing.grid.xy, start.xy)


def test_where_no_update_leads_on_the_best_valid_grid_is_returned():
    """Two sharp corners of the wall, one of them reflex: the algebraic grid is folded, and the equations fail."""
    result = solve(gg.domain("zee", 11, 11), {"bottom": gg.Wall(2e-2)})
    assert result.status is gg.Status.STALLED
    assert result.quality.valid
    assert "none leads to a valid solution any more. This is the best valid grid." in result.message


@pytest.mark.parametrize("steps", [1, 9, 20])
def test_an_interrupted_run_gives_a_valid_grid(steps):
    seen = []

    def callback(step):
        seen.append(step)
        if len(seen) == steps:
            raise StopIteration

    result = solve(channel(25, 17), {"bottom": gg.Wall(1e-3)}, callback=callback)
    assert result.interrupted
    assert result.quality.valid
    assert [step.iteration for step in seen] == list(range(steps))
    assert result.change.after.wall_factors["bottom"] < 1.2


def test_a_folded_start_is_no_obstacle_where_the_algebraic_grid_is_valid():
    xy = channel(25, 17, first=1e-2).xy
    xy[10:14, 5:9] = xy[14:18, 5:9][::-1]
    result = solve(gg.Grid(xy), {"bottom": gg.Wall(1e-2)})
    assert result.converged
    assert np.abs(result.grid.xy - solve(channel(25, 17, first=1e-2), {"bottom": gg.Wall(1e-2)}).grid.xy).max() < 1e-9


def test_a_folded_algebraic_grid_gives_way_to_that_of_the_walls_as_a_target():
    start, walls = gg.domain("swan", 21, 21), {"bottom": gg.Wall(1e-2)}
    assert not gg.quality(start).valid
    cells = wall_cells(walls_by_side(walls), start.planes, start.shape)
    assert not gg.quality(gg.Grid.from_planes(*law_grid(start.planes, cells))).valid
    result = solve(start, walls)
    assert result.converged, result.message
    assert result.message.startswith("The transfinite grid with these heights is folded, so it began with")
    np.testing.assert_allclose(heights(result.grid)[0], 1e-2, rtol=1e-3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"walls": None}, "computes control functions from walls: give walls"),
        ({"walls": {}}, "computes control functions from walls: give walls"),
        ({"method": "relaxation"}, "needs Newton's method: drop method='relaxation'"),
        ({"control": "thomas-middlecoff"}, "walls become a target, in which other control functions have no part"),
        ({"control": (0, 0)}, "become control functions by control='hilgenstock-white'"),
        ({"walls": {"below": gg.Wall(1e-2)}}, "unknown side 'below' in walls"),
        ({"walls": {"bottom": gg.Wall(1e-300)}}, "coordinates of this size are rounded"),
        ({"functional": "knupp"}, "those of 'knupp' are not"),
    ],
)
def test_what_does_not_belong_together_is_refused(options, message):
    given = {"functional": "winslow", "control": "hilgenstock-white", "walls": {"bottom": gg.Wall(1e-2)}} | options
    with pytest.raises(gg.GridgenError) as error:
        gg.solve_euler_lagrange(channel(9, 9), progress=False, **given)
    assert message in str(error.value)


def test_a_folded_start_without_a_barrier_is_refused():
    options = {"control": "hilgenstock-white", "walls": {"bottom": gg.Wall(0.02)}, "max_iterations": 0}
    with pytest.raises(gg.GridgenError, match="begin with a valid grid, and the start is folded"):
        gg.solve_euler_lagrange(gg.domain("swan", 9, 9), "length", progress=False, **options)


def test_the_c_grid_round_naca_0012():
    """Aspect ratios of 2e7: the outer boundary is at 500 chords, and first cells are 9e-6 chords high."""
    start, first = nasa("n0012_113-33")
    result = solve(start, {"bottom": gg.Wall(first)})
    assert result.converged, result.message
    assert result.quality.valid
    height, off = heights(result.grid)
    np.testing.assert_allclose(height, first[1:-1], rtol=1e-3)
    assert off[24:87].max() < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bump_3levelsdown_177x81", "n4412_225-65"])
def test_grids_of_nasa(name):
    start, first = nasa(name)
    result = solve(start, {"bottom": gg.Wall(first)})
    assert result.converged, result.message
    assert result.quality.valid
    height, off = heights(result.grid)
    np.testing.assert_allclose(height, first[1:-1], rtol=1e-3)
    assert off[2:-2].max() < 0.1
