"""Weights from samples and SymPy: each form gives the grid of the formula it was sampled from; bad ones are refused."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from support_solvers import energy_differences, farthest, gradient_norm, mild_grid, relative

import gridgen_sym as gg

FORMULA = "1 + 3*exp(-8*((x - 0.4)**2 + (y - 0.5)**2))"
MODES = ("frozen", "differentiated")
FINE = gg.domain("square", 81, 81).planes * 1.4 - 0.2


def function(x, y):
    return 1 + 3 * np.exp(-8 * ((x - 0.4) ** 2 + (y - 0.5) ** 2))


def expression(*_):
    # Symbols of the user's own making, with an assumption that ours do not have.
    x, y = sympy.symbols("x y", positive=True)
    return 1 + 3 * sympy.exp(-8 * ((x - sympy.Rational(2, 5)) ** 2 + (y - sympy.Rational(1, 2)) ** 2))


def on_grid(mode):
    grid = gg.Grid.from_planes(*FINE)
    return gg.Weight.on_grid(grid, function(grid.x, grid.y), mode)


def on_points(mode):
    points = np.random.default_rng(1).uniform(-0.2, 1.2, (6000, 2))
    return gg.Weight.on_points(points, function(*points.T), mode)


def on_raster(mode):
    # Downwards in y, as elevation models often are.
    x, y = np.linspace(-0.2, 1.2, 71), np.linspace(1.2, -0.2, 61)
    return gg.Weight.on_raster(x, y, function(*np.meshgrid(x, y, indexing="ij")), mode)


FORMS = {
    "SymPy": (lambda mode: gg.Weight(expression(), mode), 1e-9, 1e-9),
    "grid": (on_grid, 0.001, 0.01),
    "points": (on_points, 0.001, 0.01),
    "raster": (on_raster, 0.001, 0.01),
}
each_form = pytest.mark.parametrize("form", FORMS)


@each_form
@pytest.mark.parametrize("mode", MODES)
def test_every_form_gives_the_grid_of_its_formula(form, mode):
    make, accuracy, _ = FORMS[form]
    start = mild_grid()
    options = {"parameters": {"k_A": 0.8, "k_L": 0.2, "k_O": 0.0}}
    expected = gg.optimize(start, "combined", weight=gg.Weight(FORMULA, mode), **options)
    found = gg.optimize(start, "combined", weight=make(mode), **options)
    assert found.converged, found.message
    assert farthest(found.grid, expected.grid) < accuracy
    # The weight matters that much: a form that lost it would not be near.
    assert farthest(gg.optimize(start, "combined", **options).grid, expected.grid) > 10 * accuracy


@each_form
def test_every_differentiated_form_belongs_to_the_energy(form):
    make, _, accuracy = FORMS[form]
    grid, options = mild_grid(5, 6), {"weight": make("differentiated")}
    gradient = gg.gradient(grid, "area", **options)
    assert relative(gradient, energy_differences(grid, "area", 1e-4, **options)) < max(accuracy, 1e-5)


def test_a_raster_knows_its_derivatives():
    x, y = np.meshgrid(np.linspace(0, 1, 7), np.linspace(0.1, 0.9, 5), indexing="ij")
    names = ("s", "s_x", "s_y", "s_xx", "s_xy", "s_yy")
    planes = np.stack(on_raster("differentiated").planes(np.stack((x, y)), names))
    exact = np.stack(gg.Weight(expression(), "differentiated").planes(np.stack((x, y)), names))
    assert np.abs(planes - exact).max() < 0.02 * np.abs(exact).max()


def test_an_array_per_cell_stays_so():
    grid = gg.domain("square", 9, 8)
    center = np.add.outer(np.arange(8) + 0.5, np.arange(7) + 0.5)
    np.testing.assert_array_equal(gg.Weight(center).planes(grid.planes, ("s",))[0], center)
    # J = 1 on the unit square, whose cells have the area 1/56.
    assert gg.energy(grid, "area", weight=center) == pytest.approx(4 * center.sum() / 56, rel=1e-12)
    corners = np.random.default_rng(2).uniform(1, 2, (4, 8, 7))
    assert gg.energy(grid, "area", weight=corners) == pytest.approx(corners.sum() / 56, rel=1e-12)
    result = gg.optimize(mild_grid(), "combined", weight=center)
    assert result.converged
    assert gradient_norm(result.grid, "combined", weight=center) < 1e-4


# ---- outside the samples ----


@pytest.mark.parametrize("mode", MODES)
def test_outside_the_nearest_sample_counts_and_results_say_so(mode):
    axis = np.linspace(0.2, 0.8, 9)
    values = np.add.outer(1 + axis, 2 * axis)
    points = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    raster = gg.Weight.on_raster(axis, axis, values, mode, outside="nearest")
    for weight in (raster, gg.Weight.on_points(points, values.ravel(), mode, outside="nearest")):
        there = weight.planes(np.array([[[0.0, 0.5]], [[0.0, 0.5]]]), ("s",))[0]
        np.testing.assert_allclose(there, [[1.6, 2.5]], rtol=1e-6)
        result = gg.optimize(gg.domain("square", 9, 9), "combined", weight=weight, max_iterations=3)
        assert "nodes lie outside the weight's samples: the nearest sample counts there" in result.message
    assert "outside" not in gg.optimize(mild_grid(), "combined", weight=on_grid(mode)).message


def test_a_spline_is_flat_across_an_edge_that_it_is_continued_over():
    axis = np.linspace(0, 1, 9)
    weight = gg.Weight.on_raster(axis, axis, np.add.outer(1 + axis**2, axis), "differentiated")
    planes = weight.planes(np.array([[[2.0]], [[0.5]]]), ("s", "s_x", "s_y"))
    np.testing.assert_allclose(np.ravel(planes), [2.5, 0.0, 1.0], atol=1e-9)


# ---- refusals ----

AXIS = np.linspace(0, 1, 5)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: gg.Weight.on_points(np.zeros((4, 3)), np.ones(4)), r"points of shape \(n, 2\)"),
        (lambda: gg.Weight.on_points(np.eye(2), np.ones(2)), "n at least 3"),
        (lambda: gg.Weight.on_points([[0, 0], [1, 1], [2, 2]], np.ones(3)), "all lie on one line"),
        (lambda: gg.Weight.on_points([[0, 0], [1, 0], [np.nan, 2]], np.ones(3)), "point 2 is not"),
        (lambda: gg.Weight.on_points([[0, 0], [1, 0], [0, 2]], ["a", "b", "c"]), "real numbers"),
        (lambda: gg.Weight.on_grid(np.zeros((3, 3, 2)), np.ones((3, 3))), "expected a Grid, came ndarray"),
        (lambda: gg.Weight.on_grid(mild_grid(), np.ones((7, 9))), r"shape \(9, 8\), or one per cell, shape \(8, 7\)"),
        (lambda: gg.Weight.on_grid(mild_grid(), np.full((9, 8), np.inf)), r"node \(0, 0\) is not, the first of 72"),
        (lambda: gg.Weight.on_raster(AXIS, [0, 2, 1, 3], np.ones((5, 4))), "raster's y must be at least 2"),
        (lambda: gg.Weight.on_raster(AXIS, AXIS[:3], np.ones((3, 5))), "Pass the transpose"),
        (lambda: gg.Weight.on_raster(AXIS, AXIS[:3], np.ones((5, 3)), "differentiated"), "at least 4"),
        (lambda: gg.Weight.on_raster(AXIS, AXIS, np.full((5, 5), np.nan)), "all samples of the raster are missing"),
        (lambda: gg.Weight(sympy.Symbol("z") + sympy.Symbol("x")), "contains z: use only the symbols x and y"),
        (lambda: gg.energy(mild_grid(), "area", weight="1e160"), "square overflows: divide it by a constant"),
    ],
)
def test_samples_that_cannot_be_used_are_refused(make, match):
    with pytest.raises(gg.GridgenError, match=match):
        make()


def test_negative_samples_are_refused_with_their_place_unless_wanted():
    values = np.ones((5, 5))
    values[2, 2] = -0.5
    grid = gg.domain("square", 9, 9)
    with pytest.raises(gg.GridgenError, match=r"-0.5 at node \(4, 4\), x = 0.5.*Add at least 0.5"):
        gg.energy(grid, "area", weight=gg.Weight.on_raster(AXIS, AXIS, values))
    insisted = gg.Weight.on_raster(AXIS, AXIS, values, allow_negative=True)
    assert "no lower bound" in gg.optimize(grid, "area", weight=insisted, max_iterations=1).message
