"""Proofs that every grid of a boundary has a sliver: that they are never wrong, and that they are found."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from support_boundaries import flat_polygon, grid_of_ring, valid_grids

import gridgen_sym as gg
from gridgen_sym.certificates import proofs, search
from gridgen_sym.certificates.branching import DEFAULT_BUDGET, Conflict, feasible_regions
from gridgen_sym.certificates.expected_jacobians import expected_jacobians
from gridgen_sym.certificates.search import JACOBIAN_FRACTIONS, find_sliver
from gridgen_sym.errors import GridgenError
from gridgen_sym.grids import corner_jacobians
from gridgen_sym.grids.grid import boundary_indices
from gridgen_sym.solvers import minimization
from gridgen_sym.solvers.untangling.strategies import REGULARIZED, ProofSearch, SliverSearch


def band(seed, ni, nj):
    return grid_of_ring(flat_polygon(seed, 2 * (ni + nj) - 4, 1e-2), ni, nj)


#: Bands for which neither a valid grid nor a proof is found that there is none, and a fraction that none exceeds.
OPEN = {"a": (band(10, 8, 9), 0.1), "b": (band(100431, 7, 8), 0.01), "c": (band(100105, 8, 9), 0.003)}
each_open = pytest.mark.parametrize(
    "name", [name if name == "a" else pytest.param(name, marks=pytest.mark.slow) for name in OPEN]
)


def inside_area(grid):
    ring = grid.planes[:, *boundary_indices(*grid.shape).T]
    x, y = ring - ring[:, :1]  # Far from 0, products would be too inexact.
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def jacobian_fractions(grid):
    """The corner Jacobians (4, ni-1, nj-1) as parts of what is expected of them."""
    return corner_jacobians(grid.x, grid.y) / (expected_jacobians(grid) * inside_area(grid))


def rectangle(x, y):
    return gg.Grid(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))


@pytest.mark.parametrize("scale", [1e-200, 1e-9, 1.0, 1e200])
def test_grids_between_parallel_sides_are_as_expected(scale):
    """Rectangles with any spacing, and trapezoids, whichever side is short: at each corner, not only of each cell."""
    x, y = np.array([0.0, 0.1, 0.3, 1.0]) * 5, np.array([0.0, 0.5, 0.6, 0.7, 1.0]) * 2
    grid = rectangle(x, y)
    assert expected_jacobians(grid).sum(axis=0) / 4 == pytest.approx(np.outer(np.diff(x), np.diff(y)) / 10)
    narrowing = np.stack(((grid.x - 2.5) * (2.1 - grid.y), grid.y), axis=-1)
    for xy in (grid.xy, narrowing, narrowing[::-1, ::-1], narrowing.transpose(1, 0, 2)[:, :, ::-1]):
        measured = corner_jacobians(*xy.transpose(2, 0, 1))
        expected = expected_jacobians(gg.Grid(scale * xy))
        assert expected.sum() / 4 == pytest.approx(1.0)
        assert measured / (expected * inside_area(gg.Grid(xy))) == pytest.approx(1.0)
    assert jacobian_fractions(grid) == pytest.approx(1.0)


def test_a_ring_is_as_expected():
    s, t = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 5), indexing="ij")
    radius = 0.01 + t
    ring = gg.Grid(np.stack((radius * np.cos(-np.pi * s), radius * np.sin(-np.pi * s)), axis=-1))
    assert jacobian_fractions(ring) == pytest.approx(1.0, abs=0.01)


def test_very_short_edges_count_as_they_are():
    """Arc lengths would not tell them from nothing."""
    x, y = np.array([-1.0, -0.5, -1e-20, 0.0]), np.linspace(0, 1, 4)
    expected = expected_jacobians(rectangle(x, y))
    assert expected[2] == pytest.approx(np.outer([0.5, 0.5, 1e-20], np.ones(3) / 3), rel=1e-9, abs=0)


def test_huge_sides_do_not_overflow():
    x, y = np.array([-1.7e308, 0.0, 1.7e308]), np.array([-1.0, 0.0, 1.0])
    assert expected_jacobians(rectangle(x, y)) == pytest.approx(1 / 4)


def test_a_side_without_length_says_nothing():
    """In a window of a grid there may be one, if fixed nodes are one point."""
    xy = gg.domain("square", 5, 3).xy
    xy[:, 0] = xy[0, 0]
    expected = expected_jacobians(gg.Grid(xy))
    assert (expected[:2, :, 0] == 0).all()
    assert (expected[2:, :, 0] > 0).all()
    assert isinstance(feasible_regions(gg.Grid(xy), jacobian_fraction=0.1), Conflict)
    xy[:, -1] = xy[0, -1]
    assert (expected_jacobians(gg.Grid(xy)) == 0).all()


def test_a_boundary_with_a_good_grid_has_no_sliver():
    """One side is ten thousand times as long as the other: cells are as small there as is expected."""
    s = np.linspace(0, 1, 6)
    bottom, top = np.stack((s, 0 * s), axis=-1), np.stack((1e4 * s, 0 * s + 1e4), axis=-1)
    left, right = (np.outer(1 - s, side[0]) + np.outer(s, side[1]) for side in ((bottom[k], top[k]) for k in (0, -1)))
    good = gg.transfinite(bottom, top, left, right)
    assert gg.quality(good).min_scaled_jacobian > 0.5
    assert jacobian_fractions(good).min() > 0.5
    folded = good.xy
    folded[2, 2] = folded[4, 4]
    assert gg.sliver_certificate(gg.Grid(folded)) is None


@settings(max_examples=15)
@given(valid_grids())
def test_no_grid_exceeds_what_is_proved(grid):
    """A valid grid has the fraction that it has: no proof may exclude it, or a larger one."""
    smallest = float(jacobian_fractions(grid).min())
    assert not isinstance(feasible_regions(grid, budget=500, jacobian_fraction=smallest * (1 - 1e-9)), Conflict)


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=[pytest.mark.slow] * (seed > 4)) for seed in range(40)])
def test_of_3_x_3_nodes_the_largest_fraction_is_known(seed):
    """Every Jacobian is affine in the one inner node, so that a linear program says which fraction is the largest."""
    from scipy.optimize import linprog

    xy = gg.domain("square", 3, 3).xy
    random = np.random.default_rng(seed)
    xy += 0.5 * random.random() * random.normal(size=xy.shape)
    if gg.certificates(gg.Grid(xy)):
        return

    def jacobians(x, y):
        xy[1, 1] = x, y
        return jacobian_fractions(gg.Grid(xy)).ravel()

    at_0 = jacobians(0, 0)
    slopes = np.stack([jacobians(1, 0) - at_0, jacobians(0, 1) - at_0], axis=-1)
    held = (np.abs(slopes) < 1e-12).all(axis=1)  # At the logical corners all nodes are fixed.
    answer = linprog(
        [0, 0, -1],
        A_ub=np.c_[-slopes, np.ones(16)][~held],
        b_ub=at_0[~held],
        bounds=[(-1e3, 1e3)] * 2 + [(None, None)],
    )
    largest = -answer.fun
    if largest < 1e-6:
        return
    grid = gg.Grid(xy)
    assert not isinstance(feasible_regions(grid, jacobian_fraction=largest * (1 - 1e-6)), Conflict)
    assert isinstance(feasible_regions(grid, jacobian_fraction=largest * (1 + 1e-6)), Conflict)


@cache
def sliver_of(name):
    return find_sliver(OPEN[name][0])


@pytest.mark.slow
@each_open
def test_where_nothing_else_is_known_every_grid_has_a_sliver(name):
    (start, fraction), found = OPEN[name], sliver_of(name)
    assert found is not None
    assert found.jacobian_fraction == fraction
    assert len(found.cells) <= 6, "of 9 and more cells with which the proof was found, most can be left out"
    # The proof needs no other cells, and does not reach a smaller fraction.
    smaller = JACOBIAN_FRACTIONS[JACOBIAN_FRACTIONS.index(fraction) + 1]
    again = feasible_regions(start, found.cells, jacobian_fraction=fraction)
    assert isinstance(again, Conflict)
    assert set(again.cells) <= set(found.cells)
    assert not isinstance(feasible_regions(start, found.cells, jacobian_fraction=smaller), Conflict)


def test_its_certificate_says_what_is_proved_and_no_more(monkeypatch):
    start, fraction = OPEN["a"]
    monkeypatch.setattr(proofs, "find_sliver", lambda *_: sliver_of("a"))
    proof = gg.sliver_certificate(start)
    assert proof.kind == "sliver"
    assert not proof.impossible
    assert proof.numbers == {"cells": len(proof.nodes) / 4, "jacobian_fraction": fraction}
    assert "no valid grid exists" not in proof.message
    assert f"can exceed {100 * fraction:g} % of the area predicted from the boundary spacing" in proof.message
    for i, j in proof.nodes[::4]:
        assert f"({i}, {j})" in proof.message
    assert all(other.impossible for other in gg.certificates(band(9, 3, 5), search=True))


@pytest.mark.slow
def test_an_undecided_result_carries_it(monkeypatch):
    """What takes long, and does not help, is left out."""
    searches = ProofSearch(DEFAULT_BUDGET), SliverSearch(DEFAULT_BUDGET)
    monkeypatch.setattr(minimization, "STRATEGIES", (*REGULARIZED, *searches))
    start, fraction = OPEN["a"]
    result = gg.untangle(start)
    assert not result.converged
    (proof,) = result.certificates
    assert (proof.kind, proof.numbers["jacobian_fraction"]) == ("sliver", fraction)
    assert "No proof was found that there is no valid grid" in result.message
    assert proof.message in result.message
    assert "cells cannot all be valid" not in result.message


@each_open
def test_the_larger_the_budget_the_smaller_a_fraction_is_proved(name):
    start, fraction = OPEN[name]
    assert gg.sliver_certificate(start, budget=1) is None
    assert gg.sliver_certificate(start, budget=1000).numbers["jacobian_fraction"] >= fraction


def test_there_is_none_where_a_grid_is_valid_or_a_quick_proof_says_more():
    grid = gg.optimize(gg.domain("swan", 11, 11), "winslow").grid
    assert gg.sliver_certificate(grid) is None
    clockwise = gg.Grid(OPEN["a"][0].xy[::-1])
    assert gg.certificates(clockwise)
    assert gg.sliver_certificate(clockwise) is None


def test_what_the_check_raises_ends_the_search(monkeypatch):
    """That for a proof, and then that for fewer cells."""

    def check():
        raise TimeoutError

    start, found = OPEN["a"][0], sliver_of("a")
    with pytest.raises(TimeoutError):
        gg.sliver_certificate(start, budget=1, check=check)
    monkeypatch.setattr(search, "_first_conflict", lambda *_: found)
    with pytest.raises(TimeoutError):
        gg.sliver_certificate(start, check=check)


@pytest.mark.parametrize("budget", [0, 2.5, "long"])
def test_a_budget_must_be_a_positive_integer(budget):
    with pytest.raises(GridgenError, match=f"budget must be an integer, at least 1, .* came {budget!r}"):
        gg.sliver_certificate(OPEN["a"][0], budget=budget)


def test_its_picture_names_it(tmp_path, monkeypatch):
    start, _ = OPEN["a"]
    monkeypatch.setattr(proofs, "find_sliver", lambda *_: sliver_of("a"))
    proof = gg.sliver_certificate(start)
    figure = gg.plot_certificates(start, tmp_path / "why.png", found=[proof])
    whole, panel = figure.axes
    assert whole.get_title() == "every valid grid has a sliver"
    assert panel.get_title().startswith(f"1: one of {proof.numbers['cells']:.0f} cells is a sliver")
    assert len(panel.patches) >= proof.numbers["cells"]


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "ni", "nj"), [(2480, 6, 8), (106180, 7, 9), (511, 8, 9)])
def test_from_the_regions_of_the_best_grids_a_valid_one_is_found(seed, ni, nj):
    """From the feasible regions of all valid grids alone none was found."""
    assert gg.untangle(band(seed, ni, nj)).converged
