"""The intermediate representation says what it cannot express; what it can, both printers print right."""

from __future__ import annotations

import ctypes
import shutil
import subprocess

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from support import evaluate, run
from sympy import Rational, exp, log, sqrt

from gridgen_sym.backends.c.printer import CPrinter
from gridgen_sym.backends.numpy.printer import NumpyPrinter
from gridgen_sym.codegen.kernel import Assignment, Program, check_expressible, reciprocal
from gridgen_sym.codegen.lower import LARGEST_PRODUCT, count_operations, lower
from gridgen_sym.errors import GridgenError
from gridgen_sym.functionals.choices import choice, maximum, minimum

COMPILER = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)

a, b = sympy.symbols("a b", real=True)
STEP = choice(b, a, a, b**2)
EXPRESSIONS = [
    sympy.Integer(-3), Rational(2, 3), Rational(-5, 7), sympy.pi, sympy.E * a,
    -a, a - b, b - a, -a - b, -(a + b) * b, 3 * a - 2 * (b - 3 * (a - b)), a - (b - a * (b - 1)),
    Rational(-3, 7) * a, Rational(1, 2) * a * (a - b), -Rational(1, 2) * (a + b) + a**2,
    a / b, 1 / (a * b), -1 / a, 1 / (a + b) - 1 / (a - b), a / b / (a + b) ** 2, -1 / a**2 + b,
    a**2, (a + b) ** 3, (a - b) ** 2 * (a + b) ** 2, a**LARGEST_PRODUCT, a ** (LARGEST_PRODUCT + 1),
    a**-3, (a + b) ** -9,
    sqrt(a), 1 / sqrt(a), sqrt(1 + sqrt(a + b)), a ** Rational(3, 2), a ** Rational(-5, 2), (a + b) ** Rational(1, 3),
    (a * b) ** Rational(-2, 3), a**b, a**-b, (a + b) ** (a * b), 2**a, -(a**b), (a - b) ** 2 / sqrt(a**2 + b**2) ** 3,
    exp(-(a**2)), exp(a - b) / log(a + 2), sympy.Abs(a - b), sympy.Abs(a - b) ** 3, sympy.sign(a - b) * b,
    sympy.sin(a) * sympy.cos(b) - sympy.tan(a), sympy.sinh(a) - sympy.cosh(b) * sympy.tanh(a), sympy.atan(a - b),
    sympy.asin(a / (b + 3)), sympy.acos(-a / (b + 3)), sympy.atan2(a - b, b), maximum(a, b) ** 2, minimum(a - 1, b) * b,
    choice(1, a, b, -a), choice(a, 1, log(a), log(b)), maximum(maximum(a, b), 1) / minimum(a, 1),
    STEP, 1 + STEP, -STEP, 2 * STEP * b, a - (b - STEP),
    sympy.Add(a, sympy.Mul(-1, b - a, evaluate=False), evaluate=False), sympy.Mul(-2, -a, b, evaluate=False),
]  # fmt: skip
POINTS = [(0.8, 1.7), (2.3, 0.4)]


def program_of(expression, name="formula"):
    return lower(name, (a, b), (), {"result": expression})


def expected_value(expression, point):
    with mpmath.workdps(30):
        values = {"a": mpmath.mpf(point[0]), "b": mpmath.mpf(point[1])}
        lowered = run(program_of(expression), values)["result"]
        value = evaluate(expression, values)
        assert abs(lowered - value) <= mpmath.mpf(10) ** -25 * max(1, abs(value))
        return float(value)


def numpy_value(expression, point):
    names = {"np": np, "a": np.float64(point[0]), "b": np.float64(point[1])}
    for name, text in NumpyPrinter().program(program_of(expression)):
        with np.errstate(all="ignore"):  # The branch that does not hold may have no value.
            names[name] = eval(text, names)
    return float(names["result"])


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
@pytest.mark.parametrize("point", POINTS)
def test_numpy_is_printed_right(expression, point):
    assert numpy_value(expression, point) == pytest.approx(expected_value(expression, point), rel=1e-13)


@pytest.fixture(scope="module")
def printed_c(tmp_path_factory):
    """Return the library with one function per expression."""
    if COMPILER is None:
        pytest.skip("needs a C compiler")
    folder = tmp_path_factory.mktemp("printed")
    parts = ["#include <math.h>", "static double sign(double v) { return (double)((v > 0.0) - (v < 0.0)); }"]
    for k, expression in enumerate(EXPRESSIONS):
        lines = CPrinter().program(program_of(expression))
        body = " ".join(f"const double {name} = {text};" for name, text in lines)
        head = f"double f{k}(double a, double b)"
        parts.append(f"{head};\n{head} {{ (void)a, (void)b; {body} return result; }}")
    source, library = folder / "printed.c", folder / "printed.so"
    source.write_text("\n".join(parts) + "\n")
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-fPIC", "-shared"]
    subprocess.run([COMPILER, *strict, "-o", library, source, "-lm"], check=True)
    return ctypes.CDLL(str(library))


@pytest.mark.parametrize("k", range(len(EXPRESSIONS)), ids=[str(expression) for expression in EXPRESSIONS])
@pytest.mark.parametrize("point", POINTS)
def test_c_is_printed_right(printed_c, k, point):
    function = printed_c[f"f{k}"]
    function.argtypes, function.restype = [ctypes.c_double] * 2, ctypes.c_double
    assert function(*point) == pytest.approx(expected_value(EXPRESSIONS[k], point), rel=1e-13)


def combined(parts):
    binary = st.sampled_from(
        [
            *(lambda u, v: u + v, lambda u, v: u - v, lambda u, v: u * v, lambda u, v: u / (v**2 + 1)),
            *(
                maximum,
                minimum,
                lambda u, v: choice(u, v, v * u, sqrt(u - v + 1)),
                lambda u, v: sympy.atan2(u, v**2 + 1),
            ),
        ]
    )
    unary = st.sampled_from([lambda u: -u, lambda u: u**2, lambda u: sqrt(u**2 + 1), lambda u: (u**2 + 1) ** -2])
    return st.one_of(
        st.tuples(binary, parts, parts).map(lambda t: t[0](t[1], t[2])),
        st.tuples(unary, parts).map(lambda t: t[0](t[1])),
    )


FORMULAS = st.recursive(
    st.sampled_from([a, b, sympy.Integer(2), sympy.Integer(-1), Rational(-1, 3), Rational(1, 2)]),
    combined,
    max_leaves=8,
)


@given(FORMULAS)
def test_random_formulas_are_lowered_and_printed_right(expression):
    expected = expected_value(expression, POINTS[0])
    assert numpy_value(expression, POINTS[0]) == pytest.approx(expected, rel=1e-9, abs=1e-9)


# ---- what a program refuses ----


def make_program(*assignments, outputs=("result",)):
    return Program("formula", ("a",), (), outputs, tuple(Assignment(*pair) for pair in assignments), {})


def test_a_program_accepts_names_assigned_before():
    assert make_program(("t0", a + 1), ("result", sympy.Symbol("t0") * a)).outputs == ("result",)


@pytest.mark.parametrize(
    "assignments",
    [
        (("result", b),),
        (("result", sympy.Symbol("t0")), ("t0", a)),
        (("t0", a), ("t0", a + 1), ("result", a)),
        (("a", a + 1), ("result", a)),
        (("other", a),),
    ],
    ids=["unknown", "before its assignment", "assigned twice", "an input assigned", "an output left out"],
)
def test_a_program_refuses_names_out_of_order(assignments):
    with pytest.raises(AssertionError, match="formula"):
        make_program(*assignments)


@pytest.mark.parametrize(
    "expression",
    [
        sympy.Integral(a, a),
        sympy.Function("mystery")(a),
        sympy.Derivative(sympy.Function("mystery")(a), a),
        sympy.erf(a),
        a + sympy.I,
        sympy.Symbol("a", real=True) * sympy.oo,
        sympy.Max(a, b),
        sympy.Piecewise((a, a > b), (b, True)),
    ],
    ids=str,
)
def test_what_cannot_be_expressed_is_refused_with_the_repair(expression):
    with pytest.raises(GridgenError, match=r"no kernel can be generated from .*: write the density with .*sqrt"):
        check_expressible(expression)
    with pytest.raises(GridgenError):
        program_of(expression)


def test_operations_are_counted():
    t = sympy.Symbol("t")
    counted = count_operations(
        [
            Assignment("t", reciprocal(a) * b**3 + sqrt(a)),  # reciprocal; a product of 2, a cube of 2; +; sqrt
            Assignment("result", t - b + exp(t) * 2),  # two terms more; exp; one product
        ]
    )
    assert counted == {"additions": 3, "multiplications": 4, "divisions": 1, "functions": 2}


def test_common_parts_are_computed_once():
    program = lower(
        "formula", (a, b), (), {"first": exp(a * b) + 1, "second": exp(a * b) / (a + b), "third": 1 / (a + b) ** 2}
    )
    assert program.operations["functions"] == 1
    assert program.operations["divisions"] == 1


def test_a_parameter_never_collides_with_a_temporary():
    t0, energy = sympy.symbols("t0 energy", real=True)
    program = lower("formula", (a, b), (t0, energy), {"energy": t0 * exp(a * b) + exp(a * b) * energy})
    assert program.parameters == ("parameter_t0", "parameter_energy")
    values = {"a": mpmath.mpf(1), "b": mpmath.mpf(0), "parameter_t0": mpmath.mpf(2), "parameter_energy": mpmath.mpf(5)}
    assert run(program, values) == {"energy": 7}
