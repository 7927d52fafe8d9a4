"""Known answers of the classification, and that it is decided from the density."""

from __future__ import annotations

import pytest
import sympy
from support import BUILTIN

from gridgen_sym.functionals import functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.functionals.metric import symbol
from gridgen_sym.symbolic import classify, equation_words
from gridgen_sym.symbolic.classify.classification import equation_type, is_null_lagrangian
from gridgen_sym.symbolic.classify.invariance import is_rotation_invariant
from gridgen_sym.symbolic.classify.principal_symbol import is_large, k1, k2, principal_symbol
from gridgen_sym.symbolic.coordinates import METRIC, J, expand_metric, g11, g12, g22, x_xi
from gridgen_sym.symbolic.definiteness import is_high
from gridgen_sym.symbolic.derive.discrete import corner_model
from gridgen_sym.symbolic.report.tidy import tidy

# linear, coupled, type, proof, scaling degree, lower bound, barrier
KNOWN = {
    "area": (False, True, "degenerate", "proved", 4, 0, False),
    "length": (True, False, "elliptic", "proved", 2, 0, False),
    "orthogonality": (False, True, "changing type", "refuted", 4, 0, False),
    "combined": (False, True, "changing type", "refuted", None, 0, False),
    "knupp": (False, True, "changing type", "refuted", 4, 0, False),
    "winslow": (False, True, "elliptic", "proved", 0, 2, True),
    "liao": (False, True, "elliptic", "proved", 4, 0, False),
    "modified_liao": (False, True, "elliptic", "proved", 0, 4, True),
    "area_winslow": (False, True, "elliptic", "proved", None, 0, True),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", KNOWN)
def test_the_words_of_the_equations_are_those_of_the_classification(name):
    assert equation_words(functional(name)) == classify(functional(name)).words()


@pytest.mark.slow
@pytest.mark.parametrize("name", KNOWN)
def test_known_answers(name):
    found = classify(functional(name))
    answer = (
        found.linear,
        found.coupled,
        found.ellipticity.type,
        found.ellipticity.proof,
        found.scaling_degree,
        found.lower_bound.value,
        found.barrier,
    )
    assert answer == KNOWN[name]
    assert found.lower_bound.proof == "proved"
    assert found.translation
    assert found.rotation
    assert found.exchange
    assert not found.null_lagrangian


def test_determinants():
    winslow = 4 * (g22 * k1**2 - 2 * g12 * k1 * k2 + g11 * k2**2) ** 2 / J**4
    assert sympy.expand(classify(functional("winslow")).determinant - winslow) == 0
    assert classify(functional("area")).determinant == 0
    assert sympy.expand(classify(functional("length")).determinant - (k1**2 + k2**2) ** 2) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", KNOWN)
def test_determinant_in_metric_symbols_is_that_of_the_symbol(name):
    found = classify(functional(name))
    point = {symbol(n): v for n, v in {"x_xi": 2, "y_xi": 1, "x_eta": -1, "y_eta": 3, "k1": 2, "k2": -3}.items()}
    expected = found.symbol.applyfunc(expand_metric).subs(point).det()
    assert expand_metric(found.determinant).subs(point) == expected


@pytest.mark.parametrize("name", [n for n, known in KNOWN.items() if known[2] == "changing type"])
def test_witness_is_exact(name):
    found = classify(functional(name))
    witness = dict(found.ellipticity.witness)
    assert all(value.is_Rational for value in witness.values())
    assert METRIC[J].subs(witness) > 0
    assert expand_metric(found.determinant).subs(witness) < 0
    assert found.ellipticity.how_known == "shown by an exact witness"  # Refuted is that it is elliptic.


@pytest.mark.slow
@pytest.mark.parametrize(
    ("density", "expected"),
    [
        ("J", ("linear", "uncoupled", "degenerate")),
        ("g11", ("linear", "uncoupled", "weakly elliptic")),
        ("x_xi**2 + 4*x_eta**2 + y_xi**2 + 2*y_eta**2", ("linear", "uncoupled", "elliptic")),
        ("x_xi*y_eta + x_xi*y_xi", ("linear", "coupled", "weakly elliptic")),
        ("x_xi*y_xi + x_eta*y_eta", ("linear", "coupled", "elliptic")),
        ("x_xi**2 - x_eta**2 + y_xi**2 + y_eta**2", ("linear", "uncoupled", "changing type")),
        ("g11 - g22", ("linear", "uncoupled", "weakly elliptic")),
        ("sqrt(g11) + sqrt(g22)", ("quasilinear", "coupled", "weakly elliptic")),
        ("exp(g11)", ("quasilinear", "coupled", "weakly elliptic")),
        ("sqrt(g11 + g22)", ("quasilinear", "coupled", "elliptic")),
        ("J**12 + J**-10 + g11 + g22", ("quasilinear", "coupled", "elliptic")),
        ("g11**2 + g22", ("quasilinear", "coupled", "elliptic")),
        ("-J**2 - g12**2", ("quasilinear", "coupled", "changing type")),
    ],
)
def test_other_densities(density, expected):
    known = Functional("other", density)
    assert classify(known).words() == expected
    assert equation_type(known) == expected[2]


@pytest.mark.parametrize("name", KNOWN)
def test_sampled_type_is_the_type(name):
    assert equation_type(functional(name)) == KNOWN[name][2]


@pytest.mark.parametrize("density", ["J", "2 - 3*J + x_xi", "k*J"])
def test_null_lagrangians(density):
    assert is_null_lagrangian(Functional("null", density, parameters={"k": 2} if "k" in density else {}))


@pytest.mark.parametrize("density", [*KNOWN, "abs(J)", "J + k*g11"])
def test_no_null_lagrangians(density):
    """Not for one value of a parameter alone, either."""
    known = density in KNOWN
    assert not is_null_lagrangian(
        functional(density) if known else Functional("no_null", density, parameters={"k": 0} if "k" in density else {})
    )


def test_null_lagrangian_and_unbounded():
    found = classify(Functional("jacobian", "J"))
    assert found.null_lagrangian
    assert found.reparametrization_degrees == (1, 1)
    negative = classify(Functional("negative", "-J**2"))
    assert negative.lower_bound.value is None
    assert negative.lower_bound.proof == "refuted"


def test_invariances_can_fail():
    found = classify(Functional("skew", "x_xi**2 + g22"))
    assert not found.rotation
    assert not found.exchange
    assert found.scaling_degree == 2
    assert classify(Functional("mixed", "J**2 + g11")).scaling_degree is None


@pytest.mark.slow
@pytest.mark.parametrize(
    "density", ["exp(g11)/J", "sqrt(g11)*g22/J", "abs(J - 1)*g11", "log(J)**2 + g11", "s*exp(J)/J"]
)
def test_functions_never_raise(density):
    found = classify(Functional("other", density))
    assert found.ellipticity.proof in ("proved", "refuted", "sampled")


def test_powers_that_are_parameters_are_no_reason_to_fail():
    """SymPy cannot sort factors with such powers."""
    powers = Functional("powers", "max(J, 1/J)**p", parameters={"p": 2.0}, constraints=("p > 1",))
    found = classify(powers)
    assert found.barrier
    assert found.polyconvex.holds


def test_densities_of_a_high_degree_are_sampled_and_not_worked_on_for_hours():
    """The numerators that would decide on (g11 + g22 + g12)**10 have thousands of terms."""
    density, high = "g11 + g22 + g12", "(g11 + g22 + g12)**10"
    assert corner_model(Functional("low", density), "plain").splitting.proof == "proved"
    assert corner_model(Functional("high", high), "plain").splitting.proof == "sampled"
    expression = (g11 + g22 + g12) ** 10
    assert is_rotation_invariant(expression)
    assert is_large(principal_symbol(expression))
    assert tidy(sympy.diff(expression, g11)).has(g12)


def test_the_degree_is_that_of_numerators():
    assert not is_high([(g11 + g22) ** 6 / J**90, sympy.exp(x_xi**12)])
    assert is_high([sympy.S.One, 2 * x_xi * (g11 + g22) ** 6])
    assert is_high([sympy.exp(x_xi**13)])


@pytest.mark.slow
@pytest.mark.parametrize("variant", ["frozen", "differentiated"])
@pytest.mark.parametrize("name", BUILTIN)
def test_weighted_variants(name, variant):
    found = classify(functional(name), variant)
    assert found.ellipticity.type == classify(functional(name)).ellipticity.type
    weighted = variant == "differentiated" and found.symbol.has(symbol("s"))
    assert found.translation != weighted
    assert found.rotation != weighted
