"""Functionals with a barrier at J = 0: valid starts stay valid, folded ones are untangled, impossible ones are told."""

from __future__ import annotations

import numpy as np
import pytest
from support import BUILTIN, NO_SHARED, SHARED
from support_solvers import (
    BARRIER,
    METHODS,
    assert_consistent,
    disordered,
    edges,
    farthest,
    gradient_norm,
    hopeless_grid,
    largest_rise,
)

import gridgen_sym as gg

REGIONS = SHARED / "domains" / "regions"

each_method = pytest.mark.parametrize("method", METHODS)
each_barrier = pytest.mark.parametrize("name", BARRIER)


@each_barrier
@each_method
@pytest.mark.parametrize("seed", range(6))
def test_a_valid_start_stays_valid(name, method, seed):
    start = disordered(gg.domain(("wavy", "chevron", "horseshoe_map")[seed % 3], 11, 9), 1.0, seed)
    result = gg.optimize(start, name, method, max_iterations=100)
    assert min(step.min_jacobian for step in result.history) > 0
    assert result.quality.valid
    assert result.energy < gg.energy(start, name)


@each_barrier
@each_method
def test_the_barrier_holds_where_validity_is_not_asked_for(name, method):
    start = disordered(gg.domain("horseshoe_map", 11, 9), 1.0)
    result = gg.optimize(start, name, method, keep_valid=False, max_iterations=100)
    assert min(step.min_jacobian for step in result.history) > 0


@each_barrier
@each_method
def test_both_ways_lead_from_disorder_to_one_minimum(name, method):
    domain = gg.domain("chevron", 11, 9)
    expected = gg.optimize(domain, name, tolerance=1e-9)
    result = gg.optimize(disordered(domain, 1.0, seed=3), name, method, tolerance=1e-9)
    assert result.converged, result.message
    assert farthest(result.grid, expected.grid) < 1e-6


@pytest.mark.slow
@each_barrier
@pytest.mark.parametrize(("domain", "nodes"), [("swan", 41), ("zee", 21)])
def test_a_folded_start_is_untangled_and_that_is_said(name, domain, nodes):
    start = gg.domain(domain, nodes, nodes)
    assert gg.quality(start).folded_cells > 50
    result = gg.optimize(start, name)
    assert result.converged, result.message
    assert result.quality.valid
    assert "folded at the start and was untangled" in result.message
    assert np.array_equal(edges(result.grid.xy), edges(start.xy))
    assert_consistent(result, name)


@each_barrier
@pytest.mark.parametrize(("domain", "nodes"), [("swan", 41), ("zee", 21)])
def test_untangling_alone_gives_a_valid_grid(name, domain, nodes):
    start = gg.domain(domain, nodes, nodes)
    result = gg.untangle(start, name)
    assert result.converged
    assert result.quality.valid
    assert np.array_equal(edges(result.grid.xy), edges(start.xy))
    assert_consistent(result, name)


@each_barrier
def test_the_minimum_is_reached_from_a_folded_start(name):
    """The gradient at a grid that is just untangled is huge, and a small part of it may still be far from zero."""
    result = gg.optimize(gg.domain("zee", 9, 9), name)
    assert result.converged
    polished = gg.optimize(result.grid, name, tolerance=1e-8)
    assert result.energy == pytest.approx(polished.energy, rel=1e-7)
    assert farthest(result.grid, polished.grid) < 1e-4


@pytest.mark.parametrize(
    "path",
    sorted(REGIONS.glob("*_21.npz"))
    or [pytest.param(REGIONS, marks=pytest.mark.skip(reason=NO_SHARED.format("domains/regions")))],
    ids=lambda path: path.stem,
)
def test_regions_of_the_literature_are_gridded(path):
    with np.load(path) as archive:
        reference = gg.Grid(archive["xy"])
    xy = reference.xy
    start = gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1])
    result = gg.optimize(start, "winslow")
    assert result.converged, result.message
    assert result.quality.valid
    assert ("untangled" in result.message) == (not gg.quality(start).valid)
    # The reference is valid, so that the minimum cannot lie above it.
    assert result.energy <= gg.energy(reference, "winslow")


@pytest.mark.skipif(not REGIONS.is_dir(), reason=NO_SHARED.format("domains/regions"))
def test_there_are_nine_regions():
    assert len(list(REGIONS.glob("*_21.npz"))) == 9


@pytest.mark.parametrize(
    "solve",
    [
        *(lambda grid, name, m=m: gg.optimize(grid, name, m) for m in METHODS),
        gg.untangle,
        gg.solve_euler_lagrange,
    ],
    ids=["newton", "local", "untangle", "euler_lagrange"],
)
@each_barrier
def test_an_impossible_boundary_is_told_with_its_cells(solve, name):
    result = solve(hopeless_grid(), name)
    assert not result.converged
    assert np.isfinite(result.grid.planes).all()
    folded = [tuple(int(k) for k in cell) for cell in result.quality.folded]
    assert (0, 0) in folded
    for cell in folded:
        assert f"cell {cell}" in result.message
    assert "no valid grid exists: at corner 0" in result.message
    assert "the boundary turns the wrong way" in result.message


def test_a_grid_that_cannot_be_untangled_is_not_made_worse():
    start = hopeless_grid()
    assert gg.untangle(start).quality.folded_cells <= gg.quality(start).folded_cells


def test_untangling_leaves_a_valid_grid_alone():
    start = disordered(gg.domain("wavy", 9, 9), 0.5)
    result = gg.untangle(start)
    assert result.converged
    assert result.grid == start


def test_untangling_keeps_fixed_nodes():
    start = gg.domain("swan", 21, 21)
    fixed = np.zeros(start.shape, dtype=bool)
    fixed[3, 4] = True
    result = gg.untangle(start, fixed=fixed)
    assert result.converged
    assert np.array_equal(result.grid.xy[3, 4], start.xy[3, 4])
    assert not np.array_equal(result.grid.xy[3, 5], start.xy[3, 5])


def test_untangling_reports_its_steps():
    steps = []
    result = gg.untangle(gg.domain("swan", 21, 21), callback=steps.append)
    assert tuple(steps[-len(result.history) :]) == result.history
    assert len(steps) > 2


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_untangling_does_not_depend_on_the_size(scale):
    start = gg.domain("swan", 21, 21)
    result = gg.optimize(gg.Grid(start.xy * scale), "winslow", tolerance=1e-9)
    expected = gg.optimize(start, "winslow", tolerance=1e-9)
    assert result.converged, result.message
    assert farthest(gg.Grid(result.grid.xy / scale), expected.grid) < 1e-7


@each_barrier
def test_no_iterations_of_a_folded_start_do_not_count_as_converged(name):
    result = gg.optimize(gg.domain("swan", 9, 9), name, max_iterations=0)
    assert not result.converged
    assert gradient_norm(result.grid, name) > 0


@pytest.mark.parametrize("name", [name for name in BUILTIN if name not in BARRIER])
def test_untangling_needs_a_barrier(name):
    with pytest.raises(gg.GridgenError, match=f"needs a functional with a barrier .* '{name}' has none"):
        gg.untangle(gg.domain("swan", 9, 9), name)


def test_the_history_after_untangling_is_one_run():
    result = gg.optimize(gg.domain("swan", 21, 21), "winslow")
    assert [step.iteration for step in result.history] == list(range(result.iterations + 1))
    assert largest_rise(result) <= 1e-12
    assert min(step.min_jacobian for step in result.history) > 0


def test_the_steps_of_untangling_are_counted_through():
    result = gg.untangle(gg.domain("zee", 17, 17))
    assert [step.iteration for step in result.history] == list(range(result.iterations + 1))
