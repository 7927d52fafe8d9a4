"""Find out whether a quasilinear system is a non-singular matrix times a simpler system.

If the three 2x2 coefficient matrices of r_xixi, r_xieta, r_etaeta (r = x, y) are multiples of one matrix M, the system
is M times the scalar operator alpha d²/dxi² + beta d²/dxideta + gamma d²/deta², applied to x and to y, plus a vector w
of lower order. It is simpler where w is one of

- zero: for the Winslow functional this finds the classical Winslow equations;
- a r_xi + b r_eta, with a and b in the metric and values: P = a/alpha and Q = b/gamma are control functions;
- in J and values: that of a harmonic map, with a monitor that is a function of x and y.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy
from sympy import Expr, Symbol

from ..coordinates import (
    DEFINITIONS,
    FIRST_DERIVATIVES,
    expand_metric,
    x_eta,
    x_etaeta,
    x_xi,
    x_xieta,
    x_xixi,
    y_eta,
    y_etaeta,
    y_xi,
    y_xieta,
    y_xixi,
)
from .in_metric import in_metric, written_in_metric
from .rational import RationalArithmetic

_PAIRS = ((x_xixi, y_xixi), (x_xieta, y_xieta), (x_etaeta, y_etaeta))


@dataclass(frozen=True, slots=True)
class ScalarOperator:
    """The second-order part of the residual is `matrix` times one operator, the same for x and y.

    Attributes:
        matrix: 2x2, in the first derivatives.
        determinant: of the matrix, simplified, in the metric symbols where they fit.
        coefficients: (alpha, beta, gamma), of r_xixi, r_xieta and r_etaeta.
        discriminant: 4 alpha gamma - beta²: the operator is elliptic where it is positive.
        arithmetic: in which it was found.
        entries: those of the matrix, as quotients in `arithmetic`.
    """

    matrix: sympy.Matrix
    determinant: Expr
    coefficients: tuple[Expr, Expr, Expr]
    discriminant: Expr
    arithmetic: RationalArithmetic
    entries: tuple[Any, Any, Any, Any]


@dataclass(frozen=True, slots=True)
class Reduction:
    """The residual is a matrix times `system`, and the matrix is not singular where J is not zero.

    Attributes:
        operator: the matrix, and the coefficients of second derivatives.
        first_order: the coefficients (a, b) of r_xi and r_eta; None where what is of lower order is no such sum.
        system: the two equations for x and y.
    """

    operator: ScalarOperator
    first_order: tuple[Expr, Expr] | None
    system: tuple[Expr, Expr]

    @property
    def control(self) -> tuple[Expr, Expr] | None:
        """The control functions P = a/alpha and Q = b/gamma; None where there are none."""
        if self.first_order is None or self.first_order == (0, 0):
            return None
        alpha, _, gamma = self.operator.coefficients
        first, second = (
            sympy.Add(*(term / coefficient for term in sympy.Add.make_args(sympy.expand(part))))
            for part, coefficient in zip(self.first_order, (alpha, gamma), strict=True)
        )
        return first, second

    def with_control(self, along_xi: Expr, along_eta: Expr) -> Reduction:
        """Return the same system with control functions P and Q, in terms alpha P r_xi and gamma Q r_eta."""
        alpha, _, gamma = self.operator.coefficients
        added = alpha * along_xi, gamma * along_eta
        first, second = (
            part + added[0] * one + added[1] * other
            for part, (one, other) in zip(self.system, ((x_xi, x_eta), (y_xi, y_eta)), strict=True)
        )
        of_first_order = None
        if self.first_order is not None:
            of_first_order = self.first_order[0] + added[0], self.first_order[1] + added[1]
        return Reduction(self.operator, of_first_order, (first, second))


def find_scalar_operator(
    coefficients: Mapping[Symbol, tuple[Expr, Expr]], rest: tuple[Expr, Expr]
) -> ScalarOperator | None:
    """Return the scalar operator of the second-order part, or None where there is none.

    Args:
        coefficients: of every second derivative, in both residuals.
        rest: of the residuals, of lower order; the operator's arithmetic can represent it.
    """
    matrices = [[coefficients[second][row] for row in (0, 1) for second in pair] for pair in _PAIRS]
    if not _proportional_at_a_point(matrices):
        return None
    arithmetic = RationalArithmetic([*(entry for matrix in matrices for entry in matrix), *rest])
    leading, *_ = elements = [[arithmetic.element(entry) for entry in matrix] for matrix in matrices]
    corner = 0 if leading[0] else 1
    ratios = [matrix[corner] / leading[corner] for matrix in elements]
    for matrix, ratio in zip(elements, ratios, strict=True):
        if any(a != ratio * b for a, b in zip(matrix, leading, strict=True)):
            return None
    scale = arithmetic.least_common_multiple(ratio.denom for ratio in ratios)
    xx, xy, yx, yy = (entry / scale for entry in leading)
    determinant = xx * yy - xy * yx
    if not determinant:
        return None
    alpha, beta, gamma = (ratio * scale for ratio in ratios)
    expression = arithmetic.expression
    return ScalarOperator(
        matrix=sympy.Matrix(2, 2, [sympy.factor(expression(entry)) for entry in (xx, xy, yx, yy)]),
        determinant=in_metric(sympy.factor(expression(determinant))),
        coefficients=tuple(in_metric(sympy.expand(expression(part))) for part in (alpha, beta, gamma)),
        discriminant=in_metric(sympy.factor(expression(4 * alpha * gamma - beta**2))),
        arithmetic=arithmetic,
        entries=(xx, xy, yx, yy),
    )


def find_reduction(
    operator: ScalarOperator | None, rest: tuple[Expr, Expr], slopes: Sequence[Symbol] = ()
) -> Reduction | None:
    """Return the reduction to one scalar operator, or None where there is none.

    Args:
        operator: of the second-order part.
        rest: of the residuals, of lower order.
        slopes: the derivatives of values, in which the rest is linear.
    """
    if operator is None:
        return None
    xx, xy, yx, yy = operator.entries
    determinant = xx * yy - xy * yx
    first, second = (operator.arithmetic.element(part) for part in rest)
    lower = (yy * first - xy * second) / determinant, (xx * second - yx * first) / determinant
    found = _lower_order(operator.arithmetic, lower, slopes)
    if found is None:
        return None
    first_order, added = found
    one, other = (
        sum((factor * pair[row] for factor, pair in zip(operator.coefficients, _PAIRS, strict=True)), added[row])
        for row in (0, 1)
    )
    return Reduction(operator, first_order, (one, other))


def _lower_order(
    arithmetic: RationalArithmetic, lower: tuple[Any, Any], slopes: Sequence[Symbol]
) -> tuple[tuple[Expr, Expr] | None, tuple[Expr, Expr]] | None:
    """Return (a, b), if there are, and a vector of lower order in a simple form; None where it has none."""
    if not any(lower):
        return (sympy.S.Zero, sympy.S.Zero), (sympy.S.Zero, sympy.S.Zero)

    def written(first: Any, second: Any) -> tuple[Expr, Expr] | None:  # noqa: ANN401 - quotients of `arithmetic`
        one = written_in_metric(arithmetic.expression(first), slopes)
        other = None if one is None else written_in_metric(arithmetic.expression(second), slopes)
        return None if one is None or other is None else (one, other)

    plain = written(*lower)
    if plain is not None:
        return None, plain
    g1, g2 = [[arithmetic.element(p) for p in pair] for pair in ((x_xi, y_xi), (x_eta, y_eta))]
    jacobian = g1[0] * g2[1] - g2[0] * g1[1]
    a, b = g2[1] * lower[0] - g2[0] * lower[1], g1[0] * lower[1] - g1[1] * lower[0]
    along = written(a / jacobian, b / jacobian)
    if along is None:
        return None
    return along, (along[0] * x_xi + along[1] * x_eta, along[0] * y_xi + along[1] * y_eta)


def _proportional_at_a_point(matrices: list[list[Expr]]) -> bool:
    """Try the claim at one point before any algebra: most systems fail here at once."""
    point: dict[Expr, Expr] = dict(
        zip(
            FIRST_DERIVATIVES,
            (sympy.Rational(3, 2), sympy.Rational(1, 3), sympy.Rational(-2, 5), sympy.Integer(2)),
            strict=True,
        )
    )
    present: set[Symbol] = set().union(*(entry.free_symbols for matrix in matrices for entry in matrix))
    others = sorted(present - point.keys() - DEFINITIONS.keys(), key=str)
    point |= {symbol: sympy.Rational(i + 3, 2 * i + 5) for i, symbol in enumerate(others)}
    for symbol in DEFINITIONS:
        point[symbol] = expand_metric(symbol).subs(point)
    leading, *rest = [[sympy.N(entry.xreplace(point), 30) for entry in matrix] for matrix in matrices]
    if not all(entry.is_finite for entries in (leading, *rest) for entry in entries):
        return False  # Nothing is known at this point.
    size = max(map(abs, leading))
    return bool(size) and all(
        abs(leading[i] * other[j] - leading[j] * other[i]) <= 1e-20 * size * max(map(abs, other))
        for other in rest
        for i in range(4)
        for j in range(i)
    )
