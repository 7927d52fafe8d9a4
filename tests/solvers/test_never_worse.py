"""Never worse: a valid start gives a valid result, whatever the solver, the functional, or what ends the run."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest
from support import BUILTIN
from support_solvers import BARRIER, disordered, edges

import gridgen_sym as gg
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.folds import Folds
from gridgen_sym.solvers.iterate import Iterate
from gridgen_sym.solvers.multilevel.prolongation import finer_start, from_boundary
from gridgen_sym.solvers.newton.line_search import LineSearch

SOLVERS = {
    "newton": lambda start, name, **options: gg.optimize(start, name, **options),
    "local": lambda start, name, **options: gg.optimize(start, name, "local", **options),
    "euler-lagrange": lambda start, name, **options: gg.solve_euler_lagrange(start, name, **options),
    "relaxation": lambda start, name, **options: gg.solve_euler_lagrange(start, name, "relaxation", **options),
}

each_solver = pytest.mark.parametrize("solve", SOLVERS.values(), ids=SOLVERS)
each_functional = pytest.mark.parametrize("name", BUILTIN)


@each_solver
@each_functional
@pytest.mark.parametrize("domain", ["chevron", "horseshoe", "indented_square"])
def test_a_valid_start_gives_a_valid_result(solve, name, domain):
    start = disordered(gg.domain(domain, 11, 9), 0.3)
    assert solve(start, name, max_iterations=60).quality.valid


@pytest.mark.parametrize("solver", SOLVERS)
def test_step_control_says_when_it_acted(solver):
    start = gg.domain("chevron", 21, 21)
    held = SOLVERS[solver](start, "length", max_iterations=100)
    free = SOLVERS[solver](start, "length", max_iterations=2000, keep_valid=False)
    assert free.converged
    assert not free.quality.valid
    assert held.quality.valid
    assert not held.converged
    assert "keep_valid=False" in held.message


def test_steps_that_were_cut_are_counted():
    """Newton's steps stop just before the first folded cell; a barrier's own line search is nothing to tell."""
    start = gg.domain("chevron", 21, 21)
    assert "cut short so that no cell folds" in gg.optimize(start, "length", max_iterations=3).message
    assert "cut short" not in gg.optimize(start, "winslow", max_iterations=3).message
    assert "cut short" not in gg.optimize(gg.domain("wavy", 9, 9), "length").message


def test_a_weight_that_raises_the_energy_after_each_step_does_not_hide_its_progress(monkeypatch):
    """Steps that a barrier cuts are progress as long as they lower the energy with the weight that they have seen."""
    rises = count()

    def evaluate(self, evaluate=Iterate.evaluate):
        evaluate(self)
        self.energy += 10.0 ** next(rises)

    def cut(self, direction, along=LineSearch.along):
        found, self.folds = along(self, direction), True
        return found

    monkeypatch.setattr(Iterate, "evaluate", evaluate)
    monkeypatch.setattr(LineSearch, "along", cut)
    result = gg.optimize(disordered(gg.domain("chevron", 13, 13), 0.3), "winslow", tolerance=1e-14)
    assert "would fold a cell" not in result.message
    assert result.iterations > 5


def test_a_weight_that_never_lets_the_grid_settle_is_named():
    random = np.random.default_rng(0)
    start = disordered(gg.domain("square", 13, 13), 0.3)
    result = gg.optimize(start, "length", weight=lambda x, y: 1 + 5 * random.random() * x)
    assert not result.converged
    assert result.quality.valid
    assert "does not settle" in result.message
    assert result.status is gg.Status.UNSETTLED
    assert 50 <= result.iterations < 1000


@each_solver
@pytest.mark.parametrize("name", ["winslow", "length"])
@pytest.mark.parametrize("stop", [KeyboardInterrupt, StopIteration])
def test_whatever_stops_a_run_leaves_a_valid_grid(solve, name, stop):
    start, calls = disordered(gg.domain("chevron", 17, 17), 0.3), count()

    def callback(step):
        if next(calls) == 2:
            raise stop

    result = solve(start, name, callback=callback)
    assert result.interrupted
    assert result.stopped_by == ("callback" if stop is StopIteration else "Ctrl-C")
    assert not result.converged
    assert result.quality.valid
    assert ("callback stopped it" if stop is StopIteration else "interrupted") in result.message


@each_solver
@pytest.mark.parametrize("name", ["winslow", "length"])
def test_an_error_in_a_callback_does_not_lose_the_grid(solve, name):
    start, calls = disordered(gg.domain("chevron", 17, 17), 0.3), count()

    def callback(step):
        if next(calls) == 2:
            raise ZeroDivisionError("of the user")

    with pytest.raises(ZeroDivisionError, match="of the user") as raised:
        solve(start, name, callback=callback)
    assert raised.value.result.quality.valid
    assert raised.value.result.interrupted
    assert any("'result'" in note for note in raised.value.__notes__)


@pytest.mark.parametrize("solve", [*SOLVERS.values(), gg.untangle], ids=[*SOLVERS, "untangle"])
def test_the_time_limit_ends_a_run_with_its_best_grid(solve):
    start = gg.domain("swan", 17, 17)
    result = solve(start, "winslow", time_limit=1e-9)
    assert result.stopped_by == "time limit"
    assert "time limit of 1e-09 seconds" in result.message
    assert result.quality.folded_cells <= gg.quality(start).folded_cells


@pytest.mark.parametrize("limit", [0, -1.0, "1"])
def test_a_time_limit_that_means_nothing_is_refused(limit):
    with pytest.raises(gg.GridgenError, match="time_limit must be a positive number"):
        gg.optimize(gg.domain("swan", 9, 9), "winslow", time_limit=limit)


def test_an_interrupted_untangling_keeps_what_the_coarse_grids_gave():
    def stop(step):
        if step.shape == (33, 33):
            raise KeyboardInterrupt

    start = gg.domain("zee", 33, 33)
    result = gg.untangle(start, callback=stop)
    assert result.quality.folded_cells < 0.1 * gg.quality(start).folded_cells


def test_where_a_corner_of_fixed_nodes_is_folded_all_other_cells_are_unfolded():
    xy = gg.domain("zee", 21, 21).xy
    xy[0, 0] = 0.6 * (xy[1, 0] + xy[0, 1])  # Beyond the line between its neighbors.
    start = gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1])
    assert gg.quality(start).folded_cells > 100
    result = gg.untangle(start)
    assert not result.converged
    assert result.quality.folded.tolist() == [[0, 0]]
    assert "no valid grid exists: at corner 0" in result.message


@pytest.mark.slow
@pytest.mark.parametrize("name", BARRIER)
def test_shallow_folds_are_found_and_mended(name):
    """Far shallower than a cell: an epsilon of their size would not see its way out."""
    xy = gg.domain("wavy", 17, 17).xy
    xy[8, 8] = xy[7, 8] + (xy[7, 8] - xy[7, 7]) * 1e-4 - (xy[8, 9] - xy[7, 9]) * 1e-6
    start = gg.Grid(xy)
    assert gg.quality(start).folded_cells > 0
    assert gg.untangle(start, name).converged


def test_a_finer_start_keeps_the_boundary_and_folds_nothing_where_cells_are_halved():
    coarse = gg.optimize(gg.domain("zee", 17, 17), "winslow").grid.planes
    fine = gg.domain("zee", 33, 33).planes
    start = finer_start(make_problem(gg.domain("zee", 33, 33), "winslow"), coarse, fine)
    assert Folds.of(from_boundary(fine)).cells > 400
    assert Folds.of(start).cells == 0
    assert np.array_equal(edges(start.transpose(1, 2, 0)), edges(fine.transpose(1, 2, 0)))


def test_the_energy_per_corner_of_squares_is_two():
    flat = gg.domain("square", 5, 9)
    assert gg.optimize(flat, "winslow", max_iterations=0).energy_per_corner == pytest.approx(2.0)
    assert gg.optimize(flat, "winslow", max_iterations=0, spacing="index").energy_per_corner == pytest.approx(2.5)
    for spacing in ("unit", "index", (0.3, 0.3)):
        result = gg.optimize(gg.domain("square", 9, 9), "winslow", spacing=spacing)
        assert result.energy_per_corner == pytest.approx(2.0)
