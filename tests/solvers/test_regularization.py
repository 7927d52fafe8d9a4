"""Untangling: the path of the regularized barrier, and the strategies that follow it."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.functionals import functional
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.folds import Folds, mean_jacobian
from gridgen_sym.solvers.run.deadline import StopRequest
from gridgen_sym.solvers.run.progress import Progress
from gridgen_sym.solvers.run.status import StopReason
from gridgen_sym.solvers.untangling import regularization, strategies
from gridgen_sym.solvers.untangling.all_nodes import AllNodes
from gridgen_sym.solvers.untangling.folded_nodes import FoldedNodes
from gridgen_sym.solvers.untangling.folded_subdomains import FoldedSubdomains
from gridgen_sym.solvers.untangling.regularization import _ended, path, regularized
from gridgen_sym.solvers.untangling.search import BestSoFar, Search
from gridgen_sym.solvers.untangling.strategies import begin_search, untangle_regularized

WINSLOW = functional("winslow")


def folded(depth):
    """Unit cells, one of them with a corner whose Jacobian is minus `depth`, and where that is."""
    place = np.stack(np.meshgrid(np.arange(7.0), np.arange(6.0), indexing="ij"))
    place[:, 3, 3] = 2.5 - depth / 2
    smallest = gg.quality(gg.Grid.from_planes(*place)).min_jacobian
    return place, -smallest


def follow(place, monkeypatch, lower=lambda regular, place: None):
    """Follow the path from a grid, and return the epsilons on it."""
    seen = []
    monkeypatch.setattr(regularization, "regularized", lambda *arguments: seen.append(arguments[3]))
    problem = make_problem(gg.Grid.from_planes(*place), "winslow")
    for _ in path(problem, WINSLOW, place, None, lower):
        pass
    return seen


@pytest.mark.parametrize("depth", [1.0, 1e-6])
def test_epsilon_begins_at_the_fold_or_at_the_size_of_a_cell_and_falls(depth, monkeypatch):
    place, deepest = folded(depth)
    first = max(0.2 * deepest, 0.02 * mean_jacobian(place))
    assert follow(place, monkeypatch) == pytest.approx(first * 0.3 ** np.arange(4))


def test_it_ends_at_the_first_grid_that_cannot_be_mended_further(monkeypatch):
    place, _ = folded(1.0)
    valid, steps = folded(-1.0)[0], count(1)

    def lower(regular, place):
        if next(steps) == 2:
            place[...] = valid

    assert len(follow(place, monkeypatch, lower)) == 2
    assert follow(valid, monkeypatch) == []
    valid[:, 0, 0] = 0.9, 0.9  # Folded at a corner whose three nodes are fixed.
    assert follow(valid, monkeypatch) == []


def test_it_ends_where_rounding_decides(monkeypatch):
    """However well it goes."""
    place = 1e-3 * folded(1.0)[0]
    monkeypatch.setattr(regularization, "_ended", lambda *_: False)
    last = follow(place, monkeypatch)[-1]
    assert last > 1e-12 * mean_jacobian(place) > 0.3 * last


@pytest.mark.parametrize(
    ("cells", "depths", "ended"),
    [
        ((3, 3, 3), (1, 1, 1), False),
        ((3, 3, 3, 3), (1, 1, 1, 1), True),
        ((3, 3, 3, 2), (1, 1, 1, 1), False),
        ((3, 2, 3, 3), (1, 1, 1, 1), False),
        ((2, 3, 3, 3), (1, 1, 1, 1), True),
        ((3, 2, 3, 3, 2), (1, 1, 1, 1, 1), True),
        ((3, 3, 3, 3), (1, 1, 1, 0.89), False),
        ((3, 3, 3, 3), (1, 1, 0.89, 1), False),
        ((3, 3, 3, 3), (1, 1, 1, 0.91), True),
        ((3, 3, 3, 3), (0.5, 1, 1, 0.5), True),
        ((3, 4, 4, 4), (1, 1, 1, 0.5), False),
    ],
)
def test_progress_is_less_cells_or_a_shallower_fold_in_three_falls(cells, depths, ended):
    assert _ended([Folds(*fold) for fold in zip(cells, depths, strict=True)]) == ended


def test_a_regularized_problem_has_no_barrier_no_weight_and_all_corners():
    grid = gg.domain("wavy", 9, 9)
    fixed = np.zeros(grid.shape, dtype=bool)
    fixed[4, 4] = True
    definition = functional("area_winslow")
    problem = make_problem(grid, definition, weight="1 + x**2", fixed=fixed, interior_only=True)
    regular = regularized(problem, definition, None, 1e-3)
    assert not regular.kernels.barrier
    assert regular.inputs is None
    assert not regular.interior_only
    assert np.array_equal(regular.fixed, problem.fixed)
    k = {"k": 1e-3}
    plain = make_problem(grid, definition, parameters=k, spacing="index").energy(grid.planes)[0]
    sharp, blunt = (regularized(problem, definition, k, epsilon).energy(grid.planes)[0] for epsilon in (1e-12, 1.0))
    assert sharp == pytest.approx(plain)
    assert blunt != pytest.approx(plain, rel=0.1)


def test_the_first_valid_grid_is_the_last():
    seen = []
    result = gg.untangle(gg.domain("zee", 17, 17), callback=lambda step: seen.append((step.stage, step.min_jacobian)))
    assert result.converged
    stages, jacobians = zip(*seen, strict=True)
    assert set(stages) == {"untangle"}
    assert len(seen) > 3
    assert [smallest > 0 for smallest in jacobians] == [False] * (len(seen) - 1) + [True]


def test_nothing_is_done_where_nothing_can_be_mended():
    place, _ = folded(-1.0)
    place[:, 0, 0] = 0.9, 0.9  # Folded at a corner whose three nodes are fixed.
    start = place.copy()
    with Progress("unfold", show=False) as report:
        assert not untangle_regularized(
            make_problem(gg.Grid.from_planes(*place), "winslow"), WINSLOW, place, None, report
        )
    assert report.history == []
    assert np.array_equal(place, start)


# ---- the strategies ----


class Fake:
    """A strategy that does what it is given."""

    def __init__(self, name, does):
        self.name, self.does = name, does

    def run(self, search):
        self.does(search)


@pytest.mark.parametrize("enough", [0, 1, 2])
def test_strategies_are_tried_in_turn_until_one_is_enough_which_is_named(enough):
    (place, _), (valid, _) = folded(1.0), folded(-1.0)
    tried = []

    def does(k):
        def run(search):
            tried.append(k)
            if k == enough:
                search.best.offer(valid)

        return Fake(f"strategy {k}", run)

    search = begin_search(make_problem(gg.Grid.from_planes(*place), "winslow"), WINSLOW, place, None, Progress(""))
    search.run(map(does, range(3)))
    assert tried == list(range(enough + 1))
    assert search.valid
    assert search.untangled_by == f"strategy {enough}"


def test_a_proof_ends_the_search_and_names_no_strategy():
    place, _ = folded(1.0)
    proof = gg.Certificate("conflict", (), (0.0, 0.0), {}, "a conflict")
    search = begin_search(make_problem(gg.Grid.from_planes(*place), "winslow"), WINSLOW, place, None, Progress(""))
    search.run([Fake("proof", lambda found: setattr(found, "certificates", (proof,))), Fake("more", pytest.fail)])
    assert not search.valid
    assert search.untangled_by == ""


def test_every_strategy_has_a_name_of_its_own_kind():
    names = {type(strategy): strategy.name for strategy in strategies.STRATEGIES}
    assert len(set(names.values())) == len(names)
    assert all(names.values())


def test_the_least_folded_grid_is_kept():
    deep, shallow, valid = (folded(depth)[0] for depth in (0.4, 0.3, -1.0))
    least = BestSoFar(make_problem(gg.Grid.from_planes(*deep), "winslow"), deep)
    cells = least.folds.cells
    least.offer(shallow)
    assert least.folds.cells == cells
    least.offer(deep)
    assert np.array_equal(least.coordinates, shallow)
    offered = valid.copy()
    least.offer(offered)
    offered[...] = 0.0
    assert np.array_equal(least.coordinates, valid)
    assert least.folds.cells == 0


def test_whatever_ends_it_the_least_folded_grid_is_left(monkeypatch):
    def stopped(self, search):
        search.best.offer(valid)
        raise StopRequest(StopReason.CALLBACK, "enough")

    (place, _), (valid, _) = folded(1.0), folded(-1.0)
    monkeypatch.setattr(FoldedNodes, "run", stopped)
    with pytest.raises(StopRequest):
        untangle_regularized(
            make_problem(gg.Grid.from_planes(*place), "winslow"), WINSLOW, place, None, Progress("", show=False)
        )
    assert np.array_equal(place, valid)


def search(knot):
    """A search from a uniform grid of which a square of so many nodes is inverted."""
    place = np.stack(np.meshgrid(np.arange(41.0), np.arange(41.0), indexing="ij"))
    inside = np.s_[:, 10 : 10 + knot, 10 : 10 + knot]
    place[inside] = place[inside][:, ::-1, ::-1]
    problem = make_problem(gg.Grid.from_planes(*place), "winslow")
    return begin_search(problem, WINSLOW, place, None, Progress("search", show=False))


def moved(found):
    return np.argwhere((found.best.coordinates != found.start).any(axis=0))


def test_a_window_is_unfolded_by_itself():
    found = search(5)
    assert not found.done
    FoldedSubdomains().run(found)
    assert found.done
    assert moved(found).min() >= 10 - 1 - 12
    assert moved(found).max() <= 14 + 1 + 12


def test_a_window_begins_at_the_least_folded_grid_and_gives_back_whatever_ends_it(monkeypatch):
    given, found = [], search(5)
    found.parameters = {"k": 2.0}
    found.best.coordinates = found.start + 100.0  # As folded as the start, and distinguished from it.

    def stopped(search, problem, place):
        given.append(search.parameters)
        place[...] = place[:, :1, :1] + np.indices(place.shape[1:])
        raise StopRequest(StopReason.CALLBACK, "enough")

    monkeypatch.setattr(Search, "untangle_part", stopped)
    with pytest.raises(StopRequest):
        FoldedSubdomains().run(found)
    assert given == [found.parameters]
    assert np.array_equal(found.best.coordinates, 100.0 + np.indices((41, 41)))


def test_only_few_folds_are_unfolded_node_by_node():
    """Here less than 2 % of the cells, and more."""
    few, many = search(3), search(15)
    FoldedNodes().run(few)
    FoldedNodes().run(many)
    assert len(moved(few)) > 0
    assert len(moved(many)) == 0
    assert few.best.folds.cells < 0.02 * 41**2 < many.best.folds.cells


def test_all_nodes_are_moved_if_nothing_else_helps():
    found = search(9)
    AllNodes().run(found)
    assert found.done
    assert len(moved(found)) > 0.9 * 39**2
