"""Counting folds, and what is cut out or spread around them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support_boundaries import SEEDS, SIZES, grid_of_ring, star_polygon

import gridgen_sym as gg
from gridgen_sym.solvers import harmonic
from gridgen_sym.solvers import subdomains as subdomains_module
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.folds import Folds, mean_jacobian
from gridgen_sym.solvers.harmonic import SIDES, harmonic_extension
from gridgen_sym.solvers.multilevel.prolongation import (
    _displaced,
    _spread,
    coarse_start,
    finer_start,
    from_boundary,
    resample,
)
from gridgen_sym.solvers.subdomains import folded_nodes, restrict, subdomains


def disordered(seed, ni, nj, disorder=0.6):
    """A square of unit cells whose nodes are moved at random: many cells are folded."""
    random = np.random.default_rng(seed)
    nodes = np.stack(np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij")).astype(float)
    return nodes + disorder * random.standard_normal(nodes.shape)


@settings(max_examples=50)
@given(SIZES, SEEDS)
def test_folds_are_those_of_the_quality(size, seed):
    place = disordered(seed, *size)
    quality, problem = gg.quality(gg.Grid.from_planes(*place)), make_problem(gg.Grid.from_planes(*place), "winslow")
    for folds in (Folds.of(place), problem.folds(place)):
        assert folds.cells == quality.folded_cells
        assert folds.depth == pytest.approx(-quality.min_jacobian, rel=1e-12)


def test_folds_are_counted_over_many_rows_as_over_few():
    place = disordered(1, 90, 300, 0.2)
    rows = gg.grids.corner_jacobians(*place).min(axis=(0, 2))
    assert 0 < Folds.of(place).cells == Folds.of(place, rows=rows).cells
    assert Folds.of(place) == Folds.of(place, rows=rows)
    valid = disordered(1, 90, 300, 0.01)
    assert Folds.of(valid).cells == 0
    assert Folds.of(valid, rows=gg.grids.corner_jacobians(*valid).min(axis=(0, 2))) == Folds.of(valid)
    assert mean_jacobian(place) == pytest.approx(np.abs(gg.grids.corner_jacobians(*place)).mean(), rel=0.02)
    assert mean_jacobian(place[:, :9]) == pytest.approx(np.abs(gg.grids.corner_jacobians(*place[:, :9])).mean())


def test_a_corner_that_no_free_node_can_mend_is_not_to_be_mended():
    place = disordered(0, 5, 6, 0.0)
    place[:, 0, 0] = 0.9, 0.9  # J < 0 at the corner of three boundary nodes, and nowhere else.
    problem = make_problem(gg.Grid.from_planes(*place), "winslow")
    assert problem.folds(place).cells == 1
    assert problem.folds(place, mendable=True) == Folds(0, pytest.approx(-0.1))
    assert not folded_nodes(place, problem.fixed).any()


def test_a_number_that_is_none_is_a_fold():
    place = disordered(0, 5, 6, 0.0)
    place[0, 2, 2] = np.nan
    assert Folds.of(place).cells == 4


# ---- subdomains ----


def test_subdomains_hold_what_is_marked_and_its_surroundings():
    marked = np.zeros((40, 50), dtype=bool)
    marked[3, 4] = marked[30, 20] = marked[31, 26] = True
    assert list(subdomains(marked, 3)) == [(slice(0, 7), slice(1, 8)), (slice(27, 35), slice(17, 30))]
    marked[::2, ::2] = True
    assert list(subdomains(marked, 3)) == []  # The whole grid is no subdomain.


@pytest.mark.parametrize("seed", range(40))
def test_few_marks_have_the_subdomains_of_many(monkeypatch, seed):
    random = np.random.default_rng(seed)
    marked = random.random(random.integers(8, 60, 2)) < random.choice((0.0, 0.005, 0.02, 0.1))
    layers = int(random.integers(0, 4))
    monkeypatch.setattr(subdomains_module, "_LARGEST", 1.0)
    found = list(subdomains(marked, layers))
    monkeypatch.setattr(subdomains_module, "_FEW", -1)
    assert found == list(subdomains(marked, layers))


@pytest.mark.parametrize(("ni", "nj"), [(9, 12), (6, 30)])
def test_small_and_large_harmonic_extensions_are_the_same(monkeypatch, ni, nj):
    random = np.random.default_rng(1)
    sides = [random.standard_normal((2, count)) for count in (nj, nj, ni, ni)]
    found = harmonic_extension(*sides)
    monkeypatch.setattr(harmonic, "_SMALL", 0)
    np.testing.assert_allclose(found, harmonic_extension(*sides), rtol=1e-12, atol=1e-14)


def test_what_is_cut_out_is_a_problem_of_its_own():
    grid = gg.domain("swan", 21, 17)
    inner = np.zeros(grid.shape, dtype=bool)
    inner[7, 8] = True
    part, place = restrict(make_problem(grid, "winslow", fixed=inner), grid.planes, (slice(4, 12), slice(5, 14)))
    assert np.array_equal(place, grid.planes[:, 4:12, 5:14])
    assert np.array_equal(np.argwhere(part.fixed[1:-1, 1:-1]), [[2, 2]])
    assert part.fixed[[0, -1]].all()
    assert part.fixed[:, [0, -1]].all()


# ---- what the boundary of a finer grid adds ----


@settings(max_examples=30)
@given(st.integers(3, 14), st.integers(3, 14), SEEDS)
def test_a_harmonic_extension_solves_laplaces_equation(ni, nj, seed):
    field = np.random.default_rng(seed).standard_normal((2, ni, nj))
    field[:, 1:-1, 1:-1] = harmonic_extension(*(field[side][:, 1:-1] for side in SIDES))
    inner = field[:, 1:-1, 1:-1]
    around = field[:, 2:, 1:-1] + field[:, :-2, 1:-1] + field[:, 1:-1, 2:] + field[:, 1:-1, :-2]
    np.testing.assert_allclose(4 * inner, around, atol=1e-12)


def test_what_is_spread_is_the_boundarys_difference():
    """Where that is x² - y², which solves Laplace's equation on the stencil, too, so is all of it."""
    i, j = np.meshgrid(np.arange(15.0), np.arange(19.0), indexing="ij")
    coarse, wave = np.stack((i[::2, ::2], j[::2, ::2])), (i**2 - j**2) * 1e-3
    fine = np.stack((i + wave, j - wave))
    boundary = fine.copy()
    boundary[:, 1:-1, 1:-1] = np.nan
    np.testing.assert_allclose(_spread(coarse, boundary), fine, atol=1e-12)


def test_where_cells_are_halved_new_nodes_are_in_the_middle_of_the_old():
    coarse = disordered(0, 6, 8)
    halved = np.empty((2, 11, 15))
    halved[:, ::2, ::2] = coarse
    halved[:, 1::2, ::2] = (coarse[:, 1:] + coarse[:, :-1]) / 2
    halved[:, :, 1::2] = (halved[:, :, 2::2] + halved[:, :, :-1:2]) / 2
    np.testing.assert_allclose(_spread(coarse, halved), halved, atol=1e-12)


@pytest.mark.parametrize(
    ("given", "wanted"), [((9, 8), (21, 15)), ((7, 5), (9, 7)), ((5, 7), (7, 9)), ((40, 5), (80, 33)), ((4, 4), (9, 6))]
)
def test_resampling_is_exact_for_cubics(given, wanted):
    """Also where one number of nodes was the other before, and over many rows."""

    def field(ni, nj):
        x, y = np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij")
        return np.stack([x**3 - x * y**2, y**3 + x])

    np.testing.assert_allclose(resample(field(*given), wanted, linear=False), field(*wanted), atol=1e-13)


def bump(ni, nj):
    """A field that is zero at the boundary, and cubic along each line."""
    s, t = np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij")
    return np.stack((s * (1 - s) * t * (1 - t) * (1 + s), s * (1 - s) * t * (1 - t) * (2 - t)))


def test_a_smooth_displacement_is_carried_to_the_finer_grid():
    coarse = from_boundary(gg.domain("wavy", 9, 7).planes) + bump(9, 7)
    fine = from_boundary(gg.domain("wavy", 20, 15).planes)
    np.testing.assert_allclose(_displaced(coarse, fine), fine + bump(20, 15), atol=1e-13)


def test_a_coarse_start_has_the_boundary_between_its_nodes_as_straight_lines():
    fine = gg.domain("wavy", 12, 9).planes
    start = coarse_start(fine, (8, 4))
    assert start.shape == (2, 8, 4)
    for mine, side in ((start[:, :, 0], fine[:, :, 0]), (start[:, -1], fine[:, -1]), (start[:, 0], fine[:, 0])):
        at = np.linspace(0, side.shape[1] - 1, mine.shape[1])
        expected = [np.interp(at, np.arange(side.shape[1]), component) for component in side]
        np.testing.assert_allclose(mine, expected, atol=1e-14)
    np.testing.assert_array_equal(start, from_boundary(start))


@pytest.mark.parametrize(
    ("cells", "best", "asked"),
    [((0, 0, 0), 0, 1), ((5, 0, 0), 1, 2), ((5, 2, 0), 1, 2), ((5, 3, 0), 2, 3), ((5, 3, 4), 1, 3), ((5, 5, 5), 0, 3)],
)
def test_the_ways_to_a_finer_start_are_tried_in_turn(cells, best, asked, monkeypatch):
    """The dearest only where more than 2 % of the cells are folded: here more than 2 of 100."""
    ways, seen = [np.full((2, 10, 10), float(k)) for k in range(3)], []

    def folds(place):
        seen.append(place)
        return Folds(cells[int(place[0, 0, 0])], 1.0)

    for name, way in zip(("_displaced", "_spread", "from_boundary"), ways, strict=True):
        monkeypatch.setattr(f"gridgen_sym.solvers.multilevel.prolongation.{name}", lambda *_, way=way: way)
    start = finer_start(SimpleNamespace(folds=folds), ways[0], ways[0])
    assert start[0, 0, 0] == best
    assert len(seen) == asked


@pytest.mark.parametrize("seed", range(6))
def test_the_least_folded_start_is_taken(seed):
    ring = star_polygon(seed, 2 * (21 + 21) - 4, 0.5)
    grid = grid_of_ring(ring, 21, 21)
    problem, coarse = make_problem(grid, "winslow"), gg.untangle(gg.domain("square", 11, 11)).grid.planes
    interpolated = from_boundary(grid.planes)
    ways = _displaced(coarse, interpolated), _spread(coarse, interpolated), interpolated
    assert problem.folds(finer_start(problem, coarse, grid.planes)) == min(problem.folds(way) for way in ways)
