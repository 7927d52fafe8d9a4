"""Adaptation pays: a third of the uniform grid's error or less, on every domain and for every form of a solution."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import farthest

import gridgen_sym as gg

from .conftest import L_CORNERS, MEASURES, SHARP, corner_singularity, interpolation_error, l_shape, ring, square


@pytest.mark.slow
@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("name", SHARP)
def test_error_is_at_most_a_third_of_the_uniform_grids(name, measure):
    function = SHARP[name]
    result = gg.adapt(square(), function, monitor=measure)
    assert result.quality.valid
    # Measured: 0.03 to 0.32.
    assert interpolation_error(result.grid, function) < interpolation_error(square(), function) / 3
    assert result.grid.shape == square().shape


@pytest.mark.parametrize("name", SHARP)
def test_the_boundary_may_stay(name):
    function = SHARP[name]
    result = gg.adapt(square(), function, boundary="fixed")
    for side in (np.s_[:, 0], np.s_[:, -1], np.s_[0], np.s_[-1]):
        assert np.array_equal(result.grid.xy[side], square().xy[side])
    assert result.quality.valid
    # A front that meets the boundary cannot be resolved there: measured 0.22 to 0.33.
    assert interpolation_error(result.grid, function) < 0.4 * interpolation_error(square(), function)


@pytest.mark.parametrize(("nodes", "most"), [(25, 0.5), (65, 0.25)])
def test_it_pays_on_other_sizes(nodes, most):
    result = gg.adapt(square(nodes), ring)
    assert result.converged, result.message
    assert interpolation_error(result.grid, ring) < most * interpolation_error(square(nodes), ring)


@pytest.mark.parametrize(("corners", "most"), [("on a long side", 0.35), ("on a side with a turn", 0.65)])
def test_the_default_monitor_sees_a_corner_singularity(corners, most):
    """Measured: 0.30 and 0.61. By the L2 density of a front, and without sliding between turns, 0.87 and 0.99."""
    start = l_shape(33, L_CORNERS[corners])
    result = gg.adapt(start, corner_singularity)
    assert result.converged, result.message
    assert result.quality.valid
    assert interpolation_error(result.grid, corner_singularity) < most * interpolation_error(start, corner_singularity)
    assert result.history[-1].error < 0.6 * result.history[0].error


@pytest.mark.parametrize(("measure", "most"), [("recovery_error", 0.75), ("hierarchical_error", 0.6)])
def test_indicators_do_not_crowd_the_nodes_of_a_side_at_a_singularity(measure, most):
    """Measured: 0.65 and 0.50. With the spacing of a front the recovery error gives 1.26, unsettled."""
    start = l_shape(33, L_CORNERS["on a side with a turn"])
    result = gg.adapt(start, corner_singularity, monitor=measure)
    assert result.converged, result.message
    assert interpolation_error(result.grid, corner_singularity) < most * interpolation_error(start, corner_singularity)


@pytest.mark.slow
@pytest.mark.parametrize("name", gg.domain_names())
def test_every_domain_can_be_adapted(name):
    start = gg.optimize(gg.domain(name, 25, 25), "winslow").grid
    center, size = start.planes[:, 12, 15], 24 * np.sqrt(gg.quality(start).mean_jacobian)

    def bubble(x, y):
        return np.tanh(20 * (np.hypot(x - center[0], y - center[1]) / size - 0.25))

    result = gg.adapt(start, bubble, max_iterations=12)
    assert result.quality.valid
    # Measured: 0.3 to 0.65.
    assert interpolation_error(result.grid, bubble) < 0.75 * interpolation_error(start, bubble)
    assert result.after.weight.variation < 0.75 * result.before.weight.variation


@pytest.mark.slow
def test_a_moving_front_is_followed_by_a_few_steps_at_a_time():
    grid = gg.adapt(square(), lambda x, y: np.tanh(50 * (np.hypot(x, y) - 0.3))).grid
    for radius in np.linspace(0.32, 0.5, 10):
        moved = lambda x, y, r=radius: np.tanh(50 * (np.hypot(x, y) - r))  # noqa: E731
        result = gg.adapt(grid, moved, max_iterations=2)
        assert result.quality.valid
        assert interpolation_error(result.grid, moved) < interpolation_error(square(), moved) / 3
        grid = result.grid


def test_every_form_of_a_solution_gives_one_grid():
    import sympy

    x, y = sympy.symbols("x y")
    forms = (
        ring,
        lambda grid: ring(grid.x, grid.y),
        "tanh(50*(sqrt((x - 0.5)**2 + (y - 0.5)**2) - 0.3))",
        sympy.tanh(50 * (sympy.sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2) - 0.3)),
    )
    # An odd number of cells: no node stands on the center, where the formulas' derivatives have no value.
    first, *others = (gg.adapt(square(20), form, max_iterations=4, moves=1).grid for form in forms)
    for grid in others:
        assert farthest(grid, first) < 1e-7


def test_nodal_values_of_the_start_are_enough():
    start = square(65)
    values = ring(start.x, start.y)
    result = gg.adapt(start, values)
    assert result.converged, result.message
    assert interpolation_error(result.grid, ring) < interpolation_error(start, ring) / 3
    # The density is that of the start, carried along: derivatives of interpolated values would show the interpolation.
    np.testing.assert_array_equal(
        result.density, gg.transfer(start, gg.Monitor("curvature").density(start, values), result.grid)
    )
    # The values were interpolated, and are as good as the start's.
    assert np.abs(result.values - ring(*result.grid.planes)).max() < 0.6
    assert np.sqrt(((result.values - ring(*result.grid.planes)) ** 2).mean()) < 0.1
