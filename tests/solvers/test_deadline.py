"""A time limit ends a run soon, whatever it is at: a deadline is asked before all that may take long."""

from __future__ import annotations

from functools import partial
from importlib import import_module
from time import process_time
from types import SimpleNamespace

import numpy as np
import pytest
from support_boundaries import flat_polygon, grid_of_ring, smooth_curve

import gridgen_sym as gg
from gridgen_sym.certificates.branching import DEFAULT_BUDGET
from gridgen_sym.functionals.registry import functional
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.equations import newton as equations_newton
from gridgen_sym.solvers.equations.residual import Equations
from gridgen_sym.solvers.newton import minimize as newton
from gridgen_sym.solvers.newton.nonlinear_elimination import sweep_standing_out
from gridgen_sym.solvers.newton.steps import NewtonSteps
from gridgen_sym.solvers.run.deadline import Deadline, StopRequest
from gridgen_sym.solvers.run.progress import Progress
from gridgen_sym.solvers.run.status import StopReason
from gridgen_sym.solvers.untangling.feasible_starts import FeasibleStarts
from gridgen_sym.solvers.untangling.smallest_jacobian import FoldedRegion
from gridgen_sym.solvers.untangling.strategies import begin_search

from .test_nonlinear_elimination import point_of, stretched


class Ends(Deadline):
    """A time that is over when it has been asked for so often."""

    def __init__(self, after):
        super().__init__(3600.0)
        self.asked, self.after = 0, after

    def check(self):
        self.asked += 1
        if self.asked > self.after:
            raise StopRequest(StopReason.TIME_LIMIT, "the time is over")
        return super().check()


def test_a_deadline_comes_once_the_seconds_are_over(monkeypatch):
    monkeypatch.setattr("time.monotonic", lambda: 100.0)
    some, never = Deadline(2.0), Deadline()
    monkeypatch.setattr("time.monotonic", lambda: 101.5)
    assert (some.check(), never.check()) == (0.5, np.inf)
    for now in (102.0, 103.0):
        monkeypatch.setattr("time.monotonic", lambda now=now: now)
        assert never.check() == np.inf
        with pytest.raises(StopRequest, match="the time limit of 2 seconds is over"):
            some.check()


#: A boundary that becomes valid from feasible starts.
BAND = grid_of_ring(flat_polygon(20304, 26, 3e-2), 8, 7)
RUNS = {
    "a bay without a valid grid": (gg.untangle, grid_of_ring(smooth_curve(906, 20, 0.6), 7, 5)),
    "a folded start": (gg.optimize, gg.domain("zee", 33, 33)),
    "a folded start, equations": (gg.solve_euler_lagrange, gg.domain("zee", 33, 33)),
    "windows": (gg.optimize, gg.Grid.from_planes(*stretched())),
}


@pytest.mark.slow
@pytest.mark.parametrize(("solve", "start"), RUNS.values(), ids=RUNS)
def test_whenever_the_time_is_over_the_best_grid_so_far_is_returned(solve, start, monkeypatch):
    def run(after):
        made.append(Ends(after))
        return solve(start, "winslow")

    made = []
    for module in ("optimize", "equations.euler_lagrange"):
        monkeypatch.setattr(import_module(f"gridgen_sym.solvers.{module}"), "Deadline", lambda seconds: made[-1])
    whole = run(10**9)
    assert not whole.interrupted
    last = np.inf
    for after in np.linspace(0, made[-1].asked - 1, 5).astype(int).tolist():
        result = run(after)
        folded = result.quality.folded_cells
        assert result.stopped_by == "time limit"
        assert result.message.count("the time is over; this is the best grid that it had.") == 1
        assert ("was untangled first" in result.message) <= (folded == 0)
        assert (f"{folded} cell" in result.message) == (folded > 0)
        assert folded <= min(last, gg.quality(start).folded_cells)
        last = folded


def test_a_window_is_left_in_time_and_what_it_has_done_is_kept():
    swept, point, asked = point_of(stretched()), point_of(stretched()), Ends(10**9)
    sweep_standing_out(swept, swept.problem, asked)
    with pytest.raises(StopRequest):
        newton._eliminate(point, Ends(asked.asked + 6))
    point.evaluate()
    assert point.smallest > 0
    assert point.energy < swept.energy


def test_every_linear_program_asks(monkeypatch):
    """Also those that lead nowhere, and of which no step is told."""
    start = BAND
    place, free = start.planes.copy(), np.ones(start.shape, dtype=bool)
    free[[0, -1]], free[:, [0, -1]] = False, False
    seconds = []
    monkeypatch.setattr(FoldedRegion, "_program", lambda self, radius, left: seconds.append(left))
    with pytest.raises(StopRequest):
        FoldedRegion(place, free).maximize(Progress("lift", deadline=Ends(3)))
    assert len(seconds) == 3
    short = Deadline()
    monkeypatch.setattr(short, "check", lambda: 1e-3)
    FoldedRegion(place, free).maximize(Progress("lift", deadline=short))
    assert seconds[0] == 0.5
    assert seconds[-1] == 1e-3


def test_every_linear_system_of_a_step_asks():
    problem = make_problem(gg.domain("wavy", 9, 9), "winslow")
    never_solves = SimpleNamespace(set_operator=lambda planes: False)
    state = NewtonSteps(problem, never_solves, Ends(3), only_semidefinite=False)
    with pytest.raises(StopRequest):
        state.downhill(SimpleNamespace(iterate=point_of(gg.domain("wavy", 9, 9).planes.copy())))
    assert state.deadline.asked == 4


def test_every_damped_step_of_the_equations_asks():
    start, deadline = gg.domain("wavy", 9, 9), Ends(3)
    equations = Equations(make_problem(start, "winslow"))
    residual = equations.residual(start.planes)
    with pytest.raises(StopRequest):
        equations_newton._reduce(equations, start.planes, residual, (1.0, np.inf), np.inf, deadline)
    assert deadline.asked == 4


def test_a_search_for_a_proof_asks():
    start = RUNS["a bay without a valid grid"][1]
    asked, over = Ends(10**9), Ends(0).check
    assert len(gg.certificates(start, search=True, check=asked.check)) == 1
    assert asked.asked > 100
    for after in (0, 50, asked.asked - 1):  # The last ones are in the search for fewer cells.
        with pytest.raises(StopRequest):
            gg.certificates(start, search=True, check=Ends(after).check)
    assert gg.certificates(start, check=over) == ()
    backwards = gg.Grid(start.xy[::-1])
    assert gg.certificates(backwards, search=True, check=over)[0].kind == "clockwise", "no search is needed"


@pytest.mark.slow
@pytest.mark.parametrize("prove", [partial(gg.certificates, search=True), gg.sliver_certificate])
def test_a_search_in_a_large_grid_asks_often(prove):
    """Every cell is folded, and each of its four hundred boundary nodes is an obstacle."""
    xy = gg.domain("swan", 101, 101).xy
    xy[1:-1, 1:-1] = np.random.default_rng(0).permutation(xy[1:-1, 1:-1].reshape(-1, 2)).reshape(99, 99, 2)
    times = [process_time()]

    def check():
        times.append(process_time())
        if times[-1] > times[0] + 1:
            raise TimeoutError

    with pytest.raises(TimeoutError):
        prove(gg.Grid(xy), budget=10**6, check=check)
    assert np.diff(times).max() < 1.5, "about 0.2 s of processor time, and more where memory is slow"


def test_the_search_for_feasible_starts_asks(monkeypatch):
    lifted, deadline = [], Ends(50)
    problem, report = make_problem(BAND, "winslow"), Progress("feasible starts", deadline=deadline)
    search = begin_search(problem, functional("winslow"), BAND.planes, None, report)
    monkeypatch.setattr(FoldedRegion, "maximize", lambda self, progress: lifted.append(progress))
    with pytest.raises(StopRequest):
        FeasibleStarts(DEFAULT_BUDGET).run(search)
    assert not lifted
    assert deadline.asked == 51
