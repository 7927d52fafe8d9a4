"""Densities that cannot be used are refused, with a message that names the repair."""

from __future__ import annotations

import contextlib
import math

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from gridgen_sym.errors import GridgenError
from gridgen_sym.functionals import Functional, define, functional, functionals
from gridgen_sym.functionals.expression import FUNCTION_NAMES
from gridgen_sym.functionals.metric import DENSITY_NAMES, symbolic_metric


@pytest.mark.parametrize(
    ("density", "message"),
    [
        ("J^2", r"\*\*"),
        ("q + J", "unknown name 'q'"),
        ("sqrt(-1)*J", "not real"),
        ("1/(g11 - g11)", "not real and finite"),
        ("log(-J)", "real and finite|not real"),
        ("J +", "cannot be read"),
        ("__import__('os')", "unknown function|not arithmetic"),
        ("3", "does not depend on the grid"),
        (lambda m: m.J ^ 2, r"\*\*"),
        (lambda m: m.area, "cannot use m.area"),
        (lambda m, k: k * m.J, "default value"),
        (lambda m: None, "not a formula"),
    ],
)
def test_bad_densities(density, message):
    before = functionals()
    with pytest.raises(GridgenError, match=message):
        define("bad_density", density)
    assert functionals() == before


def test_names_and_constraints():
    with pytest.raises(GridgenError, match="exists"):
        define("area", "J**2")
    with pytest.raises(GridgenError, match="lower-case"):
        define("Bad Name", "J**2")
    with pytest.raises(GridgenError, match="needs k >= 0"):
        define("bad_density", "k*J**2", parameters={"k": -1}, constraints=("k >= 0",))
    with pytest.raises(GridgenError, match="something else"):
        define("bad_density", "s*J", parameters={"s": 1})
    with pytest.raises(GridgenError, match="k_A \\+ k_L"):
        functional("combined").values({"k_A": 0.9})
    with pytest.raises(GridgenError, match="finite"):
        functional("combined").values({"k_A": float("nan")})
    with pytest.raises(GridgenError, match="Did you mean 'winslow'"):
        functional("winslo")


def recursive(m):
    return recursive(m)


@pytest.mark.parametrize(
    ("density", "message"),
    [
        (None, "must be a function of the metric m, or text .* came None"),
        (5, "must be a function of the metric m, or text .* came 5"),
        (b"g11", "came b'g11'"),
        ("sqrt(g11, g22)", "sqrt takes exactly one argument, and 2 came"),
        ("exp(g11, g22)", "exp takes exactly one argument, and 2 came"),
        ("sin()", "sin takes exactly one argument, and 0 came"),
        (lambda m: m.sqrt(m.g11, m.g22), "takes 1 positional argument but 2 were given"),
        ("+".join(["g11"] * 300), "nests more than 200 operations"),
        ("+".join(["g11"] * 3000), "cannot be read: .* recursion|nests more than 200 operations"),
        ("(" * 3000 + "g11" + ")" * 3000, "cannot be read"),
        ("9**9**9*g11", r"contains '9\*\*9\*\*9': exponents, .* at most 64"),
        ("g11**-65", "at most 64"),
        ("g11**64.5", "at most 64"),
        ("g11**(9*9)", "at most 64"),
        ("((2*g11)**60)**60", "products of nested ones"),
        ("((9**60)**60)**60*g11", "products of nested ones"),
        (lambda m: m.g11**1000, "exponent of more than 64"),
        ("g11**g11**g11**g11", "without a value"),
        ("exp(exp(exp(exp(g11))))", "without a value"),
        ("exp(exp(exp(9)))*g11", r"contains 'exp\(exp\(9\)\)', a number larger than 1e\+300"),
        ("1e999999999*g11", "numbers must be between 1e-300 and"),
        ("1e-999999999*g11", "numbers must be between 1e-300 and"),
        (max, "arguments of the density function 'max' cannot be told"),
        (recursive, "recursion"),
        (lambda m: 1 / 0, "division by zero"),
        (lambda m: sympy.Matrix([m.g11]), "uses ImmutableDenseMatrix, for which there is no kernel"),
        (lambda m: sympy.Integral(m.g11, (m.J, 0, 1)), "uses Integral, for which there is no kernel"),
        (lambda m, k=10**400: k * m.g11, "'k' of functional 'bad_density' is inf"),
    ],
    ids=lambda case: case[:24] if isinstance(case, str) else None,
)
def test_densities_that_are_no_text_or_beyond_all_bounds(density, message):
    test_bad_densities(density, message)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        *(({"corner_factor": bad}, "corner_factor .* whole number") for bad in (0, -1, math.nan, "x", 0.5, True, None)),
        ({"constraints": ("k >>= ",)}, "constraint 'k >>= ' cannot be read"),
        ({"constraints": "k >= 0"}, r"must be a tuple of comparisons, such as \('k >= 0',\); came 'k >= 0'"),
        ({"constraints": (5,)}, "must be a tuple of comparisons"),
        ({"constraints": ("k",)}, "not one comparison"),
        ({"constraints": ("1/(k - 1) >= 0",)}, "has no value for k = 1: .*division by zero"),
        ({"constraints": ("(-k)**0.5 >= 0",)}, "has no value for k = 1"),
        ({"constraints": ("q >= 0",)}, "unknown name 'q'"),
        ({"parameters": {"k": "3"}}, "'k' .* is '3': give a finite number"),
        ({"parameters": {"k": None}}, "give a finite number"),
        ({"parameters": {5: 1}}, "parameter 5 .* not a usable name"),
        ({"parameters": {"k" * 65: 1}}, "has 65 letters: use at most 64"),
        ({"parameters": ["k"]}, "must map names to numbers"),
        ({"description": 5}, "description .* must be text; came 5"),
    ],
)
def test_bad_arguments(arguments, message):
    before = functionals()
    with pytest.raises(GridgenError, match=message):
        define("bad_density", "k*g11", **({"parameters": {"k": 1}} | arguments))
    assert functionals() == before


@pytest.mark.parametrize("name", ["a" * 300, "a" * 65, "def", "", "a/b", None, 5, []])
def test_bad_names(name):
    with pytest.raises(GridgenError, match=r"use lower-case letters|use at most 64"):
        define(name, "g11")


def test_floats_are_taken_with_all_their_digits():
    made = define("exact", lambda m: 2**0.5 * m.g11 + m.J**0.5 / 10)
    m = symbolic_metric()
    assert made.expression() == sympy.Rational("1.4142135623730951") * m.g11 + sympy.sqrt(m.J) / 10
    assert define("exact_text", "1.4142135623730951*g11 + 0.1*J**0.5").expression() == made.expression()


def is_hashable(value):
    return not isinstance(value, list)


ANYTHING = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=4) | st.lists(st.integers())
FORMULAS = st.recursive(
    st.sampled_from(["g11", "J", "s", "k", "2", "0.5", "1e300", "9", "pi", "z"]),
    lambda part: (
        st.tuples(part, st.sampled_from(["+", "-", "*", "/", "**", "^", ","]), part).map("({0[0]}{0[1]}{0[2]})".format)
        | st.tuples(st.sampled_from([*FUNCTION_NAMES, "-", "eval"]), part).map("{0[0]}({0[1]})".format)
    ),
    max_leaves=8,
)
FUNCTIONS = st.sampled_from([max, print, dict, recursive, lambda m: m.J, lambda m, k=2: k * m.g11, lambda: 1])


@settings(deadline=None, max_examples=200)
@given(
    name=st.just("anything") | ANYTHING,
    density=FORMULAS | FUNCTIONS | ANYTHING,
    options=st.fixed_dictionaries(
        {},
        optional={
            "parameters": st.just({"k": 1.5}) | st.dictionaries(st.just("k") | ANYTHING.filter(is_hashable), ANYTHING)
            | ANYTHING,
            "constraints": st.tuples(st.sampled_from(["k >= 0", "k"]) | FORMULAS.map("{} > 0".format) | ANYTHING)
            | ANYTHING,
            "corner_factor": st.integers(1, 3) | ANYTHING,
            "description": ANYTHING,
        },
    ),
)  # fmt: skip
def test_any_arguments_give_a_functional_or_a_gridgen_error(name, density, options):
    before = functionals()
    try:
        made = define(name, density, replace=True, **options)
    except GridgenError:
        assert functionals() == before
    else:
        assert isinstance(made, Functional)
        assert functional(name) is made


@settings(deadline=None, max_examples=40)
@given(st.text(alphabet="abcdJgs1+-*/^(). ", min_size=1, max_size=8))
def test_any_text_is_defined_or_refused(text):
    with contextlib.suppress(GridgenError):
        made = define("any_text", text, replace=True)
        assert {str(v) for v in made.expression().free_symbols} <= set(DENSITY_NAMES)
