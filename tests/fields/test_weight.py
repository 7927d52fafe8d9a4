"""Weights: all kinds of sources give one grid, bad ones are refused by name, both modes differentiate as told."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support_solvers import (
    METHODS,
    assert_consistent,
    energy_differences,
    farthest,
    gradient_differences,
    gradient_norm,
    mild_grid,
    relative,
)

import gridgen_sym as gg

FORMULA = "1 + 3*exp(-8*((x - 0.4)**2 + (y - 0.5)**2))"
WEIGHTED = ("area", "combined")
MODES = ("frozen", "differentiated")


def function(x, y):
    return 1 + 3 * np.exp(-8 * ((x - 0.4) ** 2 + (y - 0.5) ** 2))


def both_branches_negative(x, y):
    return np.sin(2 * np.pi * x) * np.sin(2 * np.pi * y)


each_method = pytest.mark.parametrize("method", METHODS)
each_weighted = pytest.mark.parametrize("name", WEIGHTED)


# ---- sources ----


@pytest.mark.slow
@each_weighted
@each_method
@pytest.mark.parametrize("mode", MODES)
def test_a_formula_and_a_function_give_one_result(name, method, mode):
    start = mild_grid()
    formula, called = (
        gg.optimize(start, name, method, weight=gg.Weight(source, mode), max_iterations=8)
        for source in (FORMULA, function)
    )
    # Derivatives of a function are differences, good to a few digits less; its values are the same.
    assert farthest(formula.grid, called.grid) < (1e-6 if mode == "differentiated" else 1e-12)
    assert farthest(formula.grid, gg.optimize(start, name, method, max_iterations=8).grid) > 1e-3


@each_weighted
def test_an_array_is_the_weight_at_the_nodes(name):
    grid = mild_grid()
    values = function(grid.x, grid.y)
    for source in (values, values.tolist(), np.asfortranarray(values), values[::-1][::-1]):
        assert gg.energy(grid, name, weight=source) == gg.energy(grid, name, weight=FORMULA)
        assert np.array_equal(gg.gradient(grid, name, weight=source), gg.gradient(grid, name, weight=function))


@pytest.mark.parametrize("number", [2, 2.0, np.float64(2), lambda x, y: 2, "2", "1 + 1"])
def test_a_number_multiplies_the_energy_of_area(number):
    grid = mild_grid()
    assert gg.energy(grid, "area", weight=number) == pytest.approx(2 * gg.energy(grid, "area"), rel=1e-14)
    for mode in MODES:
        gradient = gg.gradient(grid, "area", weight=gg.Weight(number, mode))
        assert relative(gradient, 2 * gg.gradient(grid, "area")) < 1e-12


def test_a_bare_source_is_frozen():
    grid = mild_grid()
    bare, frozen, moving = (
        gg.gradient(grid, "area", weight=weight)
        for weight in (FORMULA, gg.Weight(FORMULA), gg.Weight(FORMULA, "differentiated"))
    )
    assert np.array_equal(bare, frozen)
    assert relative(bare, moving) > 0.01


@pytest.mark.parametrize("name", ["winslow", "length"])
def test_the_weight_multiplies_a_density_that_does_not_name_it(name):
    grid = mild_grid()
    options = {"backend": "numpy"}
    assert gg.energy(grid, name, weight=3.0, **options) == pytest.approx(3 * gg.energy(grid, name), rel=1e-13)
    one = gg.gradient(grid, name, weight="1", **options)
    assert relative(one, gg.gradient(grid, name)) < 1e-12
    assert relative(gg.gradient(grid, name, weight=FORMULA, **options), one) > 0.1


# ---- derivatives ----


@pytest.mark.slow
@each_weighted
@pytest.mark.parametrize("interior_only", [False, True])
@pytest.mark.parametrize(("source", "accuracy"), [(FORMULA, 1e-6), (function, 1e-5)])
def test_a_differentiated_weight_belongs_to_the_energy(name, interior_only, source, accuracy):
    grid = mild_grid(5, 6)
    options = {"weight": gg.Weight(source, "differentiated"), "interior_only": interior_only}
    gradient = gg.gradient(grid, name, **options)
    assert relative(gradient, energy_differences(grid, name, 1e-5, **options)) < accuracy
    hessian = gg.hessian(grid, name, **options).toarray()
    assert relative(hessian, gradient_differences(grid, name, 1e-5, **options)) < 10 * accuracy


@each_weighted
def test_a_frozen_weight_is_held(name):
    grid = mild_grid(5, 6)
    held = {"weight": function(grid.x, grid.y)}
    gradient = gg.gradient(grid, name, weight=FORMULA)
    assert relative(gradient, energy_differences(grid, name, 1e-5, **held)) < 1e-6
    assert relative(gradient, energy_differences(grid, name, 1e-5, weight=FORMULA)) > 0.01
    hessian = gg.hessian(grid, name, weight=FORMULA).toarray()
    assert relative(hessian, gradient_differences(grid, name, 1e-5, **held)) < 1e-6


# ---- solves ----


@each_method
@pytest.mark.parametrize("mode", MODES)
def test_weighted_solves_converge(method, mode):
    start, weight = mild_grid(), gg.Weight(FORMULA, mode)
    result = gg.optimize(start, "combined", method, weight=weight)
    assert result.converged, result.message
    assert gradient_norm(result.grid, "combined", weight=weight) <= 1.001e-6 * gradient_norm(
        start, "combined", weight=weight
    )
    assert_consistent(result, "combined", weight=weight)


@pytest.mark.parametrize("mode", MODES)
def test_both_methods_find_one_weighted_grid(mode):
    newton, local = (
        gg.optimize(mild_grid(), "combined", method, weight=gg.Weight(FORMULA, mode), tolerance=1e-9)
        for method in METHODS
    )
    assert newton.converged
    assert local.converged
    assert farthest(newton.grid, local.grid) < 1e-6


@pytest.mark.parametrize("mode", MODES)
def test_the_equations_take_a_weight(mode):
    """The weighted minimum solves them, up to the error of the differences."""
    start, weight = mild_grid(17, 17), gg.Weight(FORMULA, mode)
    half_area = {"k_A": 0.5, "k_L": 0.5, "k_O": 0.0}
    plain = gg.solve_euler_lagrange(start, "combined", parameters=half_area)
    solution = gg.solve_euler_lagrange(start, "combined", weight=weight, parameters=half_area)
    assert solution.converged, solution.message
    minimum = gg.optimize(start, "combined", weight=weight, parameters=half_area)
    assert farthest(solution.grid, minimum.grid) < 0.002 < 0.01 < farthest(solution.grid, plain.grid)


# ---- refusals ----

TAKES_A_WEIGHT = {
    "optimize": gg.optimize,
    "solve_euler_lagrange": gg.solve_euler_lagrange,
    "energy": gg.energy,
    "gradient": gg.gradient,
    "hessian": gg.hessian,
}


@pytest.fixture(params=TAKES_A_WEIGHT, scope="module")
def weighed(request):
    return lambda weight: TAKES_A_WEIGHT[request.param](mild_grid(9, 8), "area", weight=weight)


def spoiled(value):
    values = np.ones((9, 8))
    values[3, 5] = value
    return values


@settings(max_examples=25)
@given(
    value=st.sampled_from([np.nan, np.inf, -np.inf]),
    node=st.tuples(st.integers(0, 8), st.integers(0, 7)),
    rest=st.floats(0, 1e300),
)
def test_a_weight_that_is_not_finite_is_refused_with_its_node(weighed, value, node, rest):
    values = np.full((9, 8), rest)
    values[node] = value
    for source in (values, values.tolist(), lambda x, y: values):
        with pytest.raises(gg.GridgenError) as caught:
            weighed(source)
        assert f"must be finite at every node; it is {value} at node {node}, x = " in str(caught.value)


def test_a_formula_that_is_not_finite_is_refused_with_its_node(weighed):
    with pytest.raises(gg.GridgenError, match=r"finite at every node; it is nan at node \(0, 0\), x = 0, y = 0"):
        weighed("sqrt(x + y - 0.001)")


def test_a_negative_weight_is_refused_with_its_node(weighed):
    with pytest.raises(
        gg.GridgenError, match=r"must not be negative: it is -2.5 at node \(3, 5\).*allow_negative=True"
    ):
        weighed(spoiled(-2.5))


@pytest.mark.parametrize("shape", [(8, 9), (9,), (9, 8, 1), (7, 6), (0,)])
def test_a_weight_of_another_shape_is_refused(weighed, shape):
    with pytest.raises(gg.GridgenError, match=r"weight must have one value per node, shape \(9, 8\)"):
        weighed(np.ones(shape))
    with pytest.raises(gg.GridgenError, match=r"weight must have one value per node, shape \(9, 8\)"):
        weighed(lambda x, y: np.ones(shape))


@pytest.mark.parametrize("formula", ["x +", "x^2", "1 + z", "__import__('os')", "x.real", "[x]", "", "x if y else 1"])
def test_a_formula_that_is_none_is_refused_with_its_text(weighed, formula):
    with pytest.raises(gg.GridgenError) as caught:
        weighed(formula)
    assert repr(formula) in str(caught.value)


@pytest.mark.parametrize(
    "weight",
    [
        pytest.param(weight, id=name)
        for name, weight in {
            "a division by zero": "1/0",
            "text in an array": np.full((9, 8), "a"),
            "a dictionary": {},
            "complex numbers": np.ones((9, 8), dtype=complex),
            "masked numbers": np.ma.masked_less(np.eye(9, 8), 0.5),
            "a function that gives text": lambda x, y: "a",
            "a function of one argument": lambda x: x,
            "a function that gives ragged lists": lambda x, y: [[1, 2], [1]],
        }.items()
    ],
)
def test_a_weight_that_is_no_number_is_refused(weighed, weight):
    with pytest.raises(gg.GridgenError, match="weight"):
        weighed(weight)


@pytest.mark.parametrize(
    "values",
    [
        np.ones((9, 8)),
        np.ones((9, 8)).tolist(),
    ],
    ids=["array", "lists"],
)
def test_an_array_cannot_be_differentiated(values):
    with pytest.raises(gg.GridgenError, match="an array of weights has no derivatives"):
        gg.gradient(mild_grid(9, 8), "area", weight=gg.Weight(values, "differentiated"))


def test_a_derivative_that_is_not_finite_is_refused_with_its_node():
    with pytest.raises(gg.GridgenError, match=r"node \(0, 0\)"):
        gg.gradient(gg.domain("square", 7, 7), "area", weight=gg.Weight("1 + sqrt(x)", "differentiated"))


def test_a_mode_that_is_none_is_refused():
    with pytest.raises(gg.GridgenError, match="mode must be 'frozen' or 'differentiated'; came 'melted'"):
        gg.Weight(FORMULA, mode="melted")


@each_method
def test_a_negative_weight_that_is_wanted_comes_with_a_caution(method):
    start = gg.domain("square", 10, 10)
    weight = gg.Weight("5 + 200*sin(2*pi*x)*sin(2*pi*y)", allow_negative=True)
    result = gg.optimize(start, "area", method, weight=weight, max_iterations=5)
    negative = int((5 + 200 * both_branches_negative(result.grid.x, result.grid.y) < 0).sum())
    assert negative > 0
    assert f"negative at {negative} of 100 nodes" in result.message
    assert "no lower bound" in result.message
    assert result.quality.valid


@pytest.mark.parametrize(
    ("name", "bound"),
    [("area", "has no lower bound, and no grid"), ("area_winslow", "may have no lower bound, and then")],
)
def test_where_a_barrier_bounds_the_jacobian_a_lower_bound_is_not_denied(name, bound):
    weight = gg.Weight("x - 0.2", allow_negative=True)
    assert bound in gg.optimize(gg.domain("square", 9, 9), name, weight=weight, max_iterations=1).message


@pytest.mark.parametrize(
    ("name", "said"), [("area", "every grid has the energy zero"), ("area_winslow", "it asks nothing")]
)
def test_a_weight_that_is_zero_everywhere_is_told(name, said):
    result = gg.optimize(gg.domain("square", 9, 9), name, weight="0*x", max_iterations=1)
    assert f"The weight is zero at every node: {said}" in result.message


def test_a_positive_weight_comes_without_a_caution():
    weight = gg.Weight(FORMULA, allow_negative=True)
    assert "negative" not in gg.optimize(mild_grid(), "area", weight=weight).message


def test_a_weight_that_goes_bad_on_the_way_is_refused():
    """Sources are evaluated again where nodes go, and so is the check."""
    calls = []

    def failing(x, y):
        calls.append(1)
        return np.ones_like(x) if len(calls) < 3 else np.full_like(x, np.nan)

    with pytest.raises(gg.GridgenError, match="weight must be finite"):
        gg.optimize(mild_grid(), "area", weight=failing)
