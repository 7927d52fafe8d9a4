"""The tie between the two derivations: the discrete gradient tends to the Euler-Lagrange residual, at second order.

The corner energies, summed over a grid on a smooth map, are a quadrature of 4 `corner_factor` times the integral; so
the gradient at an inner node over that factor and h_xi h_eta tends to the functional derivative, which is minus the
residual. The two were derived apart from each other (from corners; from the jets of a map), so that an error in either
shows here. The residual kernel, which takes central differences, must tend to the residual of the exact derivatives as
well.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache, lru_cache

import numpy as np
import pytest
import sympy
from support import EQUATION_CASES, case_name, derived_kernel, kernel_set, observed_order, rendered, tiered

from gridgen_sym.backends.numpy.loader import load
from gridgen_sym.functionals import define, functional
from gridgen_sym.symbolic.derive.continuous import euler_lagrange

SECOND_ORDER = 1.8
#: Cells along u at the two resolutions; along v the spacing is another one.
COARSE, FINE = 16, 32
RATIO = 0.8

u, v, x, y = sympy.symbols("u v x y", real=True)
MAP = {"x": u + v / 5 + sympy.sin(2 * u + v) / 7, "y": u / 10 + 11 * v / 10 + sympy.cos(u - 2 * v) / 8}
WEIGHT = 2 + sympy.sin(sympy.Rational(9, 10) * x + sympy.Rational(3, 5) * y)


@lru_cache(maxsize=1)
def exact_functions():
    """Return the map, the weight and their derivatives as functions of (u, v)."""
    result = {}
    for name, expression in MAP.items():
        result[name] = expression
        for order in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
            suffix = "xi" * order[0] + "eta" * order[1]
            result[f"{name}_{suffix}"] = sympy.diff(expression, u, order[0], v, order[1])
    for order in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        slope = sympy.diff(WEIGHT, x, order[0], y, order[1])
        result[f"s_{'x' * order[0]}{'y' * order[1]}".rstrip("_")] = slope.subs({x: MAP["x"], y: MAP["y"]})
    along = result["s"]
    result["s_xi"], result["s_eta"] = sympy.diff(along, u), sympy.diff(along, v)
    return {name: sympy.lambdify((u, v), value, "numpy") for name, value in result.items()}


def sample(cells):
    """Return everything exact at the nodes."""
    points = np.meshgrid(np.arange(cells + 1) / cells, RATIO * np.arange(cells + 1) / cells, indexing="ij")
    one = np.ones_like(points[0])
    return {name: one * function(*points) for name, function in exact_functions().items()}


@cache
def exact_equations(definition, variant):
    """Return the residual and the matrix in front of the reduced system, as functions of the sampled values."""
    equations = euler_lagrange(definition, variant)
    matrix = equations.reduction.operator.matrix if equations.reduction else sympy.eye(2)
    parts = [*equations.expanded(), *matrix]
    parts = [
        part.subs({sympy.Symbol(p, real=True): value for p, value in definition.parameters.items()}) for part in parts
    ]
    # The second derivative of abs() is zero but at one point, which the map does not meet.
    parts = [part.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero) for part in parts]
    symbols = sorted(set().union(*(part.free_symbols for part in parts)), key=str)
    function = sympy.lambdify(symbols, parts, "numpy", cse=True)

    def values(sampled):
        shape = sampled["x"].shape
        told = [np.broadcast_to(part, shape) for part in function(*(sampled[str(symbol)] for symbol in symbols))]
        return np.array(told[:2]), np.array(told[2:]).reshape(2, 2, *shape)

    return values


def relative_error(found, expected, cells):
    """Return the largest error at the inner nodes of the coarse grid, over the largest expected value."""
    shared = (slice(None), *(slice(cells // COARSE, -(cells // COARSE), cells // COARSE),) * 2)
    return float(np.abs(found - expected)[shared].max() / np.abs(expected[shared]).max())


def planes(kernels, sampled):
    return np.array([sampled[name] for name in kernels.planes]) if kernels.planes else None


def gradient_error(definition, kernels, cells):
    """Compare the gradient, over 4 corner_factor and the area of a node's cell, with minus the residual."""
    sampled, spacing = sample(cells), (1 / cells, RATIO / cells)
    xy = np.array([sampled["x"], sampled["y"]])
    gradient = kernels.energy_gradient(xy, planes(kernels, sampled), spacing)[2]
    residual, _ = exact_equations(definition, kernels.variant)(sampled)
    return relative_error(gradient / (4 * definition.corner_factor * spacing[0] * spacing[1]), -residual, cells)


def residual_error(definition, kernels, cells):
    """Compare matrix . residual kernel with the exact residual; the matrix is 1 but for reduced systems."""
    sampled = sample(cells)
    xy = np.array([sampled["x"], sampled["y"]])
    system = kernels.euler_lagrange_residual(xy, planes(kernels, sampled), (1 / cells, RATIO / cells))
    residual, matrix = exact_equations(definition, kernels.variant)(sampled)
    return relative_error(np.einsum("pqij,qij->pij", matrix, system), residual, cells)


def order_of(error, definition, kernels):
    return observed_order(error(definition, kernels, COARSE), error(definition, kernels, FINE))


def blend(m, k=0.5, p=1.5):
    """A functional of a user: fractional powers, functions and parameters."""
    return m.sqrt(m.g11 * m.g22) / m.J + k * m.exp(m.g12) + (m.g11 + m.g22) ** p / 3 - k * m.log(m.J) + abs(m.x_xi)


@pytest.fixture(params=["plain", "frozen", "differentiated"])
def user_case(request, clean_registry):
    return define("blend", blend, corner_factor=3), request.param


@pytest.mark.parametrize("case", tiered(EQUATION_CASES), ids=case_name)
def test_the_discrete_gradient_tends_to_the_residual(case):
    assert order_of(gradient_error, functional(case[0]), kernel_set(*case)) > SECOND_ORDER
    assert gradient_error(functional(case[0]), kernel_set(*case), FINE) < 0.02


@pytest.mark.parametrize("case", tiered(EQUATION_CASES), ids=case_name)
def test_the_residual_kernel_tends_to_the_residual(case):
    assert order_of(residual_error, functional(case[0]), kernel_set(*case)) > SECOND_ORDER
    assert residual_error(functional(case[0]), kernel_set(*case), FINE) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("error", [gradient_error, residual_error])
def test_both_hold_for_a_functional_of_a_user(user_case, error):
    definition, variant = user_case
    assert order_of(error, definition, kernel_set(definition, variant)) > SECOND_ORDER


# ---- failures made on purpose ----


def broken_kernels(case, function, output, change):
    """Return NumPy kernels in whose text one line of one function was changed."""
    text = rendered(*case, "numpy")
    first, head, body = text.partition(f"def {function}(")
    changed, count = re.subn(rf"(\n    {output} =)(.*)", change, body, count=1)
    assert count == 1
    functions = load(derived_kernel(*case).facts, first + head + changed)
    return replace(kernel_set(*case), _functions=functions)


@pytest.mark.parametrize("case", [("winslow", "plain"), ("knupp", "plain"), ("area", "differentiated")], ids=case_name)
@pytest.mark.parametrize("change", [r"\1-(\2)", r"\1 2.0*(\2)"], ids=["sign", "factor"])
@pytest.mark.parametrize(
    ("error", "program", "place"),
    [
        (gradient_error, "corner_slopes", 1),
        (gradient_error, "corner_slopes", -1),
        (residual_error, "residual", 0),
        (residual_error, "residual", 1),
    ],
)
def test_a_flipped_sign_or_a_lost_factor_does_not_converge(case, change, error, program, place):
    output = derived_kernel(*case).programs[program].outputs[place]
    assert order_of(error, functional(case[0]), broken_kernels(case, program, output, change)) < 0.5


@pytest.mark.parametrize("component", ["x", "y"])
@pytest.mark.parametrize("function", ["slope_along_xi", "slope_along_eta"])
@pytest.mark.parametrize("change", [r"\1-(\2)", r"\1 0.5*(\2)"], ids=["sign", "factor"])
def test_a_broken_chain_rule_does_not_converge(change, function, component):
    broken = broken_kernels(("winslow", "plain"), function, component, change)
    assert order_of(gradient_error, functional("winslow"), broken) < 0.5


def test_a_lost_slope_of_the_weight_does_not_converge():
    broken = broken_kernels(("area", "differentiated"), "corner_slopes", "p0", r"\1 0.0*(\2)")
    assert order_of(gradient_error, functional("area"), broken) < 0.5


def test_a_wrong_corner_factor_does_not_converge():
    wrong = replace(functional("area"), corner_factor=1)
    assert order_of(gradient_error, wrong, kernel_set("area")) < 0.5
