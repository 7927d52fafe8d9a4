"""The continuous side: the Euler–Lagrange equations of a functional, derived from the same density.

With F the density, r = x or y, the residual is

    R_r = d/dxi (dF/dr_xi) + d/deta (dF/dr_eta) - dF/dr,

minus the functional derivative, so that the length functional gives plus the Laplacian. It is quasilinear:
linear in the second derivatives, with coefficients that depend on the first ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ...errors import GridgenError
from ...functionals.definition import Functional
from ...functionals.metric import CONTROL_NAMES, symbol
from ...functionals.variant import Modes
from ..coordinates import (
    FIRST_DERIVATIVES,
    SECOND_DERIVATIVES,
    Variant,
    differentiate,
    expand_metric,
    x_etaeta,
    x_xieta,
    x_xixi,
    y_etaeta,
    y_xieta,
    y_xixi,
)
from ..values import Values, values_of
from .discrete import gradient, hessian, variant_density
from .reduction import Reduction, ScalarOperator, find_reduction, find_scalar_operator

#: The derivatives along xi and eta of every first derivative, in the order of `FIRST_DERIVATIVES`.
ALONG_XI = (x_xixi, y_xixi, x_xieta, y_xieta)
ALONG_ETA = (x_xieta, y_xieta, x_etaeta, y_etaeta)
#: Where more derivatives of values enter, as those of a target do, a reduction takes long to find and shows little.
_MOST_SLOPES = 6


@dataclass(frozen=True, slots=True)
class EulerLagrange:
    """The two Euler–Lagrange equations of a functional, each = 0.

    Attributes:
        functional: what they were derived from.
        variant: how the weight, fields and a target enter.
        values: the symbols beside the metric, and their derivatives.
        fluxes: (dF/dx_xi, dF/dy_xi, dF/dx_eta, dF/dy_eta): the divergence form is
            d/dxi fluxes[0] + d/deta fluxes[2] - sources[0] = 0 for x; fluxes[1], fluxes[3], sources[1] for y.
        sources: (dF/dx, dF/dy), at a fixed map: of a density that names the place, or values that move with it.
        coefficients: for every second derivative the pair of its coefficients in the two residuals.
        rest: what is left of the two residuals, of lower order.
        residual: the two expanded residuals, in the metric symbols.
        operator: the scalar operator of which the second-order part is a multiple, where there is one.
        reduction: a simpler equivalent system, where one was found.
    """

    functional: Functional
    variant: Variant
    values: Values
    fluxes: tuple[Expr, ...]
    sources: tuple[Expr, Expr]
    coefficients: Mapping[Symbol, tuple[Expr, Expr]]
    rest: tuple[Expr, Expr]
    residual: tuple[Expr, Expr]
    operator: ScalarOperator | None
    reduction: Reduction | None

    def expanded(self) -> tuple[Expr, Expr]:
        """Return the two residuals written out in the derivatives of x and y alone."""
        first, second = (expand_metric(part) for part in self.residual)
        return first, second


@lru_cache(maxsize=64)
def euler_lagrange(functional: Functional, variant: Variant = "plain") -> EulerLagrange:
    """Derive the Euler–Lagrange equations of a functional.

    A `frozen` weight is a given function of (xi, eta), with derivatives `s_xi`, `s_eta`; a `differentiated`
    one is s(x, y), with derivatives `s_x`, `s_y`. So are the components of fields: `M11_xi`, or `M11_x`. A target is a
    function of (xi, eta), of whose inverse V the derivatives are `V11_xi` .... Control functions are in the reduced
    system alone.

    Raises:
        GridgenError: for the regularized barrier, which is a tool of the discrete side.
    """
    if Modes.read(variant).regularized:
        raise GridgenError(f"the regularized barrier of {functional.name!r} serves untangling only: use 'plain'")
    density, values = variant_density(functional, variant), values_of(functional, variant)
    fluxes = gradient(density)
    slope = hessian(density)
    sources = values.differentiate(density, 0), values.differentiate(density, 1)
    rest = tuple(
        values.differentiate_along(fluxes[component], 0)
        + values.differentiate_along(fluxes[2 + component], 1)
        - sources[component]
        for component in (0, 1)
    )
    coefficients = {second: _coefficients(slope, second) for second in SECOND_DERIVATIVES}
    residual = tuple(
        sum((coefficients[second][component] * second for second in SECOND_DERIVATIVES), rest[component])
        for component in (0, 1)
    )
    lower = rest[0], rest[1]
    few = len(values.derivatives) <= _MOST_SLOPES
    operator = find_scalar_operator(coefficients, lower) if few else None
    reduction = find_reduction(operator, lower, values.derivatives)
    return EulerLagrange(
        functional=functional,
        variant=variant,
        values=values,
        fluxes=fluxes,
        sources=sources,
        coefficients=coefficients,
        rest=lower,
        residual=(residual[0], residual[1]),
        operator=operator,
        reduction=_controlled(functional, reduction) if Modes.read(variant).control else reduction,
    )


def _controlled(functional: Functional, reduction: Reduction | None) -> Reduction:
    """Return a reduced system with the control functions P and Q.

    Raises:
        GridgenError: if there is none.
    """
    if reduction is None:
        raise GridgenError(
            "control functions need equations that are alpha r_xixi + beta r_xieta + gamma r_etaeta for r = x and y, "
            f"as those of winslow: those of {functional.name!r} are not, as given here"
        )
    return reduction.with_control(*map(symbol, CONTROL_NAMES))


def _coefficients(slope: sympy.Matrix, second: Symbol) -> tuple[Expr, Expr]:
    """Return the coefficients of a second derivative in the two residuals, from the density's 4x4 Hessian."""
    pair = []
    for component in (0, 1):
        along_xi = sum((slope[component, k] for k in range(4) if ALONG_XI[k] == second), sympy.S.Zero)
        along_eta = sum((slope[2 + component, k] for k in range(4) if ALONG_ETA[k] == second), sympy.S.Zero)
        pair.append(along_xi + along_eta)
    return pair[0], pair[1]


def residual_slopes(residual: tuple[Expr, Expr]) -> Mapping[Symbol, tuple[Expr, Expr]]:
    """Return the derivatives of two residuals in every first and second derivative of the map."""
    slopes = {p: tuple(differentiate(part, p) for part in residual) for p in FIRST_DERIVATIVES}
    slopes |= {second: tuple(sympy.diff(part, second) for part in residual) for second in SECOND_DERIVATIVES}
    return {variable: (pair[0], pair[1]) for variable, pair in slopes.items()}


def total_derivative(expression: Expr, along: str, values: Values) -> Expr:
    """Return the derivative along `xi` or `eta`, through the first derivatives of the map and the values."""
    slopes = ALONG_XI if along == "xi" else ALONG_ETA
    result = sum(
        (differentiate(expression, p) * slope for p, slope in zip(FIRST_DERIVATIVES, slopes, strict=True)),
        sympy.S.Zero,
    )
    return result + values.differentiate_along(expression, int(along == "eta"))
