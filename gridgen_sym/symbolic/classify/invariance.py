"""Invariances of a density, decided from the density: rotation, scaling, exchange of the logical coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ...functionals.choices import branches, choice
from ..coordinates import (
    DEFINITIONS,
    FIRST_DERIVATIVES,
    METRIC,
    REGULARIZATION,
    differentiate,
    g11,
    g22,
    x_eta,
    x_xi,
    y_eta,
    y_xi,
)
from .at_points import at_a_jet, vanishes

#: Algebra of more operations than this would take seconds, with powers that are no whole numbers minutes.
_LARGEST = 1000


def is_rotation_invariant(density: Expr) -> bool:
    """Return whether F(R A) = F(A) for every rotation R of the physical plane, as for every F of the metric alone."""
    if density.free_symbols.isdisjoint(FIRST_DERIVATIVES):
        return True
    return _is_stationary(density, (-y_xi, x_xi, -y_eta, x_eta))


def is_logical_rotation_invariant(density: Expr) -> bool:
    """Return whether F(A R) = F(A) for every rotation R of (xi, eta): F then depends on singular values alone."""
    return _is_stationary(density, (x_eta, y_eta, -x_xi, -y_xi))


def scaling_degree(density: Expr) -> Expr | None:
    """Return k with F(c A) = c^k F(A) for all c > 0, or None."""
    return _degree(density, FIRST_DERIVATIVES)


def reparametrization_degrees(density: Expr) -> tuple[Expr | None, Expr | None]:
    """Return the degrees of F in g1 and in g2: how it scales when xi or eta is measured in another unit."""
    return _degree(density, FIRST_DERIVATIVES[:2]), _degree(density, FIRST_DERIVATIVES[2:])


def is_exchange_symmetric(density: Expr) -> bool:
    """Return whether F is unchanged by exchanging xi and eta, with a reflection of x that keeps J's sign."""
    exchange = {g11: g22, g22: g11, x_xi: -x_eta, x_eta: -x_xi, y_xi: y_eta, y_eta: y_xi}
    return _vanishes(density - density.subs(exchange, simultaneous=True))


def _is_stationary(density: Expr, direction: Sequence[Expr]) -> bool:
    """Return whether the density's derivative along a field of jets is zero everywhere."""
    slope = sum(
        (differentiate(density, p) * d for p, d in zip(FIRST_DERIVATIVES, direction, strict=True)), sympy.S.Zero
    )
    return _vanishes(slope)


def _degree(density: Expr, variables: Sequence[Symbol]) -> Expr | None:
    """Return the degree of homogeneity in some of the first derivatives, by Euler's relation."""
    slope = _radial_slope(density, tuple(variables))
    value = at_a_jet(density)
    if value == 0:
        return None
    ratio = at_a_jet(slope) / value
    if not (ratio.is_real and ratio.is_finite):
        return None
    degree = sympy.nsimplify(ratio, rational=True, tolerance=1e-20)
    return degree if _vanishes(slope - degree * density) else None


def _radial_slope(density: Expr, variables: tuple[Symbol, ...]) -> Expr:
    """Return the sum of p dF/dp over some of the first derivatives: in the metric symbols if they suffice."""
    if density.free_symbols & (DEFINITIONS.keys() - METRIC.keys()):
        return sum((p * differentiate(density, p) for p in variables), sympy.S.Zero)
    degrees = {p: 1 for p in variables} | _metric_degrees(variables)
    return sum((degree * m * sympy.diff(density, m) for m, degree in degrees.items()), sympy.S.Zero)


@lru_cache(maxsize=8)
def _metric_degrees(variables: tuple[Symbol, ...]) -> dict[Symbol, int]:
    """Return the degree of every metric symbol in some of the first derivatives."""
    return {m: sympy.Poly(meaning, *variables).total_degree() for m, meaning in METRIC.items()}


def _vanishes(expression: Expr) -> bool:
    """Return whether an expression is zero for all jets: tried at some of them first, then proved by algebra."""
    if expression == 0:
        return True
    if not vanishes(expression):
        return False
    expanded = _expand(expression)
    # In the metric alone the algebra is short; what vanishes there does everywhere.
    if expression.free_symbols.isdisjoint(FIRST_DERIVATIVES) and _is_zero(expression):
        return True
    return _is_zero(expanded)


def _is_zero(expression: Expr) -> bool:
    """Return whether algebra shows that an expression is zero, for every way to decide its comparisons."""
    cases = branches(expression) or [expression]
    return all(_is_zero_by_algebra(case) for case in cases)


def _is_zero_by_algebra(expression: Expr) -> bool:
    """Return whether algebra shows that an expression is zero; a long one need only be zero at some jets."""
    if sympy.count_ops(expression) > _LARGEST:
        return vanishes(expression)
    return bool(sympy.expand(expression) == 0 or sympy.simplify(expression) == 0)


def _expand(expression: Expr) -> Expr:
    """Write out the metric, with the branch J > 0 of the regularized barrier."""
    branch = {
        name: meaning.args[2] if isinstance(meaning, choice) else meaning for name, meaning in REGULARIZATION.items()
    }
    return expression.subs(branch).subs(branch).subs(METRIC)
