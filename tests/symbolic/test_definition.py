"""Densities that cannot be used are refused, with a message that names the repair."""

from __future__ import annotations

import contextlib
import math
import time

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from gridgen_sym.errors import GridgenError
from gridgen_sym.functionals import Functional, define, functional, functionals
from gridgen_sym.functionals.expression import FUNCTION_NAMES, evaluate
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
        ("3", "does not depend on the shape of cells"),
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
        (max, "arguments of the density function 'max' cannot be read"),
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
        ({"constraints": ("k",)}, "not a comparison"),
        ({"constraints": ("k >= 0 and k < 2",)}, "not a comparison"),
        ({"constraints": ("0 < k != 2",)}, "not a comparison"),
        ({"constraints": ("1 < k < 2",)}, "needs 1 < k < 2; came k = 1"),
        ({"constraints": ("0 < k < 1",)}, "needs 0 < k < 1; came k = 1"),
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
    with pytest.raises(GridgenError, match=r"use lower-case letters|use at most 64|word of Python"):
        define(name, "g11")


def test_floats_are_taken_with_all_their_digits():
    made = define("exact", lambda m: 2**0.5 * m.g11 + m.J**0.5 / 10)
    m = symbolic_metric()
    assert made.expression() == sympy.Rational("1.4142135623730951") * m.g11 + sympy.sqrt(m.J) / 10
    assert define("exact_text", "1.4142135623730951*g11 + 0.1*J**0.5").expression() == made.expression()


@pytest.mark.parametrize(
    ("word", "instead"), [("lambda", "lambda_ or lam"), ("in", "in_"), ("if", "if_"), ("None", "none_")]
)
def test_words_of_python_are_no_names_and_the_message_says_what_to_write(word, instead):
    message = f"word of Python.* write {instead}"
    with pytest.raises(GridgenError, match=message):
        define("with_word", "k*g11", parameters={word: 1})
    with pytest.raises(GridgenError, match=message):
        define(word, "g11")
    if word != "None":  # That one is read, as a constant, and refused as such.
        with pytest.raises(GridgenError, match=message):
            define("with_word", f"{word}*g11", parameters={word: 1})


@pytest.mark.parametrize(
    ("density", "order", "term"),
    [
        ("(g11 + g22)/J + sqrt((g11 - 100 + abs(g11 - 100))/2)", "first", "sqrt(g11/2 + Abs(g11 - 100)/2 - 50)"),
        ("(g11 + g22)/J + sqrt(abs(J - 1) + J - 1)", "first", "sqrt(J + Abs(J - 1) - 1)"),
        ("g22 + (abs(g12 - 1) + g12 - 1)**1.5", "second", "(g12 + Abs(g12 - 1) - 1)**(3/2)"),
        ("g22 + (abs(g12 - 1) + g12 - 1)**0.25/J", "first", "(g12 + Abs(g12 - 1) - 1)**(1/4)"),
        ("g22 + sqrt(g11 - x_xi**2 - y_xi**2)", "first", "sqrt(g11 - x_xi**2 - y_xi**2)"),
    ],
)
def test_a_density_without_derivatives_in_a_region_is_refused_with_the_term(density, order, term):
    """Kernels would be full of nan there, although the density has a value."""
    with pytest.raises(GridgenError, match=f"no {order} derivative on the valid corner") as error:
        define("rough", density)
    assert f"because of the term {term}: " in str(error.value)


@pytest.mark.parametrize(
    "density",
    [
        "(g11 + g22)/J + sqrt(g12**2 + (g11 - g22)**2)/J",  # no derivative where cells are square, and there only
        "abs(J - 1) + abs(J - 1)**3",
        "((0.05 - J + abs(0.05 - J))/2)**2",
        "sqrt(g11)*sqrt(g22)/J + J**J + 2**J + J**0.3 + atan(g12)*tanh(J) + log(J)",
        "exp(g11) + exp(1/J)",  # too large for floats at some corners, which is no kink
        "sqrt(2)*pi*g11",
    ],
)
def test_kinks_at_single_grids_are_allowed(density, clean_registry):
    define("kinked", density)


def test_a_long_formula_is_read_in_linear_time_or_refused():
    def balanced(depth):
        return ".5" if depth == 0 else f"({balanced(depth - 1)}*{balanced(depth - 1)})"

    def processor_time(depth):
        begin = time.process_time()
        assert evaluate(balanced(depth), {}, {}) == 0.5 ** (2**depth) or depth > 9
        return time.process_time() - begin

    short, long = (min(processor_time(depth) for _ in range(3)) for depth in (8, 11))
    assert long < 30 * short  # 8 times as many characters; the square would be 64 times the time
    with pytest.raises(GridgenError, match="is too long: it may have 20000 characters"):
        evaluate(balanced(13), {}, {})


@pytest.mark.parametrize(
    "provoke",
    [
        lambda long: evaluate(long, {}, {}),
        lambda long: evaluate(long[:1000] + "(2)", {}, {}),
        lambda long: evaluate("'" + long[:1000] + "'", {}, {}),
        lambda long: define(long, "g11"),
        lambda long: define("long", "k*g11", parameters={long: 1}),
        lambda long: define("long", "k*g11", parameters={"k": long}),
        lambda long: define("long", "g11", constraints=long),
        lambda long: define("long", "k*g11", parameters={"k": 1}, constraints=(long,)),
        lambda long: define("long", "g11", description=[long]),
        lambda long: functional(long),
        lambda long: functional("combined").values({long: 1}),
    ],
)
def test_messages_are_short_however_long_the_input(provoke):
    with pytest.raises(GridgenError) as error:
        provoke("x" * 100_000)
    assert len(str(error.value)) < 1000


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
