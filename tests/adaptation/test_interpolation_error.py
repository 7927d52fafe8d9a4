"""The measure by which adaptation is judged, against errors that are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg

from .conftest import folded_square

SQUARE = gg.domain("square", 11, 11)


def test_it_is_exact_for_a_parabola_and_zero_for_what_is_bilinear():
    """On cells of width h the error of x² is x(h - x), whose square has the mean h⁴/30."""
    assert gg.interpolation_error(SQUARE, "x**2") == pytest.approx(0.1**2 / np.sqrt(30), rel=1e-11)
    assert gg.interpolation_error(SQUARE, lambda x, y: 2 + x - 3 * y + 4 * x * y) < 1e-13
    assert gg.interpolation_error(SQUARE, lambda x, y: 5.0) < 1e-14


def test_areas_count_also_on_a_sheared_grid():
    sheared = gg.Grid.from_planes(2 * SQUARE.x + SQUARE.y, SQUARE.y)
    assert gg.interpolation_error(sheared, "3", np.zeros((11, 11))) == pytest.approx(3 * np.sqrt(2))
    assert gg.interpolation_error(sheared, "x - 2*y") < 1e-13


@pytest.mark.parametrize("widens", ["x", "y"])
def test_areas_vary_within_a_cell_that_is_no_parallelogram(widens):
    """Over 0 < a < 1 and 0 < b < 1 + a, however it is turned, the integral of a² is 1/3 + 1/4."""
    along, across = gg.domain("square", 3, 3).planes
    a, b = (along, across * (1 + along)) if widens == "x" else (across, -along * (1 + across))
    turned = gg.Grid.from_planes(0.6 * a - 0.8 * b, 0.8 * a + 0.6 * b)
    found = gg.interpolation_error(turned, "0.6*x + 0.8*y", np.zeros((3, 3)))
    assert found == pytest.approx(np.sqrt(7 / 12), rel=1e-12)


def test_given_nodal_values_take_the_functions_place():
    values = SQUARE.x**2
    assert gg.interpolation_error(SQUARE, "x**2 + 1", values + 1) == pytest.approx(0.01 / np.sqrt(30))
    assert gg.interpolation_error(SQUARE, "0", np.ones((11, 11))) == pytest.approx(1)


def test_more_points_see_more():
    """The square of the error of x**8 has the degree 16 along x: 9 Gauss points are exact, 2 are not."""
    exact = gg.interpolation_error(SQUARE, "x**8", points=9)
    assert gg.interpolation_error(SQUARE, "x**8", points=20) == pytest.approx(exact, rel=1e-10)
    assert gg.interpolation_error(SQUARE, "x**8", points=2) != pytest.approx(exact, rel=1e-3)
    with pytest.raises(gg.GridgenError, match="whole number of Gauss points, at least 1; came 0"):
        gg.interpolation_error(SQUARE, "x", points=0)


def test_a_sympy_expression_is_a_function():
    import sympy

    assert gg.interpolation_error(SQUARE, sympy.Symbol("x") ** 2) == gg.interpolation_error(SQUARE, "x**2")


@pytest.mark.parametrize(
    ("grid", "function", "values", "match"),
    [
        (SQUARE.xy, "x", None, "expected a Grid, came ndarray"),
        (folded_square(9), "x", None, "on a folded grid nodal values are no function of position"),
        (SQUARE, "x", np.ones(3), r"shape \(11, 11\); came \(3,\)"),
        (SQUARE, lambda x, y: x[0], None, r"function must have one value per node, shape \(11, 11\)"),
        (
            SQUARE,
            lambda x, y: np.where(x > 0.93, np.nan, x),
            np.ones((11, 11)),
            r"function must be finite at every Gauss point of a cell; it is nan at Gauss point of a cell \(9, 0\)",
        ),
        (SQUARE, "x + z", None, "the function: unknown name 'z'"),
        (SQUARE, np.ones((11, 11)), None, "must be known everywhere: pass nodal values as `values`"),
    ],
)
def test_what_cannot_be_measured_is_refused(grid, function, values, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.interpolation_error(grid, function, values)
