"""Rewrite expressions in the first derivatives of the map in g11, g22, g12 and J, where they can be."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import sympy
from sympy import Expr, Symbol

from ..coordinates import FIRST_DERIVATIVES, METRIC, J, expand_metric, g11, g12, g22, x_eta, x_xi, y_eta, y_xi


def in_metric(expression: Expr) -> Expr:
    """Rewrite factors that are multiples of g11, g22, g12 or J in those symbols."""
    constant, above, below = _factors(expression)
    return constant * _product((_metric_multiple(factor), power) for factor, power in (*above, *below))


def written_in_metric(expression: Expr, linear: Sequence[Symbol] = ()) -> Expr | None:
    """Return an expression in the metric, term by term in `linear` symbols; None where it cannot be written so.

    Args:
        expression: a quotient of polynomials.
        linear: symbols, such as the derivatives of values; few terms have many of them.
    """
    above, below = sympy.fraction(expression)
    present = [symbol for symbol in linear if above.has(symbol)]
    result = sympy.S.Zero
    for powers, part in sympy.Poly(above, *present).terms() if present else [((), above)]:
        constant, top, bottom = _factors(part / below)
        coefficient = constant * _product((_as_sum(factor), power) for factor, power in (*top, *bottom))
        if coefficient.free_symbols & {*FIRST_DERIVATIVES}:
            return None
        result += coefficient * sympy.prod(map(sympy.Pow, present, powers))
    return result


def _factors(expression: Expr) -> tuple[Expr, list[tuple[Expr, int]], list[tuple[Expr, int]]]:
    """Return a number and the factors above and below, these with negative powers."""
    constant, above = sympy.factor_list(sympy.numer(expression))
    constant_below, below = sympy.factor_list(sympy.denom(expression))
    return constant / constant_below, above, [(factor, -power) for factor, power in below]


def _product(factors: Iterable[tuple[Expr, int]]) -> Expr:
    return sympy.prod(factor**power for factor, power in factors)


def _metric_multiple(factor: Expr) -> Expr:
    for name, meaning in METRIC.items():
        # Most factors are in other symbols, which is seen at once.
        if factor.free_symbols == meaning.free_symbols:
            ratio = sympy.cancel(factor / meaning)
            if ratio.is_number:
                return ratio * name
    return factor


def _as_sum(factor: Expr) -> Expr:
    """Return a factor in the metric; as it is, where it is no polynomial in it.

    What a rotation of the plane does not change is known from the frame with y_xi = 0. There g11 = x_xi²,
    g12 = x_xi x_eta, J = x_xi y_eta and g22 = x_eta² + y_eta².
    """
    multiple = _metric_multiple(factor)
    if multiple != factor or not factor.free_symbols & {*FIRST_DERIVATIVES}:
        return multiple
    frame = sympy.expand(factor.subs(y_xi, 0))
    if not frame.is_polynomial(*FIRST_DERIVATIVES):
        return factor
    result = sympy.S.Zero
    for (along, across, up), part in sympy.Poly(frame, x_xi, x_eta, y_eta).terms():
        odd = up % 2
        # y_eta² = g22 - x_eta², and x_eta = g12/x_xi.
        rest = part * J**odd * (g22 - g12**2 / g11) ** ((up - odd) // 2) * g12**across
        degree = along - across - odd
        if degree % 2:
            return factor
        result += rest * g11 ** (degree // 2)
    result = sympy.expand(result)
    return result if sympy.expand(expand_metric(result) - factor) == 0 else factor
