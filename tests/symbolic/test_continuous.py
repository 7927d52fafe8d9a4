"""Euler–Lagrange equations against SymPy's own derivation, reductions, null Lagrangian and weight laws."""

from __future__ import annotations

import pytest
import sympy
from support import BUILTIN
from sympy.calculus.euler import euler_equations

from gridgen_sym.functionals import define, functional, functionals
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.functionals.metric import symbol
from gridgen_sym.symbolic import equidistribution, euler_lagrange
from gridgen_sym.symbolic.coordinates import (
    FIRST_DERIVATIVES,
    SECOND_DERIVATIVES,
    J,
    eta,
    expand_metric,
    s,
    s_eta,
    s_x,
    s_xi,
    s_y,
    x,
    xi,
    y,
)
from gridgen_sym.symbolic.derive.discrete import variant_density
from gridgen_sym.symbolic.paper.verify import verify

X, Y = sympy.Function("X")(xi, eta), sympy.Function("Y")(xi, eta)
# A map with J > 0 at the points below, and weights that depend on everything they may depend on.
MAP = {X: 2 * xi + xi * eta**2 / 3 + eta / 5, Y: eta + xi**2 / 4 + xi * eta / 3}
POINTS = [{xi: sympy.Rational(1, 3), eta: sympy.Rational(2, 5)}, {xi: sympy.Rational(3, 4), eta: sympy.Rational(1, 7)}]
WEIGHTS = {"plain": sympy.S.One, "frozen": 2 + xi**2 + 3 * xi * eta, "differentiated": 3 + x**2 + 2 * x * y + y**3}


def jets():
    """Return what the symbols of derivatives stand for."""
    along = {"xi": xi, "eta": eta}
    result = {}
    for p in (*FIRST_DERIVATIVES, *SECOND_DERIVATIVES):
        name, tail = str(p).split("_")
        variables = [along[part] for part in (tail[:2], tail[2:]) if part in along] if tail != "eta" else [eta]
        if tail in ("xieta", "etaeta", "xixi"):
            variables = {"xixi": [xi, xi], "xieta": [xi, eta], "etaeta": [eta, eta]}[tail]
        result[p] = sympy.diff(X if name == "x" else Y, *variables)
    return result


def values(weight, slopes, point):
    """Return the numbers that the symbols of derivatives and of the weight have at a point of the map."""
    meanings = jets() | slopes | {s: weight}
    return {symbol: meaning.subs(MAP).doit().subs(point) for symbol, meaning in meanings.items()}


def sides(name, variant):
    """Return our residuals and SymPy's, both at the points of the map."""
    known = functional(name)
    defaults = {symbol(n): sympy.nsimplify(v) for n, v in known.parameters.items()}
    weight = WEIGHTS[variant].subs({x: X, y: Y})
    slopes = {s_xi: weight.diff(xi), s_eta: weight.diff(eta)}
    slopes |= {part: WEIGHTS[variant].diff(r).subs({x: X, y: Y}) for part, r in ((s_x, x), (s_y, y))}

    def on_functions(expression):
        return expand_metric(expression).subs(defaults).subs(slopes | {s: weight}).subs(jets())

    def at_points(expression):
        on_map = expression.subs(MAP).doit()
        return [on_map.subs(point) for point in POINTS]

    def at_jets(expression):
        written_out = expand_metric(expression).subs(defaults)
        return [written_out.subs(values(weight, slopes, point)) for point in POINTS]

    ours = [at_jets(part) for part in euler_lagrange(known, variant).residual]
    density = on_functions(variant_density(known, variant))
    theirs = [at_points(equation.lhs) for equation in euler_equations(density, [X, Y], [xi, eta])]
    return ours, theirs


@pytest.mark.slow
@pytest.mark.parametrize("variant", WEIGHTS)
@pytest.mark.parametrize("name", BUILTIN)
def test_residual_is_minus_sympys_functional_derivative(name, variant):
    ours, theirs = sides(name, variant)
    for mine, other in zip(ours, theirs, strict=True):
        assert [sympy.simplify(a + b) for a, b in zip(mine, other, strict=True)] == [0, 0]
        assert any(a != 0 for a in mine)  # a flipped sign would be seen


@pytest.mark.parametrize("name", ["winslow", "length"])
def test_reduction_is_exact(name):
    derived = euler_lagrange(functional(name))
    reduction = derived.reduction
    assert reduction is not None
    product = reduction.operator.matrix * sympy.Matrix(reduction.system)
    for left, right in zip(product, derived.residual, strict=True):
        assert sympy.cancel(expand_metric(left - right)) == 0
        assert sympy.cancel(expand_metric(left + right)) != 0


def test_winslow_reduces_to_the_classical_equations():
    reduction = euler_lagrange(functional("winslow")).reduction
    assert reduction is not None
    assert reduction.operator.determinant == 4 / J**4
    g11, g12, g22 = (symbol(name) for name in ("g11", "g12", "g22"))
    ratio = sympy.cancel(reduction.operator.coefficients[0] / g22)
    assert ratio.is_number
    assert [sympy.expand(part / ratio) for part in reduction.operator.coefficients] == [g22, -2 * g12, g11]


def test_the_jacobian_is_a_null_lagrangian():
    residual = euler_lagrange(Functional("jacobian", "J")).residual
    assert [sympy.expand(expand_metric(part)) for part in residual] == [0, 0]
    other = euler_lagrange(Functional("jacobian_squared", "J**2")).residual
    assert sympy.expand(expand_metric(other[0])) != 0


def test_weight_laws_of_area():
    frozen = equidistribution(functional("area"), "frozen")
    differentiated = equidistribution(functional("area"), "differentiated")
    assert frozen is not None
    assert differentiated is not None
    assert frozen.law == s * J
    assert differentiated.law == sympy.sqrt(s) * J
    assert differentiated.multiplier == sympy.sqrt(s)


def test_no_weight_law_where_there_is_none():
    assert equidistribution(functional("winslow"), "frozen") is None
    assert equidistribution(functional("area"), "plain") is None
    assert equidistribution(functional("combined"), "frozen") is None


def test_the_law_is_found_for_other_powers():
    cubic = define("cubic_area", "s*J**3", replace=True)
    found = equidistribution(cubic, "frozen")
    assert found is not None
    assert found.law == sympy.sqrt(s) * J


def test_verify_does_not_touch_the_registry():
    before = functionals()
    verify([])
    assert functionals() == before
