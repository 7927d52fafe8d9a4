"""Formulas: read once, evaluated on arrays, and their exact derivatives, against SymPy's to 30 digits."""

from __future__ import annotations

import subprocess
import sys

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import gridgen_sym as gg
from gridgen_sym.fields.formula import Formula, SymbolicFormula
from gridgen_sym.fields.jets import FUNCTIONS
from gridgen_sym.functionals.expression import FUNCTION_NAMES, FUNCTIONS_OF_ONE
from gridgen_sym.functionals.metric import sympy_functions

ALONG = ("x", "y", "xx", "xy", "yy")
X, Y = sympy.symbols("x y", real=True)
#: Where every function of a formula has derivatives.
POINTS = np.random.default_rng(3).uniform(0.2, 0.9, (2, 3, 4))


def exact(text, x, y):
    """Return the value and the derivatives by SymPy, to 30 digits."""
    names = {"x": X, "y": Y, "pi": sympy.pi} | sympy_functions()
    value = sympy.sympify(text, locals=names, rational=True)
    of_place = [value, *(sympy.diff(value, *(names[name] for name in key)) for key in ALONG)]
    of_place = [one.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero) for one in of_place]
    compute = sympy.lambdify((X, Y), of_place, "mpmath")
    with mpmath.workdps(30):
        found = [
            [float(one) for one in compute(mpmath.mpf(p), mpmath.mpf(q))] for p, q in zip(x.flat, y.flat, strict=True)
        ]
    return np.array(found).T.reshape(-1, *x.shape)


def assert_exact(text, x, y):
    formula, (value, *planes) = Formula(text), exact(text, x, y)
    np.testing.assert_allclose(np.broadcast_to(formula.values(x, y), x.shape), value, rtol=1e-12)
    for key, plane, expected in zip(ALONG, formula.derivatives(x, y, ALONG), planes, strict=True):
        atol = 1e-12 * (1 + np.abs(expected).max())
        np.testing.assert_allclose(np.broadcast_to(plane, x.shape), expected, rtol=1e-11, atol=atol, err_msg=key)


@pytest.mark.parametrize("name", FUNCTIONS_OF_ONE)
def test_every_function_has_its_derivatives(name):
    assert_exact(f"{name}((x*y + x**2/3)/2)", *POINTS)


SEVERAL = [
    *("atan2(x*y - 1/3, x - y)", "atan2(x - 1, 2)", "atan2(2, x)*y"),
    *("max(x*y, x**2, y/2)", "max(0, x - y)**2*y", "max(x, 1/2)", "max(2, 3)*x"),
    *("min(x*y, x**2, y/2)", "min(1/2, x)*min(y, 2*x)", "exp(min(x, y))"),
    *("where(x < y, x*y, y**3)", "where(x*y >= 1/4, sin(x), 2)", "where(x > y, 1, 2)*x", "where(1 < 2, x, y)"),
    *("where(x <= y, where(x + y < 1, x, y), x*y)", "where(x > 1/2, log(x - 1/2), 0)"),
]


@pytest.mark.parametrize("text", SEVERAL)
def test_functions_of_several_arguments_have_theirs(text):
    assert_exact(text, *POINTS)
    symbolic = SymbolicFormula(sympy.sympify(text, locals={"x": X, "y": Y} | sympy_functions(), rational=True))
    for one, other in zip(symbolic.derivatives(*POINTS, ALONG), Formula(text).derivatives(*POINTS, ALONG), strict=True):
        np.testing.assert_allclose(*np.broadcast_arrays(one, other), rtol=1e-11, atol=1e-13)


def test_there_is_no_function_without_derivatives():
    assert set(FUNCTIONS) == set(FUNCTIONS_OF_ONE)
    assert all(any(f"{name}(" in text for text in SEVERAL) for name in {*FUNCTION_NAMES} - {*FUNCTIONS_OF_ONE})


@pytest.mark.parametrize(
    ("text", "slope"),
    [
        *(("max(x*y, y)", 1), ("max(y, x*y)", 0), ("min(x*y, y)", 1), ("min(y, x*y)", 0), ("max(y, x*y, 2*x - 1)", 0)),
        *(("where(x <= y, 2*x, 3*x)", 2), ("where(x < y, 2*x, 3*x)", 3)),
        *(("where(x >= y, 2*x, 3*x)", 2), ("where(x > y, 2*x, 3*x)", 3)),
    ],
)
def test_the_derivative_at_a_tie_is_that_of_one_branch(text, slope):
    tie = np.ones((1, 1))
    assert Formula(text).derivatives(tie, tie, ("x",))[0] == slope
    symbolic = SymbolicFormula(sympy.sympify(text, locals={"x": X, "y": Y} | sympy_functions()))
    assert symbolic.derivatives(tie, tie, ("x",))[0] == slope


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (sympy.Max(X, Y, X * Y), "max(x, y, x*y)"),
        (sympy.Min(X, 1) ** 2, "min(x, 1)**2"),
        (sympy.Piecewise((X, X >= Y), (Y**2, X > 0.3), (0, True)), "where(x >= y, x, where(x > 0.3, y**2, 0))"),
        (sympy.Piecewise((sympy.log(X - Y), X > Y), (0, True)), "where(x > y, log(x - y), 0)"),
    ],
)
def test_sympys_choices_are_those_of_formulas(given, text):
    one, other = SymbolicFormula(given), Formula(text)
    np.testing.assert_array_equal(one.values(*POINTS), other.values(*POINTS))
    for first, second in zip(one.derivatives(*POINTS, ALONG), other.derivatives(*POINTS, ALONG), strict=True):
        np.testing.assert_allclose(*np.broadcast_arrays(first, second), rtol=1e-13)


@pytest.mark.parametrize(
    "text",
    [
        *("x + y", "x - y", "x*y", "x/y", "x**y", "-x**3", "+x*x"),
        *("2 + x", "2 - x", "2*x", "2/x", "2**x", "x + 2", "x - 2", "x/2", "x**2", "x**-1.5", "x**0", "(x + y)**1"),
        *("3", "pi", "x", "2**0.5", "sqrt(2)*x", "0*x", "1/(x*y)**2/(x + y)", "x*y*x*y", "exp(x)**y"),
    ],
)
def test_every_operation_has_its_derivatives(text):
    assert_exact(text, *POINTS)


LEAVES = st.sampled_from(["x", "y", "pi", "2", "0.3", "1"])


def joined(parts):
    binary = st.tuples(parts, st.sampled_from("+-*/"), parts).map("({0[0]} {0[1]} (3 + {0[2]}))".format)
    called = st.tuples(st.sampled_from(["sin", "cos", "tanh", "atan", "exp"]), parts).map("{0[0]}({0[1]}/9)".format)
    return binary | called | parts.map("({})**2".format)


@settings(max_examples=40, deadline=None)
@given(st.recursive(LEAVES, joined, max_leaves=5))
def test_any_formula_has_its_derivatives(text):
    x, y = np.array([[0.37]]), np.array([[0.61]])
    assert_exact(text, x, y)


def test_kinks_have_one_sided_derivatives_and_no_second_ones():
    x, y = np.array([[-1.0, 0.0, 2.0]]), np.ones((1, 3))
    slope, second = Formula("abs(x)*y").derivatives(x, y, ("x", "xx"))
    np.testing.assert_array_equal(slope, [[-1, 0, 1]])
    np.testing.assert_array_equal(second, 0)


def test_only_what_is_asked_for_is_there():
    x, y = POINTS
    first = Formula("x**3*y").derivatives(x, y, ("y", "x"))
    np.testing.assert_allclose(first, [x**3, 3 * x**2 * y], rtol=1e-14)


def test_a_formula_is_read_once(monkeypatch):
    calls = []
    import gridgen_sym.fields.formula as module

    monkeypatch.setattr(module, "evaluate", lambda *arguments, e=module.evaluate: calls.append(1) or e(*arguments))
    weight = gg.Weight("1 + 3*exp(-8*((x - 0.4)**2 + (y - 0.5)**2))", "differentiated")
    assert gg.optimize(gg.domain("square", 9, 9), "combined", weight=weight).iterations > 1
    assert len(calls) == 1


def test_values_and_derivatives_of_text_do_without_sympy():
    code = (
        "import sys, gridgen_sym as gg; square = gg.domain('square', 7, 7);"
        "weight = gg.Weight('1 + x**2*y', 'differentiated');"
        "gg.gradient(square, 'area', weight=weight); gg.adapt(square, 'tanh(9*x*y)', max_iterations=1);"
        "gg.interpolation_error(square, 'x*y'); sys.exit('sympy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    ("source", "match"),
    [
        ("x + z", "unknown name 'z'"),
        ("1/0", "no value: float division by zero"),
        ("x^2", "not a power"),
        ("exp(x, y)", "exp takes exactly one argument, and 2 came"),
        ("where(0 < x < y, x, y)", "with the condition '0 < x < y': it must be one comparison"),
        ("where(x == y, x, y)", "with the condition 'x == y': it must be one comparison"),
        ("where(x, x, y)", "with the condition 'x': it must be one comparison"),
        ("x*(y < 1)", "contains the comparison 'y < 1': a comparison is no value; write where"),
        ("max(x)", "max takes two arguments or more, and 1 came"),
    ],
)
def test_text_that_is_no_formula_is_refused(source, match):
    with pytest.raises(gg.GridgenError, match=match):
        Formula(source)


def test_a_long_sum_is_evaluated_without_recursion():
    text = " + ".join(f"x*{k}" for k in range(1, 150))
    x = np.ones((1, 2))
    assert Formula(text).values(x, x)[0, 0] == 149 * 150 / 2
    (slope,) = Formula(text).derivatives(x, x, ("x",))
    assert slope == 149 * 150 / 2


def test_sympys_expressions_agree_with_text():
    text = "exp(-x*y) + atan(x/y)*abs(x - y)"
    names = {name: sympy.Symbol(name, positive=True) for name in "xy"} | sympy_functions()
    symbolic = SymbolicFormula(sympy.sympify(text, locals=names))
    x, y = POINTS
    for one, other in zip(symbolic.derivatives(x, y, ALONG), Formula(text).derivatives(x, y, ALONG), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-13)
