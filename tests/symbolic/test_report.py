"""The report shows every part, in text and in LaTeX."""

from __future__ import annotations

import pytest
import sympy
from support import BUILTIN
from sympy import Rational

from gridgen_sym.functionals import functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.symbolic import classify, corner_model, derive_text, euler_lagrange
from gridgen_sym.symbolic.coordinates import FIRST_DERIVATIVES, SECOND_DERIVATIVES, expand_metric
from gridgen_sym.symbolic.report.sections import Quasilinear, sections
from gridgen_sym.symbolic.report.tidy import common_factor, paper_order, tidy


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILTIN)
def test_text_has_every_part(name):
    text = derive_text(functional(name))
    for part in ("Density", "Corner energy", "dE/dx_xi =", "H+/d", "divergence form", "expanded form", "det A(k) ="):
        assert part in text
    assert ("Equidistribution, weight frozen" in text) == ("*s" in text.split("Corner")[0])


@pytest.mark.slow
def test_weight_laws_and_reduction_are_shown():
    text = derive_text(functional("area"))
    assert "c = J*s\n" in text
    assert "c = J*sqrt(s)\n" in text
    assert "det M = 4/J**4" in derive_text(functional("winslow"))


def test_what_is_not_there_is_said_in_words():
    text = derive_text(Functional("other", "g11 - g22"))
    assert "in g1 alone: not homogeneous" in text
    assert "Lower bound: none, unbounded below by scaling." in text
    assert "Lower bound: none found." in derive_text(Functional("other", "J**2 - J**4"))
    assert "None" not in text


POINT = {p: Rational(k + 2, 2 * k + 3) for k, p in enumerate((*FIRST_DERIVATIVES, *SECOND_DERIVATIVES))}


def value(expression):
    """Return the exact value of an expression at rational derivatives, with J > 0; parameters and k are 2, 3, ..."""
    written = expand_metric(sympy.sympify(expression)).subs(POINT)
    return sympy.nsimplify(written.subs({v: k + 2 for k, v in enumerate(sorted(written.free_symbols, key=str))}))


def shown(name):
    """Return what the report on a functional shows, by the name of the item; expanded equations in a list."""
    items = [item for section in sections(functional(name)) if "weight" not in section.title for item in section.items]
    equations = [item for item in items if isinstance(item, Quasilinear)]
    return dict(item for item in items if isinstance(item, tuple)), equations


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILTIN)
def test_tidy_expressions_have_the_values_of_the_derived_ones(name):
    named, equations = shown(name)
    model, derived = corner_model(functional(name), "plain"), euler_lagrange(functional(name), "plain")
    for equation, residual in zip(equations, derived.residual, strict=True):
        total = equation.factor * sum(factor * second for factor, second in equation.terms) + equation.rest
        assert value(total) == value(residual)
    for variable, slope in zip(FIRST_DERIVATIVES, model.gradient, strict=True):
        assert value(named[f"dE/d{variable}"]) == value(slope)
    for i, j in ((0, 0), (0, 3), (1, 2), (3, 3)):
        entry = f"d{FIRST_DERIVATIVES[i]}d{FIRST_DERIVATIVES[j]}"
        assert value(named[f"d²E/{entry}"]) == value(model.hessian[i, j])
        assert value(named[f"H+/{entry}"]) == value(model.semidefinite_hessian[i, j])
    found = classify(functional(name))
    assert [value(entry) for entry in named["A(k)"]] == [value(entry) for entry in found.symbol]
    assert value(named["det A(k)"]) == value(found.determinant)


def test_terms_stand_as_in_the_paper():
    assert " ".join(map(str, paper_order(0))) == "x_xixi y_xixi x_xieta y_xieta x_etaeta y_etaeta"
    _, (first, second) = shown("winslow")
    assert str(first.factor) == "2/J**3"
    assert str(first.terms[0][0]) == "g22*(y_eta**2 + y_xi**2)"
    assert [str(name) for _, name in second.terms][:2] == ["y_xixi", "x_xixi"]


def test_common_factors_are_those_of_all_entries():
    j, a = sympy.symbols("J a", real=True)
    assert common_factor([4 * a / j**2, 6 / j**3]) == 2 / j**2
    assert common_factor([a, 1 / j]) == 1
    assert common_factor([sympy.S.Zero]) == 1


def test_what_is_not_rational_stays_as_it_was_derived():
    a = sympy.Symbol("a", real=True)
    assert tidy(sympy.exp(a) + a * sympy.exp(a)) == sympy.exp(a) + a * sympy.exp(a)


def test_a_sentence_is_safe_for_latex():
    from gridgen_sym.symbolic.report.latex import latex_sentence

    assert latex_sentence("50% of k_A & J² < #1") == r"50\% of k\_A \& J$^{2}$ $<$ \#1"
    assert latex_sentence("M⁻¹ + (W⁻¹)ᵗ → σ") == r"M$^{-1}$ + (W$^{-1}$)$^{t}$ $\to$ $\sigma$"
