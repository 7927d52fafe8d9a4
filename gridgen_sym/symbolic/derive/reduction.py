"""Find out whether a quasilinear system is a non-singular matrix times a simpler system.

If the three 2x2 coefficient matrices of r_xixi, r_xieta, r_etaeta (r = x, y) are multiples of one matrix M and
nothing of lower order is left, the system is M times the scalar operator alpha d²/dxi² + beta d²/dxideta +
gamma d²/deta², applied to x and to y. For the Winslow functional this finds the classical Winslow equations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy
from sympy import Expr, Symbol

from ..coordinates import FIRST_DERIVATIVES, METRIC, expand_metric, x_etaeta, x_xieta, x_xixi, y_etaeta, y_xieta, y_xixi


@dataclass(frozen=True, slots=True)
class Reduction:
    """The residual is `matrix` times `system`, and the matrix is not singular where J is not zero.

    Attributes:
        matrix: 2x2, in the first derivatives.
        determinant: of the matrix, simplified, in the metric symbols where they fit.
        operator: the coefficients (alpha, beta, gamma) of r_xixi, r_xieta and r_etaeta.
        system: the two equations for x and y.
    """

    matrix: sympy.Matrix
    determinant: Expr
    operator: tuple[Expr, Expr, Expr]
    system: tuple[Expr, Expr]


def find_reduction(coefficients: Mapping[Symbol, tuple[Expr, Expr]], rest: tuple[Expr, Expr]) -> Reduction | None:
    """Return the reduction to one scalar operator, or None where there is none."""
    if any(part != 0 for part in rest):
        return None
    pairs = ((x_xixi, y_xixi), (x_xieta, y_xieta), (x_etaeta, y_etaeta))
    matrices = [
        sympy.Matrix([[expand_metric(coefficients[second][row]) for second in pair] for row in (0, 1)])
        for pair in pairs
    ]
    leading = matrices[0]
    if not _proportional_at_a_point(matrices):
        return None
    corner = (0, 0) if leading[0, 0] != 0 else (0, 1)
    ratios = [sympy.cancel(matrix[corner] / leading[corner]) for matrix in matrices]
    for matrix, ratio in zip(matrices, ratios, strict=True):
        if any(sympy.cancel(entry) != 0 for entry in matrix - ratio * leading):
            return None
    scale = sympy.lcm_list([sympy.denom(ratio) for ratio in ratios])
    common = (leading / scale).applyfunc(lambda entry: sympy.factor(sympy.cancel(entry)))
    determinant = in_metric(sympy.factor(common.det()))
    if determinant == 0:
        return None
    operator = tuple(in_metric(sympy.expand(sympy.cancel(ratio * scale))) for ratio in ratios)
    system = tuple(
        sum((factor * pair[component] for factor, pair in zip(operator, pairs, strict=True)), sympy.S.Zero)
        for component in (0, 1)
    )
    return Reduction(common, determinant, (operator[0], operator[1], operator[2]), (system[0], system[1]))


def in_metric(expression: Expr) -> Expr:
    """Rewrite factors that are multiples of g11, g22, g12 or J in those symbols."""
    constant, factors = sympy.factor_list(sympy.numer(expression))
    below, factors_below = sympy.factor_list(sympy.denom(expression))
    result = constant / below
    for factor, power in factors:
        result *= _metric_multiple(factor) ** power
    for factor, power in factors_below:
        result /= _metric_multiple(factor) ** power
    return result


def _metric_multiple(factor: Expr) -> Expr:
    for name, meaning in METRIC.items():
        # Most factors are in other symbols, which is seen at once.
        if factor.free_symbols == meaning.free_symbols:
            ratio = sympy.cancel(factor / meaning)
            if ratio.is_number:
                return ratio * name
    return factor


def _proportional_at_a_point(matrices: list[sympy.Matrix]) -> bool:
    """Try the claim at one rational point before any algebra: most systems fail here at once."""
    point = dict(
        zip(
            FIRST_DERIVATIVES,
            (sympy.Rational(3, 2), sympy.Rational(1, 3), sympy.Rational(-2, 5), 2),
            strict=True,
        )
    )
    leading, *others = [matrix.subs(point) for matrix in matrices]
    if leading.is_zero_matrix:
        return False
    return all(sympy.Matrix([list(leading), list(other)]).rank() < 2 for other in others)
