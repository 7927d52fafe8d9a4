"""The discrete side: energy, gradient and Hessians of one corner, derived from the density.

A corner of a cell has the edge vectors g1 = (x_xi, y_xi) and g2 = (x_eta, y_eta), one-sided differences
taken so that xi and eta increase; J > 0 at every corner of a valid grid. The ±1 chain rule from edge
vectors to node coordinates belongs to the templates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ...errors import GridgenError
from ...functionals.definition import Functional
from ...functionals.metric import symbol
from ..admissible import Admissible, admissible
from ..coordinates import (
    FIRST_DERIVATIVES,
    METRIC,
    METRIC_ALONG,
    POSITION_DIRECTION,
    J,
    Variant,
    chi,
    differentiate_along,
    epsilon,
    g11,
    g12,
    g22,
    metric_gradient,
    root,
    s,
    s_x,
    s_xx,
    s_xy,
    s_y,
    s_yy,
)
from ..definiteness import Definiteness, semidefinite


@dataclass(frozen=True, slots=True)
class CornerModel:
    """One corner's energy and its derivatives, in the edge vectors and the metric symbols.

    Attributes:
        functional: what it was derived from.
        variant: how the weight enters, or `regularized`.
        parameters: the symbols of the functional's parameters (and `epsilon` of the regularized barrier).
        energy: the corner energy.
        slopes: its derivatives in the metric symbols and, where the density names them, in the components of the edge
            vectors, by symbol, without those that are zero.
        gradient: its 4 derivatives in (x_xi, y_xi, x_eta, y_eta).
        hessian: the full 4x4 second derivative.
        semidefinite_hessian: the 4x4 second derivative of P(A, J) without the term dP/dJ d²J.
        splitting: whether P is convex where J > 0 and the parameters are admissible, so that `semidefinite_hessian` is
            positive semidefinite there, and how that was decided; else kernels clamp the eigenvalues of `hessian`.
        position_gradient: 2 derivatives in the corner's own position, through s(x, y); zero unless
            `variant` is `differentiated`.
        position_cross: 4x2 mixed derivatives (edge vectors, position).
        position_hessian: 2x2 derivatives in the position.
        hessian_vector: 4 derivatives of `gradient` along `DIRECTION` (and, where the weight is differentiated,
            `POSITION_DIRECTION`): the Hessian times a vector.
        semidefinite_hessian_vector: the same of `semidefinite_hessian`.
        position_hessian_vector: 2 derivatives of `position_gradient` along the same.
    """

    functional: Functional
    variant: Variant
    parameters: tuple[Symbol, ...]
    energy: Expr
    slopes: Mapping[Symbol, Expr]
    gradient: tuple[Expr, ...]
    hessian: sympy.Matrix
    semidefinite_hessian: sympy.Matrix
    splitting: Definiteness
    position_gradient: tuple[Expr, Expr]
    position_cross: sympy.Matrix
    position_hessian: sympy.Matrix
    hessian_vector: tuple[Expr, ...]
    semidefinite_hessian_vector: tuple[Expr, ...]
    position_hessian_vector: tuple[Expr, ...]


def variant_density(functional: Functional, variant: Variant) -> Expr:
    """Return the continuous density of a variant, in the metric symbols.

    `plain` sets s = 1; the weighted variants multiply a density that does not name `s` by it;
    `regularized` replaces J by chi.

    Raises:
        GridgenError: if a functional without a barrier is to be regularized.
    """
    density = functional.expression()
    if variant in ("frozen", "differentiated"):
        return density if s in density.free_symbols else s * density
    density = density.subs(s, 1)
    if variant == "regularized":
        if not has_barrier(functional):
            raise GridgenError(
                f"functional {functional.name!r} has no barrier at J = 0: there is nothing to regularize"
            )
        return density.subs(J, chi)
    return density


def has_barrier(functional: Functional) -> bool:
    """Return whether the density tends to plus infinity as J tends to zero from above.

    Decided by the limit on a corner with fixed edge lengths, at the default parameters.
    """
    density = functional.expression().subs(
        {symbol(n): sympy.nsimplify(v, rational=True) for n, v in functional.parameters.items()}
    )
    corner = density.subs({s: 1, g11: 2, g22: 3, g12: 1}).subs(dict(zip(FIRST_DERIVATIVES, (1, 1, 1, 1), strict=True)))
    return J in corner.free_symbols and sympy.limit(corner, J, 0, "+") == sympy.oo


@lru_cache(maxsize=64)
def corner_model(functional: Functional, variant: Variant = "plain") -> CornerModel:
    """Derive the corner model of a functional; once per process."""
    density = functional.corner_factor * variant_density(functional, variant)
    differentiated = variant == "differentiated"
    weight = sympy.Matrix([s_x, s_y]) if differentiated else sympy.zeros(2, 1)
    weight_second = sympy.Matrix([[s_xx, s_xy], [s_xy, s_yy]]) if differentiated else sympy.zeros(2, 2)
    density_s = sympy.diff(density, s)
    position = density_s * weight
    return CornerModel(
        functional=functional,
        variant=variant,
        parameters=_parameters(functional, variant),
        energy=density,
        slopes=slopes(density),
        gradient=gradient(density),
        hessian=hessian(density),
        semidefinite_hessian=hessian(density, drop_jacobian_curvature=True),
        splitting=_splitting(density, admissible(functional)),
        position_gradient=(position[0], position[1]),
        position_cross=sympy.Matrix(gradient(density_s)) * weight.T,
        position_hessian=sympy.diff(density_s, s) * weight * weight.T + density_s * weight_second,
        hessian_vector=hessian_vector(density, weighted=differentiated),
        semidefinite_hessian_vector=hessian_vector(density, weighted=False, drop_jacobian_curvature=True),
        position_hessian_vector=tuple(differentiate_along(entry) for entry in position),
    )


def _parameters(functional: Functional, variant: Variant) -> tuple[Symbol, ...]:
    extra = (epsilon,) if variant == "regularized" else ()
    return (*(symbol(name) for name in functional.parameters), *extra)


def slopes(density: Expr) -> dict[Symbol, Expr]:
    """Return the derivatives in the metric symbols and in the edge vectors' components, each with the others held.

    That in J takes what chi adds; those that are zero are left out.
    """
    result = {symbol: sympy.diff(density, symbol) for symbol in (*METRIC, *FIRST_DERIVATIVES)}
    result[J] += sympy.diff(density, chi) * chi / root
    return {symbol: slope for symbol, slope in result.items() if slope != 0}


def gradient(density: Expr) -> tuple[Expr, ...]:
    """Return the 4 derivatives in the edge vectors, by the chain rule through the metric symbols."""
    along = slopes(density)
    result = [along.get(p, sympy.S.Zero) for p in FIRST_DERIVATIVES]
    for m in METRIC:
        for k, slope in enumerate(metric_gradient(m) if m in along else ()):
            result[k] += along[m] * slope
    return tuple(result)


def hessian(density: Expr, *, drop_jacobian_curvature: bool = False) -> sympy.Matrix:
    """Return the 4x4 second derivative in the edge vectors, by the chain rule through the metric symbols.

    With `drop_jacobian_curvature` the terms dF/dJ d²J (and dF/dchi d²chi) are left out: the
    second derivative of P(A, J) pulled back to A, positive semidefinite wherever P is convex.
    """
    variables = (*FIRST_DERIVATIVES, *_metric_symbols(density))
    jacobian = sympy.Matrix(
        [
            list(metric_gradient(v)) if v not in FIRST_DERIVATIVES else [int(v == p) for p in FIRST_DERIVATIVES]
            for v in variables
        ]
    )
    result = jacobian.T * sympy.hessian(density, variables) * jacobian
    for m in _metric_symbols(density):
        if not (drop_jacobian_curvature and m in (J, chi)):
            result += sympy.diff(density, m) * _metric_hessian(m)
    return result


def hessian_vector(density: Expr, *, weighted: bool, drop_jacobian_curvature: bool = False) -> tuple[Expr, ...]:
    """Return the 4 derivatives of the gradient along a direction: the Hessian times a vector, without the Hessian.

    The gradient is a sum of dF/dm dm; so this is one of d(dF/dm) dm + dF/dm d(dm), whose first factors the four
    entries share. Without `weighted` the weight is held; `drop_jacobian_curvature` is that of `hessian`.
    """
    held = {} if weighted else dict.fromkeys(POSITION_DIRECTION, 0)
    result = [differentiate_along(sympy.diff(density, p)).subs(held) for p in FIRST_DERIVATIVES]
    for m in _metric_symbols(density):
        factor = sympy.diff(density, m)
        factor_along = differentiate_along(factor).subs(held)
        curved = not (drop_jacobian_curvature and m in (J, chi))
        for k, slope in enumerate(metric_gradient(m)):
            result[k] += factor_along * slope
            if curved:
                result[k] += factor * _slope_along(m, k)
    return tuple(result)


def _slope_along(m: Symbol, k: int) -> Expr:
    """Return how entry k of the gradient of a metric symbol moves; for chi, with chi'' = epsilon²/(2 root³)."""
    if m == chi:
        return epsilon**2 / (2 * root**3) * METRIC_ALONG[J] * metric_gradient(J)[k] + chi / root * _slope_along(J, k)
    return differentiate_along(metric_gradient(m)[k])


def _metric_symbols(density: Expr) -> list[Symbol]:
    return [m for m in (*METRIC, chi) if m in density.free_symbols]


def _metric_hessian(m: Symbol) -> sympy.Matrix:
    """Return the constant 4x4 second derivative of a metric symbol; for chi, with chi'' = epsilon²/(2 root³)."""
    if m == chi:
        slope = sympy.Matrix(metric_gradient(J))
        return epsilon**2 / (2 * root**3) * slope * slope.T + chi / root * _metric_hessian(J)
    return sympy.hessian(METRIC[m], FIRST_DERIVATIVES)


def _splitting(density: Expr, parameters: Admissible) -> Definiteness:
    """Decide whether P(A, J), with J (or chi) a positive variable of its own, is convex at admissible parameters."""
    determinant = sympy.Symbol("D", positive=True)
    split = density.subs({J: determinant, chi: determinant}).subs({m: METRIC[m] for m in (g11, g22, g12)})
    second = sympy.hessian(split, (*FIRST_DERIVATIVES, determinant))
    return semidefinite(second, nonnegative=(determinant, s), parameters=parameters)
