"""No symbolic step takes minutes: claims are tried at points, determinants are made of polynomials."""

from time import process_time

import pytest
import sympy

from gridgen_sym.functionals import Functional
from gridgen_sym.symbolic.classify.at_points import at_a_jet, vanishes, varies
from gridgen_sym.symbolic.classify.classification import classify
from gridgen_sym.symbolic.classify.frame_determinant import frame_determinant
from gridgen_sym.symbolic.classify.principal_symbol import k1, k2, principal_symbol
from gridgen_sym.symbolic.coordinates import METRIC, J, chi, expand_metric, g11, g12, g22, s, x_eta, x_xi, y_eta, y_xi
from gridgen_sym.symbolic.definiteness import without_functions
from gridgen_sym.symbolic.report import derive_text
from gridgen_sym.symbolic.report.tidy import tidy_quadratic

EXPONENTS = {"p": 2.0, "q": 1.0, "r": 1.0, "k": 1.1}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("density", "parameters"),
    [
        ("sqrt((t11 + t22)**p/tau**q + k*((t11 - t22)**2 + 4*t12**2)**r)", EXPONENTS),  # 280 s and more before
        ("(t11 + t22)**p/(2*tau)**q*(1 + (t11*t22 - t12**2)**r)**k", EXPONENTS | {"k": 2.0}),
    ],
)
def test_a_target_density_with_four_exponents_is_derived_in_seconds(density, parameters):
    begin = process_time()
    assert "Classification" in derive_text(Functional("four", density, parameters=parameters))
    assert process_time() - begin < 20  # 5 on a quiet machine


@pytest.mark.slow
def test_an_asymmetric_density_is_classified_in_seconds():
    begin = process_time()
    found = classify(Functional("asymmetric", "(2*g11**2 + 3*g22**2 + g12**2)/J**2 + g11/J"))
    assert process_time() - begin < 20  # 4 on a quiet machine, 100 and more before
    assert found.ellipticity.type == "elliptic"
    assert (found.linear, found.coupled, found.rotation, found.exchange) == (False, True, True, False)


def test_what_changes_and_what_vanishes_is_seen_at_points():
    assert varies([g11 / J], [x_xi])
    assert not varies([sympy.sqrt(s) * 3, g12 - x_xi * x_eta - y_xi * y_eta], [x_xi, y_xi, x_eta, y_eta])
    assert not varies([x_xi**2 * s], [y_xi, y_eta])
    assert varies([sympy.log(g11)], [y_xi])
    assert vanishes(g11 * g22 - g12**2 - J**2)
    assert not vanishes(g11 * g22 - g12**2 - J**2 * (1 + sympy.Rational(1, 10**15)))
    assert not vanishes(sympy.zoo * g11)
    assert at_a_jet(chi - J, 1) > 0  # chi is written out, with a value of epsilon


@pytest.mark.parametrize(
    "density",
    [
        g11**2 / J + 2 * g22 / J,
        g22 / J + g12 / (1 + g11),
        s * (g11 + g22) / J + g12**2 / (g11 * g22),
        1 / (g11 + 1 / J),
        3 * J,
    ],
)
def test_a_determinant_of_polynomials_is_that_of_the_matrix(density):
    matrix = principal_symbol(density)
    found = frame_determinant(matrix, {y_xi: sympy.S.Zero})
    exact = expand_metric(matrix[0, 0] * matrix[1, 1] - matrix[0, 1] ** 2).xreplace({y_xi: sympy.S.Zero})
    point = {x_xi: 2, x_eta: -3, y_eta: 5, k1: 3, k2: -7, s: sympy.Rational(2, 3)}
    assert found.subs(point) == exact.subs(point)
    assert not found.has(*METRIC)


def test_too_long_a_determinant_is_left_alone():
    density = (g11 + 2 * g22 + g12 + J) ** 5 / J**4 + g12**7
    assert frame_determinant(principal_symbol(density), {}) is None


def test_powers_of_a_root_share_a_symbol_and_other_powers_have_their_own():
    positive = sympy.Symbol("positive", positive=True)
    a, b, c = (sympy.Rational(n, 100) for n in (137, 237, 37))
    matrix, known = without_functions(sympy.Matrix([[g11**a + g11**b - g11 ** (-c)]]))
    assert len(matrix.free_symbols) == 3
    assert matrix[0].is_polynomial()
    assert sympy.Poly(matrix[0]).total_degree() == 1
    assert not known
    matrix, known = without_functions(sympy.Matrix([[sympy.sqrt(positive) + positive ** sympy.Rational(3, 2)]]))
    assert matrix.free_symbols == set(known)
    assert sympy.Poly(matrix[0]).total_degree() == 3


def test_a_bound_is_proved_for_powers_that_are_no_whole_numbers():
    found = classify(Functional("powers", "(g11 + g22)**1.37/J**0.61"))
    assert (found.lower_bound.value, found.lower_bound.proof) == (0, "proved")


@pytest.mark.parametrize("long", [False, True])
def test_a_quadratic_form_stays_what_it_is(long):
    factor = (g11**3 + g22**3 + J) ** 4 / J**3 if long else g11 / J
    form = factor * k1**2 + (x_xi * k1 * k2 + k1 * k2 * y_xi) * factor - 3 * k2**2 * y_eta
    point = {g11: 2, g22: 3, J: 5, x_xi: 7, y_xi: 11, y_eta: 13, k1: 17, k2: 19}
    assert tidy_quadratic(form, k1, k2).subs(point) == form.subs(point)
