"""Adaptation pays: a third of the uniform grid's error or less, without a folded cell; and it says what it did."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest
from solvers.conftest import farthest, hopeless_grid

import gridgen_sym as gg
from gridgen_sym.adaptation.law import law_of, weight_values
from gridgen_sym.adaptation.mover import Mover, movement
from gridgen_sym.adaptation.sides import _straight, slide, sliding_sides

from .conftest import SHARP, front, interpolation_error, ring, shock, two_scales

NODES = 33
MEASURES = ("gradient", "arc_length", "curvature", "recovery_error", "hierarchical_error")


def square(nodes=NODES):
    return gg.domain("square", nodes, nodes)


# ---- it pays ----


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("name", SHARP)
def test_error_is_at_most_a_third_of_the_uniform_grids(name, measure):
    function = SHARP[name]
    result = gg.adapt(square(), function, monitor=measure)
    assert result.quality.valid
    # Measured: 0.03 to 0.32.
    assert interpolation_error(result.grid, function) < interpolation_error(square(), function) / 3
    assert result.grid.shape == square().shape


@pytest.mark.parametrize("name", SHARP)
def test_the_boundary_may_stay(name):
    function = SHARP[name]
    result = gg.adapt(square(), function, boundary="fixed")
    for side in (np.s_[:, 0], np.s_[:, -1], np.s_[0], np.s_[-1]):
        assert np.array_equal(result.grid.xy[side], square().xy[side])
    assert result.quality.valid
    # A front that meets the boundary cannot be resolved there: measured 0.22 to 0.33.
    assert interpolation_error(result.grid, function) < 0.4 * interpolation_error(square(), function)


def test_nodes_on_straight_sides_are_equidistributed_too():
    result = gg.adapt(square(), shock)
    for side in (np.s_[:, 0], np.s_[0, :]):
        spacing, density = np.hypot(*np.diff(result.grid.xy[side], axis=0).T), result.density[side]
        product = spacing * (density[1:] + density[:-1]) / 2
        assert product.std() / product.mean() < 0.05
        assert spacing.std() / spacing.mean() > 0.3
    stays = gg.adapt(square(), shock, boundary="fixed").grid
    assert interpolation_error(result.grid, shock) < 0.6 * interpolation_error(stays, shock)


@pytest.mark.parametrize(("nodes", "most"), [(25, 0.5), (65, 0.25)])
def test_it_pays_on_other_sizes(nodes, most):
    result = gg.adapt(square(nodes), ring)
    assert result.converged, result.message
    assert interpolation_error(result.grid, ring) < most * interpolation_error(square(nodes), ring)


@pytest.mark.parametrize("nodes", [17, 33, 65])
def test_a_front_through_two_corners_settles_soon(nodes):
    """Its nodes crowd from both sides of the corners; a damping that is only ever lowered takes 18 to 31 steps."""
    result = gg.adapt(square(nodes), front)
    assert result.converged, result.message
    assert result.iterations <= 28
    dampings = [step.damping for step in result.history]
    assert dampings[0] == dampings[1] == 0.5
    assert min(dampings) < 0.5 < max(dampings)


def test_every_form_of_a_solution_gives_one_grid():
    import sympy

    x, y = sympy.symbols("x y")
    forms = (
        ring,
        lambda grid: ring(grid.x, grid.y),
        "tanh(50*(sqrt((x - 0.5)**2 + (y - 0.5)**2) - 0.3))",
        sympy.tanh(50 * (sympy.sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2) - 0.3)),
    )
    # An odd number of cells: no node stands on the center, where the formulas' derivatives have no value.
    first, *others = (gg.adapt(square(20), form, steps=4, moves=1).grid for form in forms)
    for grid in others:
        assert farthest(grid, first) < 1e-7


def test_nodal_values_of_the_start_are_enough():
    start = square(65)
    result = gg.adapt(start, ring(start.x, start.y))
    assert result.converged, result.message
    assert interpolation_error(result.grid, ring) < interpolation_error(start, ring) / 3
    # The values were interpolated, and are as good as the start's.
    assert np.abs(result.values - ring(*result.grid.planes)).max() < 0.6
    assert np.sqrt(((result.values - ring(*result.grid.planes)) ** 2).mean()) < 0.1


# ---- it equidistributes, and keeps cells valid ----


@pytest.mark.parametrize("name", ["ring", "two scales", "shock"])
def test_the_density_is_equidistributed(name):
    result = gg.adapt(square(), SHARP[name])
    assert result.converged, result.message
    assert result.after.weight.variation < result.before.weight.variation / 5
    assert result.after.weight.ratio < result.before.weight.ratio / 2
    assert result.after.weight == gg.equidistribution(result.grid, result.density).weight
    assert result.history[-1].spread == pytest.approx(result.after.weight.variation)


def test_every_grid_on_the_way_is_valid_also_with_too_much_asked_of_it():
    smallest = []
    monitor = gg.Monitor("gradient", share=0.99, smoothing=0)
    result = gg.adapt(
        square(),
        front,
        monitor=monitor,
        damping=1.0,
        steps=6,
        callback=lambda step: smallest.append(step.min_jacobian),
    )
    assert min(smallest) > 0
    assert len(smallest) == 7
    assert result.quality.valid


@pytest.mark.parametrize("functional", ["area", "length", "combined"])
def test_functionals_without_a_barrier_do_not_fold_either(functional):
    result = gg.adapt(square(17), two_scales, functional=functional, steps=8)
    assert result.quality.valid
    assert result.history[-1].error < result.history[0].error


def test_a_grid_that_cannot_move_is_not_called_settled():
    """Length folds cells in a domain like this one: its minimum cannot be reached."""
    start = gg.optimize(gg.domain("annulus", 33, 17), "winslow").grid
    result = gg.adapt(start, "tanh(20*(x - 0.2))", functional="length")
    assert result.quality.valid
    assert not result.converged
    assert "length is not minimised: the minimum lies beyond the valid grids" in result.message


@pytest.mark.parametrize("name", gg.domain_names())
def test_every_domain_can_be_adapted(name):
    start = gg.optimize(gg.domain(name, 25, 25), "winslow").grid
    center, size = start.planes[:, 12, 15], 24 * np.sqrt(gg.quality(start).mean_jacobian)

    def bubble(x, y):
        return np.tanh(20 * (np.hypot(x - center[0], y - center[1]) / size - 0.25))

    result = gg.adapt(start, bubble, steps=12)
    assert result.quality.valid
    # Measured: 0.3 to 0.65.
    assert interpolation_error(result.grid, bubble) < 0.75 * interpolation_error(start, bubble)
    assert result.after.weight.variation < 0.75 * result.before.weight.variation


def test_a_moving_front_is_followed_by_a_few_steps_at_a_time():
    grid = gg.adapt(square(), lambda x, y: np.tanh(50 * (np.hypot(x, y) - 0.3))).grid
    for radius in np.linspace(0.32, 0.5, 10):
        moved = lambda x, y, r=radius: np.tanh(50 * (np.hypot(x, y) - r))  # noqa: E731
        result = gg.adapt(grid, moved, steps=2)
        assert result.quality.valid
        assert interpolation_error(result.grid, moved) < interpolation_error(square(), moved) / 3
        grid = result.grid


def test_corners_of_a_mask_hold_no_side():
    mask = np.zeros((5, 5), dtype=bool)
    mask[0, 0] = mask[2, 2] = True
    assert len(sliding_sides(square(5), "straight", mask)) == 4
    mask[0, 3] = True
    assert len(sliding_sides(square(5), "straight", mask)) == 3


def test_boundary_nodes_never_go_beyond_what_is_wanted(monkeypatch):
    """The weight may: Aitken's rule takes up to twice the share."""
    shares = []

    def recorded(sides, grid, density, fixed, damping):
        shares.append(damping)
        return slide(sides, grid, density, fixed, damping)

    monkeypatch.setattr("gridgen_sym.adaptation.mover.slide", recorded)
    result = gg.adapt(square(17), "tanh(10*(x + y - 1))", steps=8, damping=0.5)
    assert max(step.damping for step in result.history) > 1
    assert max(shares) == 1


def test_a_movement_is_a_part_of_the_domain():
    xy = 300.0 * square(5).xy
    xy[2, 2] += 3.0, 4.0
    for unit in (1.0, 1e-6):
        grid = gg.Grid(unit * 300.0 * square(5).xy)
        assert movement(grid, gg.Grid(unit * xy)) == pytest.approx(5.0 / 300.0)


@pytest.mark.parametrize("moves", [1, 3])
def test_nodes_are_moved_so_often_in_each_step(moves, monkeypatch):
    calls = []

    def counted(grid, *arguments, optimize=gg.optimize, **options):
        calls.append(grid)
        return optimize(grid, *arguments, **options)

    monkeypatch.setattr("gridgen_sym.adaptation.mover.optimize", counted)
    result = gg.adapt(square(17), ring, steps=2, moves=moves)
    assert (len(calls), result.iterations) == (2 * moves, 2)


def test_the_share_of_a_step_is_chosen_anew():
    shares = [step.damping for step in gg.adapt(square(17), ring, steps=4, damping=0.4).history]
    assert shares[:2] == [0.4, 0.4]
    assert len(set(shares[1:])) == 4


def test_which_sides_are_straight():
    x = np.array([0.0, 0.1, 0.5, 1.0])
    assert _straight(np.stack((x, 2 * x)))
    assert _straight(np.stack((x, 2 * x + 1e-12 * (x == 0.5))))
    assert not _straight(np.stack((x, 2 * x + 1e-6 * (x == 0.5))))
    assert not _straight(np.stack((x, 2 * x + 1e-6 * (x == 1.0))))
    assert not _straight(np.stack((x * (1 - x), x * (1 - x)))), "it ends where it began"
    assert _straight(1e-9 * np.stack((x, 2 * x))), "in any unit"
    assert not _straight(1e-9 * np.stack((x, 2 * x + 1e-6 * (x == 0.5))))


@pytest.mark.parametrize(
    ("damping", "rest", "expected"),
    [(0.5, 0.5, 1.0), (0.5, 1.0, 0.5), (0.5, -10.0, 0.1), (0.05, -10.0, 0.05), (0.9, 0.7, 2.0)],
)
def test_the_share_is_that_which_would_have_left_nothing(damping, rest, expected):
    """Of a move that leaves a part of the lack; within bounds, and the same as before where it has changed nothing."""
    fixed = np.ones((5, 5), dtype=np.uint8)
    mover = Mover(gg.functional("area_winslow"), (1, 2), None, fixed, None, damping, [])
    lack = 1e-3 * np.random.default_rng(0).normal(size=(5, 5))
    mover._choose_damping(lack)
    mover._choose_damping(rest * lack)
    assert mover.damping == pytest.approx(expected)


def test_weights_of_laws_and_of_ones_own_power():
    """Where the cells' areas are a, and the density over its mean r: r^p/a^q, and r^p for a power that is given."""
    grid = gg.Grid(0.5 * square(5).xy)
    area, density = 0.5**2 / 16, np.full((5, 5), 3.0)
    density[2, 2] = 19.0  # The mean over the cells is 4.
    for name, power, expected in (
        ("area", None, density / 4 / area**2),
        ("length", None, density / 4 / area),
        ("mine", 0.5, np.sqrt(density / 4)),
    ):
        np.testing.assert_allclose(weight_values(density, grid, law_of(name, power)), expected, rtol=1e-12)


def test_a_functional_of_ones_own_needs_its_power():
    own = gg.define("own_adaptive", lambda m: m.s * (m.g11 + m.g22) + 1e-7 / m.J, replace=True)
    with pytest.raises(gg.GridgenError, match="how 'own_adaptive' places nodes with a weight is not known"):
        gg.adapt(square(17), ring, functional=own)
    result = gg.adapt(square(), ring, functional=own, power=1, steps=5)
    assert result.quality.valid
    assert interpolation_error(result.grid, ring) < 0.5 * interpolation_error(square(), ring)


@pytest.mark.parametrize("scale", [1e-3, 1e4])
def test_units_do_not_matter(scale):
    function = lambda x, y: 7 * scale * ring(x / scale, y / scale)  # noqa: E731
    plain = gg.adapt(square(21), ring, steps=5).grid
    scaled = gg.adapt(gg.Grid(square(21).xy * scale), function, steps=5).grid
    assert farthest(gg.Grid(scaled.xy / scale), plain) < 1e-6


def test_curved_domains_keep_their_shape():
    start = gg.optimize(gg.domain("horseshoe_map", 33, 17), "winslow").grid
    center = start.planes[:, 16, 8]

    def spot(x, y):
        return np.tanh(6 * (np.hypot(x - center[0], y - center[1]) - 0.4))

    result = gg.adapt(start, spot)
    assert result.quality.valid
    assert interpolation_error(result.grid, spot) < 0.7 * interpolation_error(start, spot)
    for side in (np.s_[:, 0], np.s_[:, -1]):
        assert np.array_equal(result.grid.xy[side], start.xy[side])
    free = gg.adapt(start, spot, boundary="all", steps=5)
    assert free.quality.valid
    assert not np.array_equal(free.grid.xy[:, -1], start.xy[:, -1])
    # Every boundary node stays on the polygon of its side.
    polygon = start.xy[:, -1]
    for point in free.grid.xy[:, -1]:
        along, off = polygon[1:] - polygon[:-1], point - polygon[:-1]
        part = np.clip((along * off).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
        assert np.hypot(*(off - part[:, np.newaxis] * along).T).min() < 1e-9


def test_fixed_inner_nodes_stay_and_hold_their_side():
    fixed = np.zeros((21, 21), dtype=bool)
    fixed[5, 5], fixed[0, 10] = True, True
    result = gg.adapt(square(21), shock, fixed=fixed, steps=4)
    assert np.array_equal(result.grid.xy[5, 5], square(21).xy[5, 5])
    assert np.array_equal(result.grid.xy[0], square(21).xy[0])
    assert not np.array_equal(result.grid.xy[:, 0], square(21).xy[:, 0])


# ---- what it says ----


def test_the_history_tells_of_every_step():
    seen = []
    result = gg.adapt(square(), two_scales, callback=seen.append)
    assert tuple(seen) == result.history
    assert [step.step for step in seen] == list(range(len(seen)))
    assert seen[0].movement == 0
    assert seen[-1].movement <= 1e-3 < seen[-2].movement
    assert result.converged
    assert result.iterations < 30
    assert "has settled" in result.message
    assert str(result).startswith(f"converged after {result.iterations} steps")
    assert np.array_equal(result.values, two_scales(*result.grid.planes))


def test_progress_is_shown_where_it_takes_long(monkeypatch, live_line):
    gg.adapt(square(9), ring, steps=1, progress=True)
    assert not live_line, "it did not take long"
    monkeypatch.setattr("gridgen_sym.solvers.live.PATIENCE", -1.0)
    gg.adapt(square(9), ring, steps=1, progress=False)
    assert not live_line
    gg.adapt(square(9), ring, steps=1, progress=True)
    assert (live_line[0], live_line[-1], len(live_line)) == ("start", "stop", 4)
    assert live_line[2].startswith("adapt, area_winslow: step 1, movement")


def test_too_few_steps_are_told():
    result = gg.adapt(square(17), ring, steps=2)
    assert not result.converged
    assert "not settled in 2 steps" in result.message
    assert str(result).startswith("NOT converged after 2 steps")


def test_nothing_to_adapt_to_leaves_a_uniform_grid():
    result = gg.adapt(square(17), "0*x + 3")
    assert result.converged
    assert farthest(result.grid, square(17)) < 1e-8
    assert "The solution is 3 at every node: there is nothing to adapt to." in result.message
    assert "nothing to adapt" not in gg.adapt(square(17), "x", steps=1).message


def test_a_folded_start_is_untangled_and_a_hopeless_one_refused():
    xy = square(17).xy
    xy[5, 5], xy[6, 5] = xy[6, 5].copy(), xy[5, 5].copy()
    result = gg.adapt(gg.Grid(xy), ring, steps=2)
    assert "The start was folded and was untangled first" in result.message
    assert result.quality.valid
    with pytest.raises(gg.GridgenError, match="needs a valid start"):
        gg.adapt(hopeless_grid(), ring)


def test_ctrl_c_gives_the_last_grid_whose_solution_is_known():
    calls = []

    def solve(grid):
        calls.append(grid)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return ring(grid.x, grid.y)

    result = gg.adapt(square(17), solve)
    assert result.interrupted
    assert not result.converged
    assert result.grid == calls[2]
    assert "interrupted" in result.message
    assert result.stopped_by == "Ctrl-C"


def test_ctrl_c_in_an_untangling_goes_on_to_the_user(monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    xy = square(9).xy
    xy[5, 5], xy[6, 5] = xy[6, 5].copy(), xy[5, 5].copy()
    monkeypatch.setattr("gridgen_sym.solvers.run.unfold", interrupted)
    with pytest.raises(KeyboardInterrupt):
        gg.adapt(gg.Grid(xy), ring)


def test_the_time_limit_gives_the_last_grid_whose_solution_is_known(monkeypatch):
    start, solved, now = square(17), [], [0.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])

    def solve(grid):
        solved.append(grid)
        now[0] += 1.0
        return ring(grid.x, grid.y)

    result = gg.adapt(start, solve, time_limit=2.5)
    assert result.stopped_by == "time limit"
    assert result.interrupted
    assert not result.converged
    assert result.message.startswith("the time limit of 2.5 seconds is over; this is the last grid whose solution")
    assert (len(solved), result.grid) == (3, solved[-1])


def test_the_time_limit_ends_a_minimisation_of_an_adaptation(monkeypatch):
    start = square(17)
    monkeypatch.setattr("time.monotonic", count(0.0, 0.01).__next__)
    assert gg.adapt(start, ring, time_limit=1e9).stopped_by is None
    result = gg.adapt(start, ring, time_limit=0.035)
    assert result.stopped_by == "time limit"
    assert result.grid == start


def test_a_folded_start_that_cannot_be_untangled_in_time_is_refused():
    xy = square(9).xy
    xy[5, 5], xy[6, 5] = xy[6, 5].copy(), xy[5, 5].copy()
    with pytest.raises(gg.GridgenError, match=r"needs a valid start.* time limit of 1e-09 seconds is over"):
        gg.adapt(gg.Grid(xy), ring, time_limit=1e-9)


def test_the_callback_and_the_time_limit_stop_it():
    seen = []

    def stop(step):
        seen.append(step)
        if step.step == 2:
            raise StopIteration

    stopped = gg.adapt(square(17), ring, callback=stop)
    assert (stopped.interrupted, stopped.converged) == (True, False)
    assert stopped.history == tuple(seen)
    assert stopped.grid == gg.adapt(square(17), ring, steps=2).grid
    assert "the callback stopped it; this is the last grid" in stopped.message
    at_once = gg.adapt(square(17), ring, time_limit=1e-9)
    assert at_once.grid == square(17)
    assert "the time limit of 1e-09 seconds is over; this is the last grid" in at_once.message


def test_an_error_on_the_way_holds_the_last_grid():
    def fail(step):
        if step.step == 2:
            raise LookupError("mine")

    with pytest.raises(LookupError, match="mine") as caught:
        gg.adapt(square(17), ring, callback=fail)
    assert caught.value.result.grid == gg.adapt(square(17), ring, steps=2).grid
    assert "'result' holds the last adapted grid" in caught.value.__notes__[0]
    grids = []

    def diverges(grid):
        grids.append(grid)
        if len(grids) == 3:
            raise ArithmeticError
        return ring(grid.x, grid.y)

    with pytest.raises(gg.GridgenError, match="step 2") as caught:
        gg.adapt(square(17), diverges)
    assert caught.value.result.grid == grids[1]
    assert len(caught.value.result.history) == 2


# ---- refusals ----


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"steps": -1}, "steps must be a whole number, at least 0; came -1"),
        ({"moves": 0}, "moves must be a whole number, at least 1; came 0"),
        ({"damping": 0}, "damping must be a number above 0 and at most 1; came 0"),
        ({"tolerance": 2}, "tolerance must be a number above 0"),
        ({"time_limit": 0}, "time_limit must be a positive number of seconds; came 0"),
        ({"callback": 3}, "callback must be a function of one AdaptStep; came 3"),
        ({"boundary": "open"}, "unknown boundary 'open': it is one of fixed, straight, all"),
        ({"functional": "areas"}, "Did you mean 'area'"),
        ({"functional": "winslow"}, "how 'winslow' places nodes with a weight is not known"),
        ({"monitor": "slope"}, "unknown monitor 'slope'; known: gradient"),
        ({"monitor": lambda grid, values: -np.ones(grid.shape)}, r"must not be negative: it is -1 at node \(0, 0\)"),
        ({"monitor": lambda grid, values: np.ones(3)}, r"measure must have the grid's shape \(9, 9\); came \(3,\)"),
    ],
)
def test_arguments_that_cannot_be_used_are_refused(options, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.adapt(square(9), ring, **options)


@pytest.mark.parametrize(
    ("solution", "match"),
    [
        (np.ones((3, 3)), r"the solution must have the grid's shape \(9, 9\); came \(3, 3\)"),
        (lambda grid: grid.x[1:], r"the solution on the grid of step 0 must have the grid's shape"),
        (lambda grid: grid.x / 0 * np.nan, "on the grid of step 0 must be finite"),
        (lambda grid: {}["u"], "cannot be had on the grid of step 0: KeyError"),
        (lambda x, y, z: x, "came one of 3 arguments"),
        ("x + z", "unknown name 'z'"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*divide by zero.*", "ignore:.*invalid value.*")
def test_solutions_that_cannot_be_used_are_refused(solution, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.adapt(square(9), solution)


def test_a_start_that_is_no_grid_is_refused():
    with pytest.raises(gg.GridgenError, match="underflow to zero: scale it"):
        gg.adapt(gg.Grid(square(9).xy * 1e-160), ring)
    with pytest.raises(gg.GridgenError, match="expected a Grid, came ndarray"):
        gg.adapt(square(9).xy, ring)
