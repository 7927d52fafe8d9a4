"""Derivatives of every corner model against 30-digit differences of its energy."""

from __future__ import annotations

import random

import numpy as np
import pytest
import sympy
from support import BUILTIN

from gridgen_sym.functionals import functional
from gridgen_sym.functionals.metric import symbol
from gridgen_sym.symbolic import corner_model, has_barrier
from gridgen_sym.symbolic.coordinates import (
    FIRST_DERIVATIVES,
    METRIC,
    V11,
    V12,
    V21,
    V22,
    J,
    epsilon,
    expand_metric,
    s,
    s_x,
    s_xx,
    s_xy,
    s_y,
    s_yy,
    x,
    y,
)

VARIANTS = ("plain", "frozen", "differentiated", "regularized", "target+regularized")
CASES = [(n, v) for n in BUILTIN for v in VARIANTS if "regularized" not in v or has_barrier(functional(n))]
DIGITS, STEP, CLOSE = 40, sympy.Rational(1, 10**10), 1e-15


def corners(count, seed, *, folded=False):
    """Yield random rational corners with J > 0 (or of any sign)."""
    source = random.Random(seed)
    while count:
        corner = [sympy.Rational(source.randint(-30, 30), 10) for _ in FIRST_DERIVATIVES]
        values = dict(zip(FIRST_DERIVATIVES, corner, strict=True))
        if folded or METRIC[J].subs(values) > sympy.Rational(1, 4):
            count -= 1
            yield values


def settings(model):
    """Return values of the weight, the inverse target and the parameters."""
    defaults = {symbol(n): sympy.nsimplify(v) for n, v in model.functional.parameters.items()}
    target = dict(zip((V11, V12, V21, V22), map(sympy.Rational, ("3/2", "-1/3", "1/4", "2/3")), strict=True))
    return defaults | target | {s: sympy.Rational(7, 5), epsilon: sympy.Rational(1, 3)}


def value(expression, point):
    return float(expand_metric(expression).subs(point).evalf(DIGITS))


def difference(function, variable, point):
    """Return a central difference in exact arithmetic: the error is of the order of STEP²."""
    after, before = (function.subs(point | {variable: point[variable] + c * STEP}).evalf(DIGITS) for c in (1, -1))
    return float((after - before) / (2 * STEP))


def gradient_error(model, gradient, point):
    energy = expand_metric(model.energy)
    pairs = [(value(g, point), difference(energy, p, point)) for g, p in zip(gradient, FIRST_DERIVATIVES, strict=True)]
    return max(abs(a - b) / (1 + abs(b)) for a, b in pairs)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "variant"), CASES)
def test_gradient_and_hessian_against_differences(name, variant):
    model = corner_model(functional(name), variant)
    for corner in corners(2 if variant == "plain" else 1, f"{name}{variant}", folded="regularized" in variant):
        point = settings(model) | corner
        assert gradient_error(model, model.gradient, point) < CLOSE
        for i, slope in enumerate(model.gradient):
            written_out = expand_metric(slope)
            for j, p in enumerate(FIRST_DERIVATIVES):
                derived, expected = value(model.hessian[i, j], point), difference(written_out, p, point)
                assert derived == pytest.approx(expected, rel=CLOSE, abs=CLOSE)


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILTIN)
def test_a_flipped_sign_is_seen(name):
    model = corner_model(functional(name))
    point = settings(model) | next(corners(1, 5))
    wrong = [-model.gradient[0], *model.gradient[1:]]
    assert gradient_error(model, wrong, point) > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILTIN)
def test_position_derivatives_through_the_weight(name):
    model = corner_model(functional(name), "differentiated")
    weight = 3 + x**2 + 2 * x * y + y**3
    slopes = {s_x: weight.diff(x), s_y: weight.diff(y)}
    bends = {s_xx: weight.diff(x, 2), s_xy: weight.diff(x, y), s_yy: weight.diff(y, 2)}
    energy = model.energy.subs(s, weight)
    for i, r in enumerate((x, y)):
        found = model.position_gradient[i].subs(slopes).subs(s, weight)
        assert sympy.expand(found - energy.diff(r)) == 0
        for j, q in enumerate((x, y)):
            found = model.position_hessian[i, j].subs(slopes | bends).subs(s, weight)
            assert sympy.expand(found - energy.diff(r, q)) == 0
        cross = model.position_cross[:, i].subs(slopes).subs(s, weight)
        expected = sympy.Matrix([expand_metric(energy).diff(p).diff(r) for p in FIRST_DERIVATIVES])
        assert all(sympy.simplify(expand_metric(part)) == 0 for part in cross - expected)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "variant"), CASES)
def test_semidefinite_hessian(name, variant):
    model = corner_model(functional(name), variant)
    if not model.splitting.holds:
        assert model.splitting.witness
        return
    matrix = expand_matrix(model.semidefinite_hessian).subs(settings(model))
    evaluate = sympy.lambdify(FIRST_DERIVATIVES, matrix, "numpy")
    points = np.random.default_rng(1).normal(size=(300, 4))
    for point in points:
        if point[0] * point[3] <= point[1] * point[2]:
            point[2:] *= -1
        eigenvalues = np.linalg.eigvalsh(np.array(evaluate(*point), dtype=float))
        assert eigenvalues[0] >= -1e-12 * max(abs(eigenvalues[-1]), 1e-300)


def expand_matrix(matrix):
    return matrix.applyfunc(expand_metric)


def test_known_convexity():
    holds = {
        name: corner_model(functional(name)).splitting
        for name in ("area", "length", "winslow", "liao", "modified_liao")
    }
    assert all(answer.holds and answer.proof == "proved" for answer in holds.values())
    for name in ("orthogonality", "knupp", "combined"):
        assert corner_model(functional(name)).splitting.proof == "refuted"


def test_full_hessian_of_a_barrier_is_not_semidefinite():
    # The splitting is worth something only because the whole Hessian fails the same test.
    matrix = expand_matrix(corner_model(functional("winslow")).hessian)
    corner = dict(zip(FIRST_DERIVATIVES, (1, 0, 3, sympy.Rational(1, 2)), strict=True))
    assert min(np.linalg.eigvalsh(np.array(matrix.subs(corner), dtype=float))) < -1e-3
