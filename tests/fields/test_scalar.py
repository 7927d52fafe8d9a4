"""One field from anything: every form gives the same values, and what is no field is refused by name."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

import gridgen_sym as gg
from gridgen_sym.fields import as_scalar, grid_field, raster_field, scattered_field

SQUARE = gg.domain("square", 9, 8)
AXIS = np.linspace(0, 1, 21)
PLANE = np.stack(np.meshgrid(AXIS, AXIS, indexing="ij"))


def line(x, y):
    return 1 + 2 * x - y


FORMS = {
    "text": "1 + 2*x - y",
    "SymPy": 1 + 2 * sympy.Symbol("x") - sympy.Symbol("y"),
    "function": line,
    "raster": raster_field(AXIS, AXIS, line(*PLANE)),
    "points": scattered_field(PLANE.reshape(2, -1).T, line(*PLANE).ravel()),
    "grid": grid_field(gg.Grid.from_planes(*PLANE), line(*PLANE)),
    "nodes": line(*SQUARE.planes),
    "lists": line(*SQUARE.planes).tolist(),
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_has_the_same_values(form):
    field = as_scalar(FORMS[form], "the weight")
    np.testing.assert_allclose(field.values(*SQUARE.planes), line(*SQUARE.planes), atol=1e-12)
    assert field.per_node == (form in ("nodes", "lists"))
    assert as_scalar(field, "another") is field


@pytest.mark.parametrize("form", sorted(set(FORMS) - {"nodes", "lists"}))
def test_every_form_of_place_has_the_same_derivatives(form):
    x, y = 0.1 + 0.8 * SQUARE.planes
    planes = as_scalar(FORMS[form], "the weight").derivatives(x, y, ("x", "y", "xx", "xy", "yy"))
    for plane, expected in zip(planes, (2, -1, 0, 0, 0), strict=True):
        np.testing.assert_allclose(plane, np.full(SQUARE.shape, float(expected)), atol=1e-6)


@pytest.mark.parametrize("form", sorted(set(FORMS) - {"nodes", "lists"}))
def test_one_conversion_serves_weights_adaptation_and_errors(form):
    """The same forms are taken everywhere, and mean the same."""
    given = FORMS[form]
    expected = gg.energy(SQUARE, "area", weight=line)
    assert gg.energy(SQUARE, "area", weight=given) == pytest.approx(expected)
    assert gg.interpolation_error(SQUARE, given) < 1e-12
    adapted = gg.adapt(SQUARE, given, max_iterations=1)
    np.testing.assert_allclose(adapted.values, line(*adapted.grid.planes), atol=1e-9)
    assert gg.equidistribution(SQUARE, given).weight.variation == pytest.approx(
        gg.equidistribution(SQUARE, line).weight.variation
    )


@pytest.mark.parametrize(
    "number", [3, 3.0, np.float32(3), np.array(3.0), "3", "1 + 2", lambda x, y: 3, sympy.Integer(3)]
)
def test_a_single_number_is_a_constant_field(number):
    field = as_scalar(number, "the weight")
    np.testing.assert_array_equal(field.values(*SQUARE.planes), np.full(SQUARE.shape, 3.0))
    np.testing.assert_array_equal(field.derivatives(*SQUARE.planes, ("x", "xy")), 0)
    assert not field.per_node


def test_numbers_per_cell_are_averaged_at_the_nodes():
    cells = np.add.outer(np.arange(8.0), np.arange(7.0))
    found = as_scalar(cells, "the weight").values(*SQUARE.planes)
    np.testing.assert_allclose(found[1:-1, 1:-1], np.add.outer(np.arange(7) + 0.5, np.arange(6) + 0.5))


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ("x + z", "the field f: unknown name 'z'"),
        (sympy.Symbol("z"), "the field f: the formula z contains z: use only the symbols x and y"),
        (lambda x: x, r"the field f must be a function of two arrays \(x, y\); came one of 1 arguments"),
        (np.sin, r"the field f must be a function of two arrays \(x, y\); came one of 1 arguments"),
        (lambda x, y, z: x, "came one of 3 arguments"),
        (np.ones((9, 8), dtype=complex), "the field f must be an array of real numbers"),
        (np.ma.masked_less(np.eye(9, 8), 0.5), "the field f must all be there"),
        ({}, "the field f must be an array of real numbers"),
        (None, "the field f must be"),
        (np.ones((3, 3)), r"the field f must have one value per node, shape \(9, 8\), per cell, shape"),
        (lambda x, y: x[1:], r"the field f must have one value per node, shape \(9, 8\)"),
        (lambda x, y: {}["u"], r"the field f .* cannot be evaluated: KeyError\('u'\)"),
        ("1/(x - 0.5)", r"the field f must be finite at every node; it is inf at node \(4, 0\), x = 0.5, y = 0"),
        ("log(-1)", r"the field f must be finite at every node; it is nan at node \(0, 0\)"),
        (
            np.where(SQUARE.y > 0.99, np.nan, 1.0),
            r"the field f must be finite at every node; it is nan at node \(0, 7\)",
        ),
    ],
)
def test_what_is_no_field_is_refused_by_name(given, match):
    with pytest.raises(gg.GridgenError, match=match):
        as_scalar(given, "the field f").values(*SQUARE.planes)


def test_derivatives_are_checked_too():
    with pytest.raises(
        gg.GridgenError, match=r"the field f's derivative along x must be finite at every node; it is inf"
    ):
        as_scalar("sqrt(x)", "the field f").derivatives(*SQUARE.planes, ("x",))
    with pytest.raises(gg.GridgenError, match="the field f is an array, and has no derivatives"):
        as_scalar(np.ones((9, 8)), "the field f").derivatives(*SQUARE.planes, ("x",))


def test_a_function_may_have_more_arguments_that_need_not_be_given():
    assert as_scalar(lambda x, y=0.0, *, power=1: x**power, "the weight").values(*SQUARE.planes).shape == (9, 8)
    assert as_scalar(np.hypot, "the weight").values(*SQUARE.planes)[0, -1] == 1.0
