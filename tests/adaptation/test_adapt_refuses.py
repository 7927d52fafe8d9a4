"""What an adaptation untangles first, and what it refuses: starts, arguments and solutions that mean nothing."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest
from support_solvers import hopeless_grid

import gridgen_sym as gg

from .conftest import folded_square, ring, square


def test_a_folded_start_is_untangled_and_a_hopeless_one_refused():
    result = gg.adapt(folded_square(17), ring, max_iterations=2)
    assert "The start was folded and was untangled first" in result.message
    assert result.quality.valid
    with pytest.raises(gg.GridgenError, match="needs a valid start"):
        gg.adapt(hopeless_grid(), ring)


def test_a_folded_start_is_untangled_as_the_user_wants(monkeypatch):
    given = {}

    def recorded(grid, untangle=gg.untangle, **options):
        given.update(options)
        return untangle(grid, **options)

    monkeypatch.setattr(import_module("gridgen_sym.adaptation.arguments"), "untangle", recorded)
    wanted = {"fixed": np.eye(9, dtype=bool), "backend": "numpy"}
    gg.adapt(folded_square(9), ring, max_iterations=1, time_limit=1e9, **wanted)
    left = given.pop("time_limit")
    assert given == wanted
    # The untangling has what is left of the time, and not the time limit anew.
    assert 0.99e9 < left < 1e9


def test_a_folded_start_that_cannot_be_untangled_in_time_is_refused():
    with pytest.raises(gg.GridgenError, match=r"needs a valid start.* time limit of 1e-09 seconds is over"):
        gg.adapt(folded_square(9), ring, time_limit=1e-9)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"max_iterations": -1}, "max_iterations must be a whole number, at least 0; came -1"),
        ({"moves": 0}, "moves must be a whole number, at least 1; came 0"),
        ({"damping": 0}, "damping must be a number above 0 and at most 1; came 0"),
        ({"tolerance": 2}, "tolerance must be a number above 0"),
        ({"time_limit": 0}, "time_limit must be a positive number of seconds; came 0"),
        ({"callback": 3}, "callback must be a function of one AdaptStep; came 3"),
        ({"boundary": "open"}, "unknown boundary 'open': it is one of fixed, straight, all"),
        ({"backend": "fortran"}, "unknown backend 'fortran'"),
        ({"functional": "areas"}, "Did you mean 'area'"),
        ({"functional": "winslow"}, "how 'winslow' places nodes with a weight is not known"),
        ({"monitor": "slope"}, "unknown monitor 'slope'; known: gradient"),
        ({"monitor": lambda grid, values: -np.ones(grid.shape)}, r"must not be negative: it is -1 at node \(0, 0\)"),
        ({"monitor": lambda grid, values: np.ones(3)}, r"measure must have the grid's shape \(9, 9\); came \(3,\)"),
    ],
)
def test_arguments_that_cannot_be_used_are_refused(options, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.adapt(square(9), ring, **options)


@pytest.mark.parametrize(
    ("solution", "match"),
    [
        (np.ones((3, 3)), r"the solution must have the grid's shape \(9, 9\); came \(3, 3\)"),
        (lambda grid: grid.x[1:], r"the solution on the grid of step 0 must have the grid's shape"),
        (lambda grid: grid.x / 0 * np.nan, "on the grid of step 0 must be finite"),
        (lambda grid: {}["u"], "cannot be had on the grid of step 0: your solver raised KeyError"),
        (lambda x, y, z: x, "came one of 3 arguments"),
        ("x + z", "unknown name 'z'"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*divide by zero.*", "ignore:.*invalid value.*")
def test_solutions_that_cannot_be_used_are_refused(solution, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.adapt(square(9), solution)


@pytest.mark.parametrize(
    ("size", "options", "match"),
    [
        (1e-29, {}, r"the grid has an area of 1e-58, .* overflows: scale the grid to a size of about 1"),
        (
            1.0,
            {"weight_exponent": 2000},
            r"is 0.\d+ to [1-9][.\d]* of its mean, and its power 2000, .*: take another exponent",
        ),
    ],
)
def test_a_weight_that_overflows_is_laid_to_what_was_given(size, options, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.adapt(gg.Grid(size * square(9).xy), lambda x, y: ring(x / size, y / size), **options)


def test_a_start_that_is_no_grid_is_refused():
    with pytest.raises(gg.GridgenError, match="underflow to zero: scale it"):
        gg.adapt(gg.Grid(square(9).xy * 1e-160), ring)
    with pytest.raises(gg.GridgenError, match="expected a Grid, came ndarray"):
        gg.adapt(square(9).xy, ring)
