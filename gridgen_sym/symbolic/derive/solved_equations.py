"""The equations as solvers solve them: residual, slopes and coefficients, of the reduced system where there is one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sympy import Expr, Symbol

from ..coordinates import FIRST_DERIVATIVES, METRIC, SECOND_DERIVATIVES, TARGET, x, y
from .continuous import EulerLagrange, residual_slopes
from .discrete import variant_density
from .named_equations import NamedEquations

Pairs = Mapping[Symbol, tuple[Expr, Expr]]


@dataclass(frozen=True, slots=True)
class SolvedEquations:
    """Two equations, of x and of y, and their derivatives.

    Attributes:
        residual: of both.
        residual_by_coefficients: the same, in a form that shares more with the coefficients.
        slopes: for every first derivative of the map, and x and y where values move, the pair of derivatives.
        coefficients: the same for every second derivative.
        definitions: what further symbols in these expressions stand for, each after those that it is made of.
    """

    residual: tuple[Expr, Expr]
    residual_by_coefficients: tuple[Expr, Expr]
    slopes: Pairs
    coefficients: Pairs
    definitions: Mapping[Symbol, Expr]


def solved_equations(equations: EulerLagrange) -> SolvedEquations:
    """Return the reduced system, which has the same solutions, if one was found; else the Euler–Lagrange equations."""
    density = variant_density(equations.functional, equations.variant)
    if equations.reduction is None and not _is_polynomial(density):
        parts = NamedEquations(density, equations.values)
        residual, by_coefficients = parts.residual(), parts.residual_by_coefficients()
        return SolvedEquations(residual, by_coefficients, parts.slopes(), parts.coefficients(), parts.definitions)
    system = equations.reduction.system if equations.reduction else equations.residual
    slopes = dict(residual_slopes(system))
    coefficients = {second: slopes.pop(second) for second in SECOND_DERIVATIVES}
    for axis, place in enumerate((x, y) if equations.values.moving else ()):
        pair = [equations.values.differentiate(part, axis) for part in system]
        slopes[place] = pair[0], pair[1]
    return SolvedEquations(system, system, slopes, coefficients, {})


def _is_polynomial(density: Expr) -> bool:
    """Return whether a density is a polynomial in the metric: it has few derivatives, and names for them do not pay."""
    return not density.has(*TARGET) and bool(density.is_polynomial(*METRIC, *FIRST_DERIVATIVES))
