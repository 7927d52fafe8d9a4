"""Coarse grids of a boundary: which lines they keep, how they are refined, and how the boundary comes to its place."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gridgen_sym as gg
from gridgen_sym.functionals.registry import functional
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.folds import Folds
from gridgen_sym.solvers.harmonic import SIDES
from gridgen_sym.solvers.run.deadline import Deadline, StopRequest
from gridgen_sym.solvers.run.progress import Progress
from gridgen_sym.solvers.run.status import StopReason
from gridgen_sym.solvers.untangling.boundary_continuation import move_boundary
from gridgen_sym.solvers.untangling.coarse_grids import CoarseGrids, divided, kept_lines
from gridgen_sym.solvers.untangling.strategies import begin_search


def valid_coarse_grid(seed, ni, nj):
    """Unit cells whose nodes are moved at random, as far as all cells stay convex."""
    nodes = np.stack(np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij")).astype(float)
    moves = np.random.default_rng(seed).standard_normal(nodes.shape)
    while Folds.of(nodes + moves).cells:
        moves /= 2
    return nodes + moves


@settings(max_examples=50)
@given(
    st.integers(0, 10**6), st.lists(st.integers(1, 4), min_size=2, max_size=5), st.lists(st.integers(1, 4), min_size=2)
)
def test_a_divided_valid_grid_is_valid_and_has_its_nodes(seed, along_i, along_j):
    lines = tuple(np.cumsum([0, *cells[:5]]) for cells in (along_i, along_j))
    coarse = valid_coarse_grid(seed, *(len(kept) for kept in lines))
    fine = divided(coarse, lines)
    assert fine.shape[1:] == tuple(kept[-1] + 1 for kept in lines)
    assert np.array_equal(fine[:, lines[0]][:, :, lines[1]], coarse)
    assert Folds.of(fine).cells == 0


def test_a_sharp_turn_is_kept_on_the_coarse_grid():
    """The top turns at node 5, and not at nodes 4 and 6, which every second line would keep."""
    x = np.arange(13.0)
    bottom, top = np.stack((x, 0 * x), axis=1), np.stack((x, 4 + np.abs(x - 5)), axis=1)
    y = np.linspace(0, 1, 7)[:, None]
    left, right = bottom[0] + y * (top[0] - bottom[0]), bottom[-1] + y * (top[-1] - bottom[-1])
    start = gg.transfinite(bottom, top, left, right).planes
    i, j = kept_lines(start, (2, 2))
    assert 5 in i
    assert len(i) == 7
    assert (i[0], i[-1]) == (0, 12)
    assert (np.diff(i) > 0).all()
    assert j.tolist() == [0, 2, 4, 6]
    assert kept_lines(start, (2, 3)) is None, "too few lines"


@given(st.integers(0, 10**6), st.integers(9, 40), st.integers(9, 40), st.sampled_from([1, 2, 3]))
def test_kept_lines_are_in_order_and_have_both_ends(seed, ni, nj, stride):
    boundary = np.random.default_rng(seed).standard_normal((2, ni, nj))
    found = kept_lines(boundary, (stride, stride))
    for kept, count in zip(found or (), (ni, nj), strict=False):
        assert (kept[0], kept[-1]) == (0, count - 1)
        assert (np.diff(kept) > 0).all()
        assert len(kept) == max((count - 1) // stride, 1) + 1


def bay():
    """A square of 17 x 17 nodes, and the same with a bay in its bottom that is 6 cells deep."""
    square = gg.domain("square", 17, 17).planes
    bottom = square[:, :, 0].copy()
    bottom[1] += 6 / 16 * np.exp(-(((bottom[0] - 0.5) / 0.1) ** 2))
    bottom[1, [0, -1]] = 0.0
    deep = square.copy()
    deep[:, :, 0] = bottom
    return square, deep


def test_the_boundary_moves_and_every_cell_stays_valid():
    square, deep = bay()
    moved, problem = square.copy(), make_problem(gg.Grid.from_planes(*square), "winslow")
    steps = []
    with Progress("move", steps.append, show=False) as report:
        assert move_boundary(problem, moved, deep, report)
    for side in SIDES:
        assert np.array_equal(moved[side], deep[side])
    assert Folds.of(moved).cells == 0
    assert steps
    assert all(step.min_jacobian > 0 for step in steps)


def test_a_boundary_that_admits_no_grid_is_not_reached_and_the_grid_stays_valid():
    square, deep = bay()
    deep[1, 5:12, 0] += 2.0  # Beyond the top.
    moved, problem = square.copy(), make_problem(gg.Grid.from_planes(*square), "winslow")
    with Progress("move", show=False) as report:
        assert not move_boundary(problem, moved, deep, report)
    assert Folds.of(moved).cells == 0


class Over(Deadline):
    """A time that is over at once."""

    def check(self):
        raise StopRequest(StopReason.TIME_LIMIT, "over")


def test_it_honors_the_deadline():
    square, deep = bay()
    with pytest.raises(StopRequest):
        move_boundary(
            make_problem(gg.Grid.from_planes(*square), "winslow"), square.copy(), deep, Progress("", deadline=Over())
        )


@pytest.mark.parametrize("name", ["swan", "zee"])
def test_a_folded_start_becomes_valid_by_coarse_grids_alone(name):
    start = gg.domain(name, 33, 33)
    search = begin_search(make_problem(start, "winslow"), functional("winslow"), start.planes, None, Progress("coarse"))
    search.run([CoarseGrids(((2, 2),))])
    assert search.valid
    assert search.untangled_by == "refined coarse grids"
    for side in SIDES:
        assert np.array_equal(search.best.coordinates[side], start.planes[side])


def test_fixed_inner_nodes_and_small_grids_are_left_to_others():
    start = gg.domain("swan", 33, 33)
    fixed = np.zeros(start.shape, dtype=bool)
    fixed[5, 5] = True
    for mask, strategy in ((fixed, CoarseGrids(((2, 2),))), (None, CoarseGrids(((2, 2),), fewest_nodes=33 * 33 + 1))):
        problem = make_problem(start, "winslow", fixed=mask)
        search = begin_search(problem, functional("winslow"), start.planes, None, Progress("coarse"))
        search.run([strategy])
        assert np.array_equal(search.best.coordinates, start.planes)
