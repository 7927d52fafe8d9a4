"""What an adaptation reports: of every step, of how it ended, and of what the user must know."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import farthest

import gridgen_sym as gg

from .conftest import ring, square, two_scales


def test_the_history_tells_of_every_step():
    seen = []
    result = gg.adapt(square(), two_scales, callback=seen.append)
    assert tuple(seen) == result.history
    assert [step.step for step in seen] == list(range(len(seen)))
    assert seen[0].movement == 0
    assert seen[-1].min_jacobian == result.quality.min_jacobian < seen[0].min_jacobian
    assert seen[-1].error == pytest.approx(np.linalg.norm(gg.hierarchical_error(result.grid, result.values)))
    assert seen[-1].movement <= 1e-3 < seen[-2].movement
    assert result.converged
    assert result.iterations < 30
    assert "has settled" in result.message
    errors = f"was {seen[0].error:.2e}, now it is {seen[-1].error:.2e}."
    assert f"The estimated error of interpolation {errors}" in result.message
    assert str(result).startswith(f"converged after {result.iterations} steps")
    assert np.array_equal(result.values, two_scales(*result.grid.planes))


def test_progress_is_shown_where_it_takes_long(monkeypatch, live_line):
    gg.adapt(square(9), ring, max_iterations=1, progress=True)
    assert not live_line, "it did not take long"
    monkeypatch.setattr("gridgen_sym.solvers.run.live.PATIENCE", -1.0)
    gg.adapt(square(9), ring, max_iterations=1, progress=False)
    assert not live_line
    gg.adapt(square(9), ring, max_iterations=1, progress=True)
    assert (live_line[0], live_line[-1], len(live_line)) == ("start", "stop", 4)
    assert live_line[2].startswith("adapt, area_winslow: step 1, movement")


def test_too_few_steps_are_reported():
    result = gg.adapt(square(17), ring, max_iterations=2)
    assert result.status is gg.Status.ITERATION_LIMIT
    assert not result.converged
    assert "not settled in 2 steps" in result.message
    assert f"moved a node by {result.history[-1].movement:.1e}, more than 1.0e-03" in result.message
    assert str(result).startswith("NOT converged after 2 steps")


def test_a_grid_has_settled_where_the_tolerance_says():
    result = gg.adapt(square(17), ring, tolerance=0.05)
    assert result.converged
    *before, last = (step.movement for step in result.history[1:])
    assert last <= 0.05 < min(before)


def test_without_a_step_no_step_is_spoken_of():
    result = gg.adapt(square(9), ring, max_iterations=0)
    assert (result.grid, result.iterations, result.converged) == (square(9), 0, False)
    assert result.message.startswith("no step was allowed: this is the start. The estimated error")


def test_nothing_to_adapt_to_leaves_a_uniform_grid():
    result = gg.adapt(square(17), "0*x + 3")
    assert result.converged
    assert farthest(result.grid, square(17)) < 1e-8
    assert "The solution is 3 at every node: there is nothing to adapt to." in result.message
    assert "nothing to adapt" not in gg.adapt(square(17), "1e-6*x", max_iterations=1).message


def test_a_settled_grid_that_is_worse_by_its_own_estimate_is_reported():
    """A density that draws the nodes away from the front: the grid settles, and is no success."""

    def away(grid, values):
        return np.exp(-20 * (grid.x + grid.y))

    result = gg.adapt(square(17), "tanh(20*(x + y - 1.8))", monitor=away)
    assert result.status is gg.Status.WORSE
    assert result.history[-1].movement <= 1e-3
    assert result.history[-1].error > result.history[0].error
    assert not result.converged
    assert str(result).startswith("NOT converged")
    assert "worse than the start by its own estimate: the monitor away does not suit" in result.message
    assert "Take monitor='curvature' or 'recovery_error', or more nodes." in result.message


def test_a_density_that_is_given_has_no_estimate_to_be_worse_by():
    result = gg.adapt(square(17), "11 - 10*exp(-20*(x + y))", monitor="values")
    assert result.status is gg.Status.CONVERGED
    assert result.history[-1].error > result.history[0].error
    assert "its own estimate" not in result.message
