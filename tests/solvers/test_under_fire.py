"""Under fire: whatever the boundary, a valid grid, a proof that there is none, or an honest word on what was found."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support import BUILTIN
from support_boundaries import (
    SEEDS,
    SIZES,
    boundary_grids,
    flat_polygon,
    grid_of_ring,
    smooth_curve,
    star_polygon,
    valid_grids,
)
from support_solvers import BARRIER, METHODS, edges, farthest

import gridgen_sym as gg
from gridgen_sym.functionals.registry import functional
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.folds import Folds
from gridgen_sym.solvers.run.progress import Progress
from gridgen_sym.solvers.untangling.smallest_jacobian import SmallestJacobian
from gridgen_sym.solvers.untangling.strategies import begin_search

from .test_never_worse import SOLVERS

#: A run of a small grid takes hundreds of steps at most; this many mean that it would not end.
_ENDLESS = 20_000

UNTANGLERS = {
    "untangle": gg.untangle,
    "newton": SOLVERS["newton"],
    "local": lambda start, name, **options: gg.optimize(start, name, "local", max_iterations=50, **options),
    "euler-lagrange": SOLVERS["euler-lagrange"],
}

each_untangler = pytest.mark.parametrize("solve", UNTANGLERS.values(), ids=UNTANGLERS)
each_barrier = pytest.mark.parametrize("name", BARRIER)


class Endless(Exception):  # noqa: N818 - a verdict
    """A run took more steps than any that ends."""


def stopwatch():
    """A callback that counts steps, and fails where they do not end."""
    count = 0

    def count_step(step):
        nonlocal count
        count += 1
        if count > _ENDLESS:
            raise Endless

    return count_step


def ring(grid):
    return edges(grid.xy)


def assert_honest(result, start):
    """Check that a result is valid and hides nothing, or is folded and says so, with its cells and a certificate."""
    assert np.isfinite(result.grid.planes).all()
    assert np.array_equal(ring(result.grid), ring(start))
    folded = result.quality.folded_cells
    assert folded <= gg.quality(start).folded_cells
    if folded == 0:
        assert result.certificates == ()
        return
    assert not result.converged
    assert f"{folded} of " in result.message
    for cell in result.quality.folded[:5].tolist():
        assert f"cell ({cell[0]}, {cell[1]})" in result.message
    for proof in result.certificates:
        assert proof.message in result.message
    assert ("No proof was found" in result.message) == all(not proof.impossible for proof in result.certificates)
    assert result.certificates, result.message


@pytest.mark.slow
@each_untangler
@each_barrier
@settings(max_examples=25)
@given(boundary_grids())
def test_any_boundary_gives_a_valid_grid_or_an_honest_answer(solve, name, start):
    """Smooth, polygonal and nearly degenerate ones, of sizes from 1e-9 to 1e9, up to a million sizes away from 0."""
    assert_honest(solve(start, name, callback=stopwatch()), start)


@settings(max_examples=25)
@given(boundary_grids(), st.sampled_from(BUILTIN), st.sampled_from(sorted(SOLVERS)))
def test_any_functional_and_solver_ends_with_a_finite_grid(start, name, solver):
    result = SOLVERS[solver](start, name, max_iterations=30, callback=stopwatch())
    assert np.isfinite(result.grid.planes).all()
    assert np.array_equal(ring(result.grid), ring(start))
    if not result.quality.valid:
        assert "folded" in result.message


def roomy_curves(seed, count):
    """Boundaries that are no thin band: smooth ones, and stars whose radii differ by up to a factor of a million."""
    kinds = [
        (smooth_curve, 0.1),
        (smooth_curve, 0.3),
        (smooth_curve, 0.6),
        (star_polygon, 0.6),
        (star_polygon, 0.3),
        (star_polygon, 1e-6),
    ]
    make, shape = kinds[seed % len(kinds)]
    return make(seed, count, shape)


@pytest.mark.slow
@settings(max_examples=150)
@given(SIZES, SEEDS)
def test_a_roomy_boundary_gives_a_valid_grid_or_a_proof(size, seed):
    result = gg.untangle(grid_of_ring(roomy_curves(seed, 2 * sum(size) - 4), *size))
    assert result.converged or any(proof.impossible for proof in result.certificates), result.message


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(0, 49, 2))
def test_a_thin_band_gives_a_valid_grid_or_a_proof(seed):
    """One of every size. Of a few in a thousand bands only this is proved, that every grid has a sliver."""
    ni, nj = 3 + seed % 7, 3 + seed // 7
    result = gg.untangle(grid_of_ring(flat_polygon(seed, 2 * (ni + nj) - 4, 1e-2), ni, nj))
    assert result.converged or any(proof.impossible for proof in result.certificates), result.message


@each_barrier
@pytest.mark.parametrize(("seed", "ni", "nj"), [(9, 9, 7), (43, 5, 8), (296, 7, 9)])
def test_boundaries_with_edges_of_very_different_lengths_are_gridded(name, seed, ni, nj):
    """The worst fold becomes shallower long after epsilon has fallen below the size of the long edges' cells."""
    start, steps = grid_of_ring(star_polygon(seed, 2 * (ni + nj) - 4, 1e-6), ni, nj), []
    assert gg.quality(start).folded_cells > 0
    result = gg.untangle(start, name, callback=steps.append)
    assert result.converged, result.message
    assert np.isfinite([step.energy for step in steps]).all(), "linear programs had to help"
    assert_honest(result, start)


@pytest.mark.parametrize("angle", [0.0, 0.7])
@pytest.mark.parametrize(("seed", "ni", "nj"), [(42, 5, 9), (54, 6, 7), (93, 8, 8)])
def test_thin_bands_are_gridded(seed, ni, nj, angle):
    """A hundred times as long as wide: nothing that a functional of the angles likes."""
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    start = grid_of_ring(flat_polygon(seed, 2 * (ni + nj) - 4, 1e-2) @ turn, ni, nj)
    assert gg.quality(start).folded_cells > 0
    result = gg.untangle(start)
    assert result.converged, result.message
    assert_honest(result, start)


@pytest.mark.parametrize("solve", [gg.untangle, *(SOLVERS[name] for name in ("newton", "local", "euler-lagrange"))])
def test_a_clockwise_boundary_is_not_worth_a_step(solve):
    steps = []
    start = gg.Grid(gg.domain("zee", 17, 17).xy[::-1])
    result = solve(start, "winslow", callback=steps.append)
    assert len(steps) <= 1
    assert not result.converged
    assert result.grid == start
    assert [proof.kind for proof in result.certificates] == ["clockwise"]
    assert "runs clockwise" in result.message


def narrow_corner():
    """A boundary whose least folded grids, for falling epsilon, lead to a fold that stays; a valid grid exists."""
    return grid_of_ring(smooth_curve(2423, 22, 0.3), 6, 7)


@each_barrier
def test_a_fold_in_a_narrow_corner_is_lifted(name):
    start = narrow_corner()
    result = gg.optimize(start, name)
    assert result.converged, result.message
    assert_honest(result, start)


def test_lifting_reports_its_steps_and_can_be_stopped():
    seen = []

    def stop(step):
        seen.append(step)
        if np.isnan(step.energy):
            raise StopIteration

    result = gg.untangle(narrow_corner(), callback=stop)
    assert result.interrupted
    assert seen[-1].stage == "untangle"
    assert seen[-1].min_jacobian > min(step.min_jacobian for step in seen)
    assert result.quality.folded_cells <= gg.quality(narrow_corner()).folded_cells


def test_raising_the_smallest_jacobian_makes_nothing_worse():
    """Two cells of this long neck cannot both be unfolded: raising the deepest fold would fold more of them."""
    start = grid_of_ring(smooth_curve(3211, 12, 0.6), 5, 3)
    least = gg.untangle(start).grid
    place = least.planes.copy()
    with Progress("smallest Jacobian") as report:
        search = begin_search(make_problem(start, "winslow"), functional("winslow"), place, None, report)
        assert not search.run_into(place, [SmallestJacobian()])
    assert Folds.of(place) <= Folds.of(least.planes)


# ---- never worse ----


@pytest.mark.slow
@pytest.mark.parametrize("solve", SOLVERS.values(), ids=SOLVERS)
@settings(max_examples=25)
@given(valid_grids(), st.sampled_from(BUILTIN))
def test_a_valid_start_stays_valid(solve, start, name):
    assert solve(start, name, max_iterations=20, callback=stopwatch()).quality.valid


# ---- the same grid at any size and place ----


def scales(name):
    """Whether the energy of every grid changes by one factor where the unit of length does."""
    grids = [gg.domain(domain, 5, 5) for domain in ("wavy", "chevron", "horseshoe_map")]
    ratios = [gg.energy(gg.Grid(2 * grid.xy), name) / gg.energy(grid, name) for grid in grids]
    return np.ptp(ratios) < 1e-12 * max(ratios)


HOMOGENEOUS = [name for name in BUILTIN if scales(name)]


def test_most_functionals_are_homogeneous():
    assert set(BUILTIN) - set(HOMOGENEOUS) == {"combined", "area_winslow"}


@settings(max_examples=40)
@given(SIZES, SEEDS, st.sampled_from(HOMOGENEOUS), st.sampled_from(METHODS), st.sampled_from([-30, -3, 1, 30]))
def test_the_unit_of_length_changes_no_bit(size, seed, name, method, power):
    """From 1e-9 to 1e9. A power of two scales every number exactly; any fixed length in a solver would show."""
    start = grid_of_ring(roomy_curves(seed, 2 * sum(size) - 4), *size)
    expected = gg.optimize(start, name, method, max_iterations=20)
    scaled = gg.optimize(gg.Grid(start.xy * 2.0**power), name, method, max_iterations=20)
    assert np.array_equal(scaled.grid.xy, expected.grid.xy * 2.0**power)
    assert scaled.converged == expected.converged


@settings(max_examples=25)
@given(SIZES, SEEDS, st.sampled_from(BARRIER), st.sampled_from([1.0, 1e3, 1e6]))
def test_the_place_does_not_matter(size, seed, name, shift):
    start = grid_of_ring(smooth_curve(seed, 2 * sum(size) - 4, 0.05), *size)
    expected = gg.optimize(start, name)
    assume(expected.converged)
    moved = gg.optimize(gg.Grid(start.xy + shift), name)
    assert moved.converged
    assert farthest(gg.Grid(moved.grid.xy - shift), expected.grid) < 1e-5
