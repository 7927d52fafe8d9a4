"""Continuation in a parameter: each value starts from the last grid, valid grids stay valid, failures are reported."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import farthest, mild_grid

import gridgen_sym as gg
from gridgen_sym.solvers.continuation import _values
from gridgen_sym.solvers.run.deadline import StopRequest

START = mild_grid(9, 8)


@pytest.fixture
def solver(monkeypatch):
    """Return a list of results that `optimize` gives instead of solving, and what it was called with."""
    import sys

    results, calls = [], []

    def optimize(grid, functional, **options):
        calls.append((grid, options))
        return results[len(calls) - 1]

    monkeypatch.setattr(sys.modules["gridgen_sym.solvers.continuation"], "optimize", optimize)
    return results, calls


def outcome(grid, status=gg.Status.CONVERGED):
    return gg.Result(grid, status is gg.Status.CONVERGED, status, "it ended.", 3, 1.0, ())


def moved(by):
    xy = START.xy.copy()
    xy[3, 3] += by
    return gg.Grid(xy)


FOLDED = moved(0.4)


def test_it_ends_at_the_grid_of_the_last_value():
    result = gg.continuation(START, "area_winslow", "k", start=1, stop=1e-2, steps=3, backend="numpy", tolerance=1e-9)
    assert [value for value, _ in result.steps] == pytest.approx([1, 0.1, 0.01])
    assert result.converged
    assert result.message.startswith("k = 0.01: ")
    assert result.parameter == "k"
    direct = gg.optimize(START, "area_winslow", parameters={"k": 0.01}, backend="numpy", tolerance=1e-9)
    assert farthest(result.grid, direct.grid) < 1e-7
    assert farthest(result.grid, result.steps[0][1].grid) > 1e-4
    assert result.energy == result.steps[-1][1].energy


def test_every_value_starts_from_the_last_grid(solver):
    results, calls = solver
    results += [outcome(moved(0.01)), outcome(moved(0.02)), outcome(moved(0.03))]
    other = {"k_A": 0.4, "k_O": 0.4}
    constant = {"parameters": {**other, "k_L": 0.2}}
    result = gg.continuation(START, "combined", "k_L", [0.2] * 3, parameters=other, weight="1 + x**2")
    assert [grid for grid, _ in calls] == [START, results[0].grid, results[1].grid]
    assert all(options["weight"] == "1 + x**2" for _, options in calls)
    assert all(options["parameters"] == constant["parameters"] for _, options in calls)
    assert result.grid == results[2].grid


@pytest.mark.parametrize("allowed", [False, True])
def test_a_valid_grid_stays_valid_unless_folds_are_allowed(solver, allowed):
    results, calls = solver
    results += [outcome(START), outcome(FOLDED), outcome(FOLDED)]
    assert not results[1].quality.valid
    options = {"keep_valid": False} if allowed else {}
    result = gg.continuation(START, "area_winslow", "k", [1, 0.1, 0.01], **options)
    if allowed:
        assert result.grid == FOLDED
        assert len(calls) == 3
        return
    assert result.grid == START
    assert result.status is gg.Status.FOLDED
    assert not result.converged
    assert result.message.startswith("k = 0.1: ")
    assert [value for value, _ in result.steps] == [1, 0.1]
    assert len(calls) == 2


def test_a_folded_grid_goes_on(solver):
    results, _ = solver
    results += [outcome(FOLDED, gg.Status.FOLDED), outcome(FOLDED, gg.Status.FOLDED), outcome(START)]
    result = gg.continuation(FOLDED, "area_winslow", "k", [1, 0.1, 0.01])
    assert result.converged
    assert result.grid == START


@pytest.mark.parametrize("status", [gg.Status.DIVERGED, gg.Status.NOT_DIFFERENTIABLE])
def test_a_step_that_fails_ends_it_with_the_grid_before(solver, status):
    results, calls = solver
    results += [outcome(moved(0.01)), outcome(moved(0.02), status), outcome(START)]
    result = gg.continuation(START, "area_winslow", "k", [1, 0.1, 0.01])
    assert (result.grid, result.status, result.converged) == (results[0].grid, status, False)
    assert "k = 0.1: it ended. The grid is that of k = 1." in result.message
    assert len(calls) == len(result.steps) == 2


def test_the_callback_stops_it():
    seen = []

    def callback(step):
        seen.append(step)
        if len(seen) > 4:
            raise StopIteration

    result = gg.continuation(START, "area_winslow", "k", [1, 0.1, 0.01], callback=callback, backend="numpy")
    assert result.status is gg.Status.STOPPED_BY_CALLBACK
    assert len(result.steps) < 3
    assert result.quality.valid
    assert len(seen) == 5


def test_the_time_limit_is_for_all_values(solver, monkeypatch):
    results, calls = solver
    results += [outcome(moved(0.01)), outcome(START)]
    left = iter([5.0])

    def check(deadline):
        try:
            return next(left)
        except StopIteration:
            raise StopRequest(gg.StopReason.TIME_LIMIT, "the time limit of 5 seconds is over") from None

    monkeypatch.setattr("gridgen_sym.solvers.run.deadline.Deadline.check", check)
    result = gg.continuation(START, "area_winslow", "k", [1, 0.1], time_limit=5)
    assert calls[0][1]["time_limit"] == 5.0
    assert result.status is gg.Status.STOPPED_BY_TIME_LIMIT
    assert result.grid == results[0].grid
    assert result.message == "the time limit of 5 seconds is over, before k = 0.1."


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "give either the values of the parameter"),
        ({"values": [1], "start": 1}, "give either the values of the parameter"),
        ({"start": 1}, "give either the values of the parameter"),
        ({"start": 1, "stop": 2, "steps": 1}, "at least 2; came 1"),
        ({"values": []}, "one or more finite numbers"),
        ({"values": ["a"]}, "must be numbers; came ['a']"),
        ({"values": [1, np.nan]}, "one or more finite numbers"),
        ({"values": [1, -1]}, "functional 'area_winslow' needs k > 0; came k = -1"),
        ({"values": [1], "callback": 3}, "callback must be a function"),
        ({"values": [1], "time_limit": -1}, "time_limit must be"),
        ({"values": 3}, "must be numbers; came 3"),
    ],
)
def test_bad_input_is_refused_before_anything_is_solved(solver, options, words):
    with pytest.raises(gg.GridgenError) as caught:
        gg.continuation(START, "area_winslow", "k", **options)
    assert words in str(caught.value)
    assert not solver[1]


def test_an_unknown_parameter_is_named():
    with pytest.raises(gg.GridgenError, match="has no parameter 'omega'"):
        gg.continuation(START, "winslow", "omega", [1, 2])


def test_values_of_one_sign_are_in_geometric_progression_others_in_equal_steps():
    assert _values(None, 100, 1, 3) == pytest.approx((100, 10, 1))
    assert _values(None, -1, -100, 3) == pytest.approx((-1, -10, -100))
    assert _values(None, -1, 1, 3) == (-1, 0, 1)
    assert _values(None, 1, 0, 3) == (1, 0.5, 0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["quasi_harmonic", "unam_area"])
def test_area_functionals_unfold_the_swan_as_omega_tends_to_zero(name):
    start = gg.domain("swan", 25, 21)
    least = gg.corner_jacobians(start.x, start.y).min() * 24 * 20
    assert least < 0
    options = {"backend": "numpy", "max_iterations": 100}
    result = gg.continuation(start, name, "omega", start=-1.1 * least, stop=1e-4, steps=12, **options)
    assert result.converged, result
    assert result.quality.valid
    assert not gg.optimize(start, name, parameters={"omega": 1e-4}, **options).quality.valid
