"""A few bad places of a grid are seen to by themselves, and the rest of it does not pay for them."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import BARRIER

import gridgen_sym as gg
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.iterate import Iterate
from gridgen_sym.solvers.newton import minimize as newton
from gridgen_sym.solvers.newton.minimize import minimize
from gridgen_sym.solvers.newton.nonlinear_elimination import sweep_standing_out
from gridgen_sym.solvers.run.deadline import Deadline
from gridgen_sym.solvers.run.progress import Progress

SIZE = 65
each_barrier = pytest.mark.parametrize("name", BARRIER)


def solved(name):
    """The minimum on a wavy square."""
    return gg.optimize(gg.domain("wavy", SIZE, SIZE), name).grid.planes.copy()


def squeezed(name, *, folded=False):
    """The same, but for a node next to the boundary that was moved all but (or, folded, more than) to the next one."""
    place = solved(name)
    place[:, 1, 30] += (1.2 if folded else 0.999) * (place[:, 2, 30] - place[:, 1, 30])
    return place


@pytest.fixture
def seen(monkeypatch):
    """The shapes of the subdomains that are minimized over by themselves."""
    shapes = []

    def recorded(problem, coordinates, *arguments, **options):
        shapes.append(coordinates.shape[1:])
        return minimize(problem, coordinates, *arguments, **options)

    monkeypatch.setattr(newton, "minimize", recorded)
    return shapes


def point_of(place, name="winslow", **options):
    return Iterate(make_problem(gg.Grid.from_planes(*place), name, **options), place)


@each_barrier
def test_elimination_calms_a_bad_place_and_leaves_most_of_the_grid_alone(name):
    place = squeezed(name)
    point, before = point_of(place.copy(), name), squeezed(name)
    norm, smallest, energy = point.norm, point.smallest, point.energy
    newton._eliminate(point, Deadline())
    assert point.norm < 1e-3 * norm
    assert point.smallest > 10 * smallest
    assert point.energy < energy
    moved = (point.coordinates != before).any(axis=0)
    assert moved[1, 30]
    assert moved.sum() < 0.1 * moved.size
    again = point_of(point.coordinates, name)
    assert (again.energy, again.smallest, again.norm) == (point.energy, point.smallest, point.norm)
    assert np.array_equal(again.gradient, point.gradient)


def test_fixed_nodes_stay():
    place = squeezed("winslow")
    fixed = np.zeros((SIZE, SIZE), dtype=bool)
    fixed[1, 29] = fixed[2, 31] = True
    point = point_of(place.copy(), fixed=fixed)
    newton._eliminate(point, Deadline())
    assert np.array_equal(point.coordinates[:, fixed], place[:, fixed])
    assert not np.array_equal(point.coordinates[:, 1, 30], place[:, 1, 30])


def stretched():
    """A grid in which eight nodes in a row have been drawn to the boundary: too many for sweeps."""
    place = squeezed("winslow")
    place[:, 1:9, 40] = place[:, [1], 40] + np.linspace(0, 1e-3, 8) * (place[:, 9] - place[:, 1])[:, [40]]
    return place


def test_windows_are_small_and_cut_out_where_sweeps_are_not_enough(seen):
    point = point_of(stretched())
    assert point.smallest > 0
    newton._eliminate(point, Deadline())
    assert seen
    assert all(ni * nj <= SIZE**2 / 4 for ni, nj in seen)


@pytest.mark.slow
@pytest.mark.parametrize("options", [{"weight": "1 + x**2"}, {"interior_only": True}])
def test_no_window_is_cut_out_of_what_hangs_together(options, seen):
    """A weight, and which corners count, depend on the whole grid: sweeps know them, windows do not."""
    point = point_of(stretched(), **options)
    norm = point.norm
    newton._eliminate(point, Deadline())
    assert not seen
    assert point.norm < norm


def test_a_smooth_grid_is_left_alone():
    place = gg.domain("wavy", SIZE, SIZE).planes.copy()
    point = point_of(place.copy())
    point.gradient[...] = 1.0  # Nothing stands out.
    sweep_standing_out(point, point.problem, Deadline())
    assert np.array_equal(point.coordinates, place)


@each_barrier
def test_newton_takes_fewer_steps_with_it(name, monkeypatch):
    def steps():
        place = squeezed(name)
        problem = make_problem(gg.Grid.from_planes(*place), name)
        with Progress("minimize", show=False) as report:
            outcome = minimize(
                problem, place, report, tolerance=1e-8, max_iterations=100, keep_valid=True, reference=1.0
            )
        assert outcome.converged
        return len(report.history), place

    few, place = steps()
    monkeypatch.setattr(newton, "_eliminate", lambda point, deadline: None)
    many, same = steps()
    assert few < 0.6 * many
    np.testing.assert_allclose(place, same, atol=1e-6)


def test_it_comes_before_the_first_step(monkeypatch):
    start, called = gg.Grid.from_planes(*squeezed("winslow")), []
    monkeypatch.setattr(newton, "_eliminate", lambda point, deadline: called.append(point.norm))
    result = gg.optimize(start, "winslow", max_iterations=1)
    assert called == [result.history[0].gradient_norm]


@each_barrier
@pytest.mark.parametrize("eliminates", [True, False])
def test_an_almost_folded_start_does_not_pass_for_a_measure(name, eliminates, monkeypatch):
    """Its energy is larger by any factor, and so is its gradient: a part of that means nothing."""
    place = solved(name)
    least = make_problem(gg.Grid.from_planes(*place), name).energy(place)[0]
    place[:, 1, 30] += (1 - 1e-10) * (place[:, 2, 30] - place[:, 1, 30])
    if not eliminates:
        monkeypatch.setattr(newton, "_eliminate", lambda point, deadline: None)
    result = gg.optimize(gg.Grid.from_planes(*place), name)
    assert result.converged
    assert result.energy == pytest.approx(least, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["newton", "local"])
def test_a_constant_in_the_density_changes_nothing(method):
    """Winslow's density less its least value: the energy tends to 0, and with it what is a part of the energy."""
    gg.define("winslow_less_two", "(g11 + g22)/J - 2")
    s = np.linspace(0, 1, 17)
    place = np.stack(np.meshgrid(s, s, indexing="ij"))
    place[:, 1:-1, 1:-1] += 0.01 * np.random.default_rng(0).uniform(-1, 1, (2, 15, 15))
    start = gg.Grid.from_planes(*place)
    less, whole = (gg.optimize(start, name, method) for name in ("winslow_less_two", "winslow"))
    assert less.converged
    assert whole.converged
    assert less.iterations <= 2 * whole.iterations + 3


def test_no_iteration_allowed_is_none_done():
    place = squeezed("winslow")
    result = gg.optimize(gg.Grid.from_planes(*place), "winslow", max_iterations=0)
    assert np.array_equal(result.grid.planes, place)


@each_barrier
def test_a_single_fold_is_unfolded_where_it_is(name):
    place = squeezed(name, folded=True)
    start = gg.Grid.from_planes(*place)
    fixed = np.zeros(start.shape, dtype=bool)
    fixed[50, 50] = True  # So that no coarser grid knows all that counts.
    assert gg.quality(start).folded_cells > 0
    result = gg.untangle(start, name, fixed=fixed)
    assert result.converged
    moved = (result.grid.planes != place).any(axis=0)
    assert 0 < moved.sum() < 0.1 * moved.size


def test_a_deep_fold_is_unfolded_in_a_window():
    """Sweeps alone do not turn a knot of many nodes: a window around it does."""
    place = solved("winslow")
    knot = place[:, 20:27, 20:27].copy()
    place[:, 20:27, 20:27] = knot[:, ::-1, ::-1]
    start = gg.Grid.from_planes(*place)
    fixed = np.zeros(start.shape, dtype=bool)
    fixed[60, 60] = True
    result = gg.untangle(start, "winslow", fixed=fixed)
    assert result.converged
    moved = (result.grid.planes != place).any(axis=0)
    assert moved.sum() < 0.2 * moved.size
