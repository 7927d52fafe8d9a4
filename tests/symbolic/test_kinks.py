"""Where a density has no continuous first derivative on valid grids, the classification says so."""

from __future__ import annotations

import pytest
import sympy
from support import BUILTIN

from gridgen_sym.functionals import Functional, functional
from gridgen_sym.symbolic import classify, corner_model, derive_text
from gridgen_sym.symbolic.classify.kinks import kinks
from gridgen_sym.symbolic.coordinates import J, g11, g12, g22, x_xi


@pytest.mark.parametrize(
    ("density", "expected"),
    [
        ("abs(J - 1)", {J - 1}),
        ("abs(J)", set()),  # J > 0
        ("abs(J + 1)*g11", set()),
        ("abs(J - 1)*(J - 1)", set()),  # The slope is continuous, its derivative is not.
        ("abs(J - 1)**3", set()),
        ("(abs(J - 1) + J - 1)**2", set()),
        ("abs(J - 1)*abs(J - 2)", {J - 1, J - 2}),
        ("log(abs(J - 1) + 1)", {J - 1}),
        ("sqrt(abs(J - 1))", {J - 1}),
        ("abs(g12) + abs(x_xi)*g11", {g12, x_xi}),
        ("(g11 + g22)/J + sqrt(g12**2 + (g11 - g22)**2)", {g12**2 + (g11 - g22) ** 2}),
        ("sqrt(g12**2 + 1) + sqrt(g11)", set()),
    ],
)
def test_kinks(density, expected):
    expression = Functional("kinked", density).expression()
    assert {sympy.expand(kink) for kink in kinks(expression)} == {sympy.expand(kink) for kink in expected}


def test_functionals_of_the_package_have_none():
    assert not [name for name in BUILTIN if kinks(functional(name).expression().subs(_ones(name)))]


def _ones(name):
    return {symbol: 1 for symbol in functional(name).expression().free_symbols if str(symbol).startswith("k")}


def test_a_report_says_where_derivatives_jump():
    text = derive_text(Functional("kinked", "abs(J - 1)"))
    assert "The first derivatives of F jump or do not exist where J - 1 = 0: " in text
    assert "jump" not in derive_text(Functional("smooth", "(J - 1)**2"))


def test_branches_that_are_null_lagrangians_do_not_make_one():
    """Both 1 - J and J - 1 are; abs(J - 1) is not: its energy depends on the grid."""
    assert not classify(Functional("kinked", "abs(J - 1)")).null_lagrangian
    assert classify(Functional("branch", "abs(J + 1)")).null_lagrangian


@pytest.mark.parametrize(
    ("density", "convex"), [("abs(J - 1)", True), ("-abs(J - 1)", False), ("g11 - abs(g12)", False)]
)
def test_a_kink_counts_in_convexity(density, convex):
    assert corner_model(Functional("kinked", density)).splitting.holds is convex


@pytest.mark.slow
@pytest.mark.parametrize(
    ("density", "arguments", "expected"),
    [
        ("(g11 + g22)/J + max(0, p - J)", {"fields": {"p": "scalar"}}, {"J - p"}),
        ("(g11 + g22)/J + max(0, b - J)", {"parameters": {"b": 2.0}}, {"J - b"}),
        ("(g11 + g22)/J + max(0, s - J) + max(0, x - J)", {}, {"J - s", "J - x"}),
        ("(g11 + g22)/J + abs(J - M11)", {"fields": {"M": "symmetric"}}, {"J - M11"}),
    ],
)
def test_a_kink_is_told_in_the_symbols_of_the_density(density, arguments, expected):
    made = Functional("kinked", density, **arguments)
    variant = "frozen" if "s -" in density else "plain"
    found = {str(sympy.expand(kink)) for kink in classify(made, variant).kinks}
    assert found in (expected, {str(-sympy.sympify(one)) for one in expected})
