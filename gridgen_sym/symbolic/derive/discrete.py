"""The discrete side: energy, gradient and Hessians of one corner, derived from the density.

A corner of a cell has the edge vectors g1 = (x_xi, y_xi) and g2 = (x_eta, y_eta), one-sided differences
taken so that xi and eta increase; J > 0 at every corner of a valid grid. The ±1 chain rule from edge
vectors to node coordinates belongs to the templates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ...errors import GridgenError
from ...functionals.choices import decided_at
from ...functionals.definition import Functional
from ...functionals.field_kinds import typical_values
from ...functionals.metric import symbol
from ...functionals.variant import Modes
from ..admissible import admissible
from ..convexity import convexity
from ..coordinates import (
    DEFINITIONS,
    DETERMINANTS,
    FIRST_DERIVATIVES,
    METRIC,
    METRIC_ALONG,
    NAMED_TARGET_METRIC,
    REGULARIZED,
    TARGET,
    TARGET_DERIVATIVES,
    TARGET_IN_METRIC,
    TARGET_METRIC,
    J,
    Variant,
    differentiate_along,
    epsilon,
    expand_metric,
    g11,
    g12,
    g22,
    metric_gradient,
    s,
)
from ..definiteness import Definiteness
from ..values import Values, values_of

#: A Jacobian so near to zero that comparisons in a density stand as they do in the limit.
_NEAR_ZERO = sympy.Rational(1, 10**30)


@dataclass(frozen=True, slots=True)
class CornerModel:
    """One corner's energy and its derivatives, in the edge vectors and the metric symbols.

    Attributes:
        functional: what it was derived from.
        variant: how the weight, fields and a target enter, or `regularized`.
        values: the symbols beside the metric.
        parameters: the symbols of the functional's parameters (and `epsilon` of the regularized barrier).
        energy: the corner energy.
        slopes: its derivatives in the metric symbols and, where the density names them, in the components of the edge
            vectors, by symbol, without those that are zero.
        gradient: its 4 derivatives in (x_xi, y_xi, x_eta, y_eta).
        hessian: the full 4x4 second derivative.
        semidefinite_hessian: the 4x4 second derivative of P(A, J) without the term dP/dJ d²J.
        splitting: whether P is convex where J > 0 and the parameters are admissible, so that `semidefinite_hessian` is
            positive semidefinite there, and how that was decided; else kernels clamp the eigenvalues of `hessian`.
        position_gradient: 2 derivatives in the corner's own position, through values that move with it; zero where
            there are none.
        position_cross: 4x2 mixed derivatives (edge vectors, position).
        position_hessian: 2x2 derivatives in the position.
        hessian_vector: 4 derivatives of `gradient` along `DIRECTION` (and, where values move, `POSITION_DIRECTION`):
            the Hessian times a vector.
        semidefinite_hessian_vector: the same of `semidefinite_hessian`.
        position_hessian_vector: 2 derivatives of `position_gradient` along the same.
    """

    functional: Functional
    variant: Variant
    values: Values
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

    Without a weight s = 1; with one, a density that does not name `s` is multiplied by it. With a target, a density
    that names the metric of T = A W⁻¹ has it; in any other one the metric is that of T. `regularized` replaces J, and
    det T, by chi.

    Raises:
        GridgenError: if a functional without a barrier is to be regularized.
    """
    modes, density = Modes.read(variant), functional.expression()
    density = _with_target(density) if modes.target else density.xreplace(_WITHOUT_TARGET)
    if modes.weight:
        return density if s in density.free_symbols else s * density
    density = density.subs(s, 1)
    if modes.regularized:
        if not has_barrier(functional):
            raise GridgenError(
                f"functional {functional.name!r} has no barrier at J = 0: there is nothing to regularize"
            )
        return density.subs({jacobian: of_chi for of_chi, (jacobian, _) in REGULARIZED.items()})
    return density


_WITHOUT_TARGET: Mapping[Symbol, Expr] = dict(zip(NAMED_TARGET_METRIC, METRIC, strict=True))


def _with_target(density: Expr) -> Expr:
    """Return a density relative to a target."""
    if density.free_symbols & {*NAMED_TARGET_METRIC}:
        return density.xreplace(dict(zip(NAMED_TARGET_METRIC, TARGET_METRIC, strict=True)))
    relative = zip((*METRIC, *FIRST_DERIVATIVES), (*TARGET_METRIC, *TARGET_DERIVATIVES), strict=True)
    return density.xreplace(dict(relative))


def has_barrier(functional: Functional) -> bool:
    """Return whether the density tends to plus infinity as J tends to zero from above.

    Decided by the limit on a corner with fixed edge lengths, at the default parameters and typical values of fields.
    """
    density = functional.expression().xreplace(_WITHOUT_TARGET)
    density = density.subs({symbol(n): sympy.nsimplify(v, rational=True) for n, v in functional.parameters.items()})
    corner = density.subs({s: 1, g11: 2, g22: 3, g12: 1}).subs(dict(zip(FIRST_DERIVATIVES, (1, 1, 1, 1), strict=True)))
    corner = corner.subs({p: sympy.Rational(v) for p, v in _typical(functional).items()})
    corner = decided_at(corner, {J: _NEAR_ZERO})
    return J in corner.free_symbols and sympy.limit(corner, J, 0, "+") == sympy.oo


def _typical(functional: Functional) -> dict[Symbol, float]:
    return {symbol(name): value for name, value in typical_values(functional.fields).items()}


@lru_cache(maxsize=64)
def corner_model(functional: Functional, variant: Variant = "plain") -> CornerModel:
    """Derive the corner model of a functional; once per process."""
    density, values = functional.corner_factor * variant_density(functional, variant), values_of(functional, variant)
    slope, axes = gradient(density), (0, 1)
    position = tuple(values.differentiate(density, axis) for axis in axes)
    # The same as the derivatives of `slope`, but the chain rule to the edge vectors comes last, as in `slope`.
    cross = [gradient(entry) for entry in position]
    return CornerModel(
        functional=functional,
        variant=variant,
        values=values,
        parameters=_parameters(functional, variant),
        energy=density,
        slopes=slopes(density),
        gradient=slope,
        hessian=hessian(density),
        semidefinite_hessian=hessian(density, drop_jacobian_curvature=True),
        splitting=_splitting(functional, variant),
        position_gradient=(position[0], position[1]),
        position_cross=sympy.Matrix(4, 2, lambda k, axis: cross[axis][k]),
        position_hessian=sympy.Matrix(2, 2, lambda a, b: values.differentiate(position[a], b)),
        hessian_vector=hessian_vector(density, values.in_plane),
        semidefinite_hessian_vector=hessian_vector(density, {}, drop_jacobian_curvature=True),
        position_hessian_vector=tuple(differentiate_along(entry, values.in_plane) for entry in position),
    )


def _parameters(functional: Functional, variant: Variant) -> tuple[Symbol, ...]:
    extra = (epsilon,) if Modes.read(variant).regularized else ()
    return (*(symbol(name) for name in functional.parameters), *extra)


def slopes(density: Expr) -> dict[Symbol, Expr]:
    """Return the derivatives in the metric symbols and in the edge vectors' components, each with the others held.

    A Jacobian takes what its chi adds, and all take what the metric of a target adds, which is linear in them; those
    that are zero are left out.
    """
    along = {m: sympy.diff(density, m) for m in (*METRIC, *FIRST_DERIVATIVES, *TARGET_METRIC, *TARGET_DERIVATIVES)}
    for of_chi, (jacobian, of_root) in REGULARIZED.items():
        along[jacobian] += sympy.diff(density, of_chi) * of_chi / of_root
    result = {symbol: along[symbol] for symbol in (*METRIC, *FIRST_DERIVATIVES)}
    for m, meaning in (*TARGET_IN_METRIC.items(), *((m, TARGET[m]) for m in TARGET_DERIVATIVES)):
        slope = along[m]
        if slope != 0:
            for symbol in result.keys() & meaning.free_symbols:
                result[symbol] += slope * sympy.diff(meaning, symbol)
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

    With `drop_jacobian_curvature` the terms dF/dJ d²J (and those of chi, and of det T) are left out: the
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
        if not (drop_jacobian_curvature and m in DETERMINANTS):
            result += sympy.diff(density, m) * _metric_hessian(m)
    return result


def hessian_vector(
    density: Expr, moving: Mapping[Symbol, tuple[Expr, Expr]], *, drop_jacobian_curvature: bool = False
) -> tuple[Expr, ...]:
    """Return the 4 derivatives of the gradient along a direction: the Hessian times a vector, without the Hessian.

    The gradient is a sum of dF/dm dm; so this is one of d(dF/dm) dm + dF/dm d(dm), whose first factors the four
    entries share. `moving` are the values that move with the position; `drop_jacobian_curvature` is that of `hessian`.
    """
    result = [differentiate_along(sympy.diff(density, p), moving) for p in FIRST_DERIVATIVES]
    for m in _metric_symbols(density):
        factor = sympy.diff(density, m)
        factor_along = differentiate_along(factor, moving)
        curved = not (drop_jacobian_curvature and m in DETERMINANTS)
        for k, slope in enumerate(metric_gradient(m)):
            result[k] += factor_along * slope
            if curved:
                result[k] += factor * _slope_along(m, k)
    return tuple(result)


def _slope_along(m: Symbol, k: int) -> Expr:
    """Return how entry k of the gradient of a metric symbol moves; for a chi, with chi'' = epsilon²/(2 root³)."""
    if m in REGULARIZED:
        of, root = REGULARIZED[m]
        curvature = epsilon**2 / (2 * root**3)
        return curvature * METRIC_ALONG[of] * metric_gradient(of)[k] + m / root * _slope_along(of, k)
    return differentiate_along(metric_gradient(m)[k])


def _metric_symbols(density: Expr) -> list[Symbol]:
    roots = [root for _, root in REGULARIZED.values()]
    return [m for m in DEFINITIONS if m not in roots and m in density.free_symbols]


def _metric_hessian(m: Symbol) -> sympy.Matrix:
    """Return the 4x4 second derivative of a metric symbol; for a chi, with chi'' = epsilon²/(2 root³)."""
    if m in REGULARIZED:
        of, root = REGULARIZED[m]
        slope = sympy.Matrix(metric_gradient(of))
        return epsilon**2 / (2 * root**3) * slope * slope.T + m / root * _metric_hessian(of)
    return sympy.hessian(expand_metric(DEFINITIONS[m]), FIRST_DERIVATIVES)


def _splitting(functional: Functional, variant: Variant) -> Definiteness:
    """Decide whether P(A, J), with J (or chi) a positive variable of its own, is convex at admissible values.

    A target changes nothing: T is linear in A, and det T a positive multiple of J.
    """
    modes = Modes.read(variant)
    bare = Modes(modes.weight, modes.differentiated, regularized=modes.regularized)
    if modes.control:
        return corner_model(functional, replace(modes, control=False).variant).splitting
    if modes.target and not functional.expression().free_symbols & {*NAMED_TARGET_METRIC}:
        return corner_model(functional, bare.variant).splitting
    density = functional.corner_factor * variant_density(functional, variant)
    determinant = sympy.Symbol("D", positive=True)
    split = density.subs({of_chi: jacobian for of_chi, (jacobian, _) in REGULARIZED.items()}).subs(J, determinant)
    split = expand_metric(split.subs({m: TARGET[m].subs(J, determinant) for m in TARGET_METRIC if TARGET[m].has(J)}))
    variables = (*FIRST_DERIVATIVES, determinant)
    return convexity(split, variables, positive=(determinant, s), parameters=admissible(functional))
