"""Known answers of equations with fields: control functions, harmonic maps, targets, and the range of fields."""

from __future__ import annotations

import pytest
import sympy

from gridgen_sym.functionals import functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.functionals.metric import symbol
from gridgen_sym.symbolic import classify, corner_model, derive_latex, derive_text, euler_lagrange
from gridgen_sym.symbolic.classify.isotropy import isotropy
from gridgen_sym.symbolic.coordinates import METRIC, TARGET_IN_METRIC, J, expand_metric, g11, g12, g22
from gridgen_sym.symbolic.derive.discrete import variant_density

pytestmark = pytest.mark.slow

DVINSKY = Functional(
    "dvinsky",
    "(M11*(x_xi**2 + x_eta**2) + 2*M12*(x_xi*y_xi + x_eta*y_eta) + M22*(y_xi**2 + y_eta**2))"
    "/(sqrt(M11*M22 - M12**2)*J)",
    fields={"M": "symmetric"},
)
STRETCHED = Functional(
    "stretched",
    "(g11*q**2 + g22*p**2)/J",
    fields={"p": "scalar", "q": "scalar"},
    constraints=("p > 0", "q > 0"),
)
p, q, p_xi, p_eta, q_xi, q_eta = map(symbol, ("p", "q", "p_xi", "p_eta", "q_xi", "q_eta"))


def same(left, right):
    """Return whether two expressions have the same exact values at rational points."""
    symbols = sorted((expand_metric(left).free_symbols | expand_metric(right).free_symbols), key=str)
    for offset in (1, 2, 3):
        point = {symbol: sympy.Rational(7 * k + 2 * offset + 1, 3 * k + 2 + offset) for k, symbol in enumerate(symbols)}
        point |= {m: meaning.subs(point) for m, meaning in METRIC.items()}
        if left.xreplace(point) != right.xreplace(point):
            return False
    return True


def test_thomas_and_middlecoffs_control_functions_are_found():
    reduction = euler_lagrange(STRETCHED).reduction
    assert reduction is not None
    assert reduction.operator.coefficients == (g22, -2 * g12, g11)
    along = {p_eta: 0, q_xi: 0}
    assert [part.subs(along) for part in reduction.control] == [-p_xi / p, -q_eta / q]
    # Where p and q depend on both coordinates, there is more.
    further = [sympy.expand(part - part.subs(along)) for part in reduction.control]
    assert same(further[0], 2 * g12 * p_eta / (g22 * p) + g11 * q * q_xi / (g22 * p**2))
    assert same(further[1], 2 * g12 * q_xi / (g11 * q) + g22 * p * p_eta / (g11 * q**2))


@pytest.mark.parametrize(
    ("case", "variant"),
    [
        (STRETCHED, "plain"),
        pytest.param(functional("winslow"), "frozen", marks=pytest.mark.slow),
    ],
)
def test_residual_is_the_matrix_times_the_reduced_system(case, variant):
    derived = euler_lagrange(case, variant)
    assert derived.reduction is not None
    product = derived.reduction.operator.matrix * sympy.Matrix(derived.reduction.system)
    for left, right in zip(product, derived.residual, strict=True):
        assert same(left, right)
        assert not same(left, -right)


def test_what_is_no_quotient_of_polynomials_is_no_hindrance():
    """Absolute values, logarithms and roots are symbols of their own where a reduction is looked for."""
    for density in (
        "abs(J - 1)",
        "log(J)**2 + sqrt(g11)",
        "exp(-J)*g11",
        "sqrt(2)*(g11 + g22)/J",
        "max(J, 1) + g11**0.7",
    ):
        reduction = euler_lagrange(Functional("rough", density)).reduction
        assert reduction is None or {"sqrt(2)", "g11**0.7"} & {*density.split("*(")[0].split(" ")}
    assert euler_lagrange(Functional("scaled", "sqrt(2)*(g11 + g22)/J")).reduction is not None


@pytest.mark.slow
def test_a_harmonic_map_has_its_operator_and_the_monitors_slopes():
    reduction = euler_lagrange(DVINSKY, "M:differentiated").reduction
    assert reduction is not None
    assert reduction.first_order is None
    assert same(reduction.operator.discriminant, 4 * J**2 * sympy.sympify("M11*M22 - M12**2", symbols()))
    assert same(reduction.operator.determinant, 4 / J**4 / sympy.sympify("M11*M22 - M12**2", symbols()))


def symbols():
    return {name: symbol(name) for name in ("M11", "M12", "M22")}


@pytest.mark.parametrize(
    ("variant", "slopes"),
    [pytest.param("plain", ("xi", "eta"), marks=pytest.mark.slow), ("M:differentiated", ("x", "y"))],
)
def test_a_scalar_monitor_drops_out(variant, slopes):
    """Dvinsky's residual with M = c I is Winslow's, term by term: whatever c is, held or moving."""
    c = sympy.Symbol("c", positive=True)
    values = {symbol("M11"): c, symbol("M22"): c, symbol("M12"): 0}
    for slope in slopes:
        moves = symbol(f"c_{slope}")
        values |= {symbol(f"{part}_{slope}"): moves for part in ("M11", "M22")} | {symbol(f"M12_{slope}"): 0}
    ours = euler_lagrange(DVINSKY, variant).residual
    winslow = euler_lagrange(functional("winslow")).residual
    for left, right in zip(ours, winslow, strict=True):
        assert same(left.subs(values), right)
        # A slope of another sign is seen: the terms of c_xi, or c_x, cancel among those of M11 and M22.
        wrong = left.subs({symbol(f"M11_{slopes[0]}"): -symbol(f"c_{slopes[0]}")}).subs(values)
        assert not same(wrong, right)


def test_isotropy_is_reported():
    found = isotropy(DVINSKY)
    assert found is not None
    assert found.known == ("winslow", 1)
    half = Functional("half", f"({DVINSKY.density})/2", fields={"M": "symmetric"})
    assert isotropy(half).known == ("winslow", sympy.Rational(1, 2))
    assert isotropy(Functional("not", "M11*g11/J", fields={"M": "symmetric"})) is None
    assert isotropy(STRETCHED) is None


def test_a_diagonal_target():
    w1, w2 = sympy.symbols("w1 w2", positive=True)
    inverse = {symbol("V11"): 1 / w1, symbol("V12"): 0, symbol("V21"): 0, symbol("V22"): 1 / w2}
    density = variant_density(functional("winslow"), "target").xreplace(TARGET_IN_METRIC).subs(inverse)
    expected = (METRIC[g11] / w1**2 + METRIC[g22] / w2**2) * w1 * w2 / METRIC[J]
    assert same(density, expected)
    assert not same(density, expected.subs(w1, 2 * w1))


@pytest.mark.slow
def test_dvinsky_is_elliptic_and_polyconvex_for_every_monitor():
    found = classify(DVINSKY)
    assert found.words() == ("quasilinear", "coupled", "elliptic")
    assert found.ellipticity.proof == "proved"
    assert found.polyconvex.holds
    assert found.polyconvex.proof == "proved"


def test_polyconvex_over_the_range_of_the_fields():
    any_sign = Functional("any_sign", "p*(g11 + g22)/J", fields={"p": "scalar"})
    assert not corner_model(any_sign).splitting.holds
    assert symbol("p") in dict(corner_model(any_sign).splitting.witness)
    positive = Functional("positive", any_sign.density, fields={"p": "scalar"}, constraints=("p > 0",))
    assert corner_model(positive).splitting.proof == "proved"
    indefinite = Functional("indefinite", "B11*g11/J", fields={"B": "matrix"})
    assert not corner_model(indefinite).splitting.holds


def test_the_logical_place_is_in_the_unit_square():
    assert corner_model(Functional("inside", "(1 - xi*eta)*(g11 + g22)/J")).splitting.proof == "proved"
    assert not corner_model(Functional("outside", "(xi - eta)*(g11 + g22)/J")).splitting.holds


@pytest.mark.slow
def test_the_report_names_fields_and_their_derivatives():
    text = derive_text(STRETCHED)
    assert "p is a scalar; p > 0." in text
    assert "p_xi" in text
    assert "p_x*" in text
    assert "Where p_eta = 0 and q_xi = 0, they are P = -p_xi/p and Q = -q_eta/q." in text
    monitor = derive_text(DVINSKY)
    assert "M is a symmetric positive definite matrix, with the components M11, M12, M22." in monitor
    assert "With M = c I, M drops out, held or differentiated through: the density is then that of winslow." in monitor
    assert "M11_xi" in monitor
    assert "M11_xx" not in monitor
    latex = derive_latex(DVINSKY)
    assert r"M_{11,\xi}" in latex
    assert r"M_{11,x}" in latex
