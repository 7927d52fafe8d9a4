"""What ends an adaptation early (Ctrl-C, the time limit, a callback, an error) gives the last grid that is known."""

from __future__ import annotations

from itertools import count

import pytest

import gridgen_sym as gg

from .conftest import folded_square, ring, square


def test_ctrl_c_gives_the_last_grid_whose_solution_is_known():
    calls = []

    def solve(grid):
        calls.append(grid)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return ring(grid.x, grid.y)

    result = gg.adapt(square(17), solve)
    assert result.interrupted
    assert not result.converged
    assert result.grid == calls[2]
    assert "interrupted" in result.message
    assert result.stopped_by == "Ctrl-C"


def test_ctrl_c_in_the_first_solution_goes_on_to_the_user():
    def solve(grid):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gg.adapt(square(9), solve)


def test_ctrl_c_in_an_untangling_goes_on_to_the_user(monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("gridgen_sym.solvers.minimization.begin_search", interrupted)
    with pytest.raises(KeyboardInterrupt):
        gg.adapt(folded_square(9), ring)


def test_the_time_limit_gives_the_last_grid_whose_solution_is_known(monkeypatch):
    start, solved, now = square(17), [], [0.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])

    def solve(grid):
        solved.append(grid)
        now[0] += 1.0
        return ring(grid.x, grid.y)

    result = gg.adapt(start, solve, time_limit=2.5)
    assert result.stopped_by == "time limit"
    assert result.interrupted
    assert not result.converged
    assert result.message.startswith("the time limit of 2.5 seconds is over; this is the last grid whose solution")
    assert (len(solved), result.grid) == (3, solved[-1])


def test_the_time_limit_ends_a_minimization_of_an_adaptation(monkeypatch):
    start = square(17)
    monkeypatch.setattr("time.monotonic", count(0.0, 0.01).__next__)
    assert gg.adapt(start, ring, time_limit=1e9).stopped_by is None
    result = gg.adapt(start, ring, time_limit=0.035)
    assert result.stopped_by == "time limit"
    assert result.grid == start


def test_the_callback_and_the_time_limit_stop_it():
    seen = []

    def stop(step):
        seen.append(step)
        if step.step == 2:
            raise StopIteration

    stopped = gg.adapt(square(17), ring, callback=stop)
    assert (stopped.interrupted, stopped.converged) == (True, False)
    assert stopped.history == tuple(seen)
    assert stopped.grid == gg.adapt(square(17), ring, max_iterations=2).grid
    assert "the callback stopped it; this is the last grid" in stopped.message
    at_once = gg.adapt(square(17), ring, time_limit=1e-9)
    assert at_once.grid == square(17)
    assert "the time limit of 1e-09 seconds is over; this is the last grid" in at_once.message


def test_an_error_on_the_way_holds_the_last_grid():
    def fail(step):
        if step.step == 2:
            raise LookupError("mine")

    with pytest.raises(LookupError, match="mine") as caught:
        gg.adapt(square(17), ring, callback=fail)
    assert caught.value.result.grid == gg.adapt(square(17), ring, max_iterations=2).grid
    assert "'result' holds the last adapted grid" in caught.value.__notes__[0]
    grids = []

    def diverges(grid):
        grids.append(grid)
        if len(grids) == 3:
            raise ArithmeticError
        return ring(grid.x, grid.y)

    with pytest.raises(gg.GridgenError, match="step 2") as caught:
        gg.adapt(square(17), diverges)
    assert caught.value.result.grid == grids[1]
    assert len(caught.value.result.history) == 2
