"""Minimize every functional by both methods: the energy falls, what is fixed stays, and the result is stationary."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support import BUILTIN
from support_solvers import (
    METHODS,
    assert_consistent,
    disordered,
    edges,
    energy_differences,
    farthest,
    gradient_differences,
    gradient_norm,
    largest_rise,
    literal_energy,
    mild_grid,
    relative,
)

import gridgen_sym as gg
from gridgen_sym.runtime import find_compiler

FUNCTIONALS = BUILTIN
#: Functionals whose energy has no unit.
UNITLESS = ("winslow", "modified_liao")
#: Those whose minimum in the mild grid's boundary is one point; area and orthogonality have many.
UNIQUE = ("length", "knupp", "winslow", "liao", "modified_liao", "combined")
ROUND_OFF = 1e-12

each_method = pytest.mark.parametrize("method", METHODS)
each_functional = pytest.mark.parametrize("name", FUNCTIONALS)


@each_functional
@each_method
def test_a_result_is_stationary_and_says_what_is_so(name, method):
    start = mild_grid()
    # Node by node, orthogonality and area creep along their many minima.
    tolerance = 1e-3 if method == "local" and name in ("area", "orthogonality") else 1e-6
    result = gg.optimize(start, name, method, tolerance=tolerance, max_iterations=20_000 if method == "local" else None)
    assert result.converged, result.message
    assert result.quality.valid
    assert gradient_norm(result.grid, name) <= 1.001 * tolerance * gradient_norm(start, name)
    assert result.history[0].gradient_norm == pytest.approx(gradient_norm(start, name), rel=1e-9)
    assert result.history[-1].gradient_norm == pytest.approx(gradient_norm(result.grid, name), rel=1e-6)
    assert result.history[-1].min_jacobian == pytest.approx(result.quality.min_jacobian, rel=1e-12)
    assert f"{result.history[-1].gradient_norm:.2e}" in result.message
    assert_consistent(result, name)


@each_functional
@each_method
@pytest.mark.parametrize("domain", ["wavy", "horseshoe"])
def test_the_energy_never_rises_and_the_boundary_stays(name, method, domain):
    start = disordered(gg.domain(domain, 9, 11), 0.3)
    result = gg.optimize(start, name, method, max_iterations=60)
    assert largest_rise(result) <= ROUND_OFF
    assert result.energy < gg.energy(start, name)
    assert np.array_equal(edges(result.grid.xy), edges(start.xy))
    # keep_valid is the default, and the start is valid.
    assert min(step.min_jacobian for step in result.history) > 0
    assert [step.iteration for step in result.history] == list(range(result.iterations + 1))
    assert_consistent(result, name)


@each_functional
@each_method
def test_fixed_inner_nodes_do_not_move(name, method):
    start = mild_grid()
    fixed = np.zeros(start.shape, dtype=bool)
    fixed[3, 4], fixed[5, 2:6] = True, True
    result = gg.optimize(start, name, method, fixed=fixed, max_iterations=40)
    assert np.array_equal(result.grid.xy[fixed], start.xy[fixed])
    free = ~fixed[1:-1, 1:-1]
    moves = np.hypot(*(result.grid.planes - start.planes))[1:-1, 1:-1]
    assert (moves[free] > 0).all()
    assert not gg.gradient(start, name, fixed=fixed)[fixed].any()
    assert result.history[0].gradient_norm == pytest.approx(gradient_norm(start, name, fixed=fixed), rel=1e-12)


@pytest.mark.parametrize("kind", [bool, np.uint8, np.int64])
def test_a_mask_of_any_whole_number_is_a_mask(kind):
    start = mild_grid()
    fixed = np.zeros(start.shape, dtype=kind)
    fixed[4, 4] = 1
    result = gg.optimize(start, "winslow", fixed=fixed.tolist() if kind is bool else fixed)
    assert result.converged
    assert np.array_equal(result.grid.xy[4, 4], start.xy[4, 4])


@each_method
def test_all_nodes_fixed_is_a_start_that_stays(method):
    start = mild_grid()
    result = gg.optimize(start, "winslow", method, fixed=np.ones(start.shape, dtype=bool))
    assert result.converged
    assert result.grid == start


@pytest.mark.parametrize("name", UNIQUE)
def test_both_methods_find_the_same_minimum(name):
    start = mild_grid()
    newton = gg.optimize(start, name, "newton", tolerance=1e-9)
    local = gg.optimize(disordered(start, 0.1, seed=5), name, "local", tolerance=1e-9)
    assert newton.converged, newton.message
    assert local.converged, local.message
    assert farthest(newton.grid, start) > 1e-3
    assert farthest(newton.grid, local.grid) < 1e-7
    assert newton.energy == pytest.approx(local.energy, rel=1e-12)


@each_functional
def test_the_result_is_a_minimum_and_not_only_stationary(name):
    result = gg.optimize(mild_grid(), name, tolerance=1e-9)
    for seed in range(5):
        assert gg.energy(disordered(result.grid, 0.02, seed), name) > result.energy


# ---- energy, gradient, Hessian ----


@each_functional
@pytest.mark.parametrize("interior_only", [False, True])
def test_the_energy_is_the_papers_literal_sum(name, interior_only, backend):
    grid = disordered(gg.domain("wavy", 6, 8), 0.4)
    expected = literal_energy(grid, name, interior_only=interior_only)
    found = gg.energy(grid, name, interior_only=interior_only, spacing="index", backend=backend)
    assert found == pytest.approx(expected, rel=1e-13)


@each_functional
@pytest.mark.parametrize("interior_only", [False, True])
def test_gradient_and_hessian_are_differences(name, interior_only):
    grid = mild_grid(5, 6)
    gradient = gg.gradient(grid, name, interior_only=interior_only)
    assert not edges(gradient).any()
    assert relative(gradient, energy_differences(grid, name, 1e-5, interior_only=interior_only)) < 1e-6
    hessian = gg.hessian(grid, name, interior_only=interior_only).toarray()
    assert relative(hessian, gradient_differences(grid, name, 1e-6, interior_only=interior_only)) < 1e-6


@pytest.mark.slow
@each_functional
def test_the_semidefinite_hessian_is_so(name):
    matrix = gg.hessian(mild_grid(6, 5, 0.3), name, semidefinite=True).toarray()
    values = np.linalg.eigvalsh(matrix)
    assert np.array_equal(matrix, matrix.T)
    assert values.min() >= -1e-12 * values.max()
    assert values.max() > 0


def test_the_hessian_leaves_fixed_nodes_out():
    grid, fixed = mild_grid(5, 6), np.zeros((5, 6), dtype=bool)
    fixed[2, 3] = True
    whole = gg.hessian(grid, "winslow").toarray()
    # Inner nodes are numbered along eta first: (2, 3) is number 1 * 4 + 2.
    kept = [unknown for unknown in range(24) if unknown // 2 != 6]
    assert np.array_equal(gg.hessian(grid, "winslow", fixed=fixed).toarray(), whole[np.ix_(kept, kept)])


# ---- the two sets of corners ----


# Equal areas around the inner nodes alone pull nodes over the boundary, which keep_valid prevents.
@pytest.mark.parametrize("name", [name for name in FUNCTIONALS if name != "area"])
def test_the_papers_set_of_corners_can_be_minimized(name):
    start = mild_grid()
    result = gg.optimize(start, name, interior_only=True, spacing="index")
    assert result.converged, result.message
    assert largest_rise(result) <= ROUND_OFF
    assert result.energy == pytest.approx(literal_energy(result.grid, name, interior_only=True), rel=1e-12)
    before, after = (gradient_norm(grid, name, interior_only=True, spacing="index") for grid in (start, result.grid))
    assert after <= 1.001e-6 * before
    assert_consistent(result, name, interior_only=True, spacing="index")


@pytest.mark.parametrize("name", ["length", "knupp", "winslow"])
def test_both_methods_agree_on_the_papers_set_of_corners(name):
    newton, local = (gg.optimize(mild_grid(), name, m, interior_only=True, tolerance=1e-9) for m in METHODS)
    assert newton.converged
    assert local.converged
    assert farthest(newton.grid, local.grid) < 1e-7
    whole = gg.optimize(mild_grid(), name, tolerance=1e-9)
    assert farthest(newton.grid, whole.grid) > 1e-4


# ---- keep_valid ----


@pytest.mark.parametrize("domain", ["chevron", "horseshoe"])
@each_method
def test_a_minimum_beyond_the_valid_grids_is_not_returned(domain, method):
    start = gg.domain(domain, 11, 11)
    result = gg.optimize(start, "length", method, max_iterations=300)
    assert not result.converged
    assert result.quality.valid
    assert min(step.min_jacobian for step in result.history) > 0
    assert result.energy < gg.energy(start, "length")
    assert_consistent(result, "length")
    if method == "newton":
        assert "keep_valid=False" in result.message


@pytest.mark.parametrize(
    "method",
    ["newton", "local"],
)
def test_corners_outside_of_the_papers_set_are_kept_valid_too(method):
    """Nothing in the paper's sum holds the corners at the boundary, so that keep_valid has to."""
    start = disordered(gg.domain("wavy", 9, 9), 0.4)
    for name in ("area", "length", "winslow"):
        result = gg.optimize(start, name, method, interior_only=True, max_iterations=100)
        assert result.quality.valid, name
        assert result.history[-1].min_jacobian == pytest.approx(result.quality.min_jacobian, rel=1e-12)


@pytest.mark.parametrize("domain", ["chevron", "horseshoe"])
def test_the_folded_minimum_is_returned_where_that_is_asked_for(domain):
    start = gg.domain(domain, 11, 11)
    newton, local = (gg.optimize(start, "length", m, keep_valid=False, tolerance=1e-9) for m in METHODS)
    for result in (newton, local):
        assert result.converged, result.message
        assert result.quality.folded_cells > 0
        assert result.energy < gg.optimize(start, "length", max_iterations=50).energy
    assert farthest(newton.grid, local.grid) < 1e-7


@pytest.mark.parametrize(
    "method",
    [
        "newton",
        "local",
    ],
)
def test_both_methods_do_the_same_with_a_folded_start(method):
    """A start that is folded has nothing to keep, so that the minimum is wanted."""
    result = gg.optimize(gg.domain("swan", 9, 9), "length", method)
    assert result.converged, result.message


# ---- the course of a run ----


@each_method
def test_the_callback_sees_every_step(method):
    steps = []
    result = gg.optimize(mild_grid(), "winslow", method, callback=steps.append)
    assert len(steps) > 2
    assert tuple(steps) == result.history


def test_progress_is_shown_where_it_takes_long(monkeypatch, live_line):
    gg.optimize(mild_grid(), "winslow", "local", max_iterations=2, progress=True)
    assert not live_line, "it did not take long"
    monkeypatch.setattr("gridgen_sym.solvers.run.live.PATIENCE", -1.0)
    gg.optimize(mild_grid(), "winslow", "local", max_iterations=2)
    assert not live_line, "standard error is no terminal"
    result = gg.optimize(mild_grid(), "winslow", "local", max_iterations=2, progress=True)
    assert (live_line[0], live_line[-1], len(live_line)) == ("start", "stop", 5)
    ni, nj = result.grid.shape
    expected = f"winslow, local: minimize {ni} x {nj}, iteration 2, energy {result.energy:.6g}, gradient "
    assert live_line[3].startswith(expected)


@each_method
def test_an_error_in_the_callback_comes_through(method):
    def stop(step):
        if step.iteration == 1:
            raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        gg.optimize(mild_grid(), "winslow", method, callback=stop)


@each_functional
@each_method
def test_no_iterations_return_the_start(name, method):
    start = mild_grid()
    result = gg.optimize(start, name, method, max_iterations=0)
    assert result.grid == start
    assert not result.converged
    assert result.iterations == 0
    assert len(result.history) == 1
    assert "max_iterations" in result.message


@each_method
def test_no_iterations_return_a_start_that_knows_no_more_than_its_boundary(method):
    start = gg.domain("wavy", 33, 33)
    result = gg.optimize(start, "winslow", method, max_iterations=0)
    assert result.grid == start
    assert not result.converged


@each_method
def test_a_number_of_iterations_is_kept(method):
    result = gg.optimize(mild_grid(), "winslow", method, max_iterations=2, tolerance=1e-12)
    assert result.iterations == 2
    assert not result.converged


@pytest.mark.parametrize(
    "name",
    FUNCTIONALS,
)
@each_method
def test_a_stationary_start_converges_at_once(name, method):
    result = gg.optimize(gg.domain("square", 9, 7), name, method, max_iterations=0)
    assert result.converged, result.message
    assert result.grid == gg.domain("square", 9, 7)


@pytest.mark.parametrize(
    "name",
    UNIQUE,
)
@each_method
def test_the_minimum_as_a_start_converges_at_once(name, method):
    minimum = gg.optimize(mild_grid(), name, tolerance=1e-14, max_iterations=30).grid
    again = gg.optimize(minimum, name, method)
    assert again.iterations <= 1, again.message
    assert again.converged, again.message
    assert farthest(again.grid, minimum) < 1e-10


def test_the_start_is_not_changed():
    start = mild_grid()
    before = start.xy
    for method in METHODS:
        gg.optimize(start, "winslow", method)
    assert np.array_equal(start.xy, before)


@pytest.mark.slow
@each_functional
@each_method
def test_the_backends_agree(name, method):
    if find_compiler() is None:
        pytest.skip("needs a C compiler")
    # What creeps or has many minima is compared by its energy alone.
    tolerance = 1e-4 if name in ("area", "orthogonality") else 1e-9
    compiled, plain = (
        gg.optimize(mild_grid(7, 8), name, method, tolerance=tolerance, backend=backend) for backend in ("c", "numpy")
    )
    assert compiled.converged
    assert plain.converged
    assert compiled.energy == pytest.approx(plain.energy, rel=1e-5 if tolerance > 1e-9 else 1e-12)
    if name in UNIQUE:
        assert farthest(compiled.grid, plain.grid) < 1e-7


# ---- size and place ----


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("shift", [0.0, 1e3])
@pytest.mark.parametrize("name", UNITLESS)
@each_method
def test_neither_size_nor_place_matter(scale, shift, name, method):
    start = mild_grid()
    expected = gg.optimize(start, name, method, tolerance=1e-7)
    # The shift is in units of the domain, so that round-off is 1e3 times larger at most.
    result = gg.optimize(gg.Grid((start.xy + shift) * scale), name, method, tolerance=1e-7)
    assert result.converged, result.message
    assert farthest(gg.Grid(result.grid.xy / scale - shift), expected.grid) < 1e-7
    assert result.energy == pytest.approx(expected.energy, rel=1e-9)


@pytest.mark.parametrize("name", FUNCTIONALS)
def test_turning_the_domain_turns_the_result(name):
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    start = mild_grid()
    expected = gg.optimize(start, name, tolerance=1e-9)
    result = gg.optimize(gg.Grid(start.xy @ turn.T), name, tolerance=1e-9)
    assert farthest(gg.Grid(result.grid.xy @ turn), expected.grid) < 1e-6


@pytest.mark.skipif(find_compiler() is None, reason="slow without a compiler")
def test_the_gradient_must_fall_from_that_of_the_start_that_was_given():
    """Coarse grids give a better start, folded like the one that was given; no barrier forbids to compare with that."""
    result = gg.optimize(gg.domain("swan", 33, 33), "knupp")
    norm, ratio = map(float, re.search(r"fallen to (\S+), (\S+) of its first value", result.message).groups())
    assert norm / ratio > 1.4 * result.history[0].gradient_norm


def test_few_steps_without_polyconvexity():
    """Knupp's full Hessian is not positive far from the minimum; clamped and not shifted, it took 38 steps."""
    result = gg.optimize(gg.domain("wavy", 65, 65), "knupp", tolerance=1e-8)
    assert result.converged, result.message
    assert result.iterations <= 30
    assert largest_rise(result) <= 1e-12
