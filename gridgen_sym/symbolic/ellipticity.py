"""The principal symbol of the Euler–Lagrange equations and their type: elliptic, degenerate or of changing type.

A proof looks at one frame that stands for all: with v = k1 g1 + k2 g2 (not zero where J > 0 and k is not
zero), a rotation of the physical plane brings v to the x-axis, and then with real l, m > 0 and n > 0

    g1 = (m k1 - l k2, -n k2),   g2 = (m k2 + l k1, n k1),   J = m n |k|².

There the symbol's determinant is often a product of sums of squares, which proves that it is positive.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import sympy
from numpy.typing import NDArray
from sympy import Expr, Symbol

from ..functionals.metric import symbol
from .coordinates import FIRST_DERIVATIVES, METRIC, J, epsilon, expand_metric, g11, g12, g22, x_eta, x_xi, y_eta, y_xi
from .definiteness import SAMPLES, almost_everywhere, is_nonnegative, is_positive, without_functions
from .discrete import hessian

k1, k2 = symbol("k1"), symbol("k2")

_l, _t, _q = (sympy.Dummy(name, real=True) for name in "ltq")
_m, _n, _p, _r = (sympy.Dummy(name, positive=True) for name in "mnpr")
#: More operations than this in a matrix, and no proof is tried: it would take minutes.
_PROOF_LIMIT = 1200
_ROUND_OFF = 1e-9

Type = Literal["elliptic", "weakly elliptic", "degenerate", "changing type"]


@dataclass(frozen=True, slots=True)
class Ellipticity:
    """The type of the Euler–Lagrange equations where J > 0, and how it is known.

    Attributes:
        type: `elliptic`: det A(k) is not zero for any real k other than zero; `weakly elliptic`: it is nowhere
            negative but zero for some k; `degenerate`: it is zero for all k; `changing type`: it takes both signs.
        proof: `proved` by algebra; `refuted`: not elliptic, by the exact `witness`; `sampled` at random points.
        witness: for `changing type`, rational values with J > 0 at which det A is negative.
        samples: number of random points that were tried.
    """

    type: Type
    proof: Literal["proved", "refuted", "sampled"]
    witness: tuple[tuple[Symbol, Expr], ...] = ()
    samples: int = SAMPLES


def principal_symbol(density: Expr) -> sympy.Matrix:
    """Return A(k)_ij = sum over a, b of d²F/dp^i_a dp^j_b k_a k_b, with i, j in (x, y) and a, b in (xi, eta)."""
    slope = almost_everywhere(hessian(density))
    return sympy.Matrix(
        2,
        2,
        lambda i, j: slope[i, j] * k1**2 + (slope[i, 2 + j] + slope[2 + i, j]) * k1 * k2 + slope[2 + i, 2 + j] * k2**2,
    )


def determinant(matrix: sympy.Matrix, *, rotates: bool) -> Expr:
    """Return the determinant of a principal symbol, in the metric symbols where it can be written in them.

    Args:
        matrix: the principal symbol.
        rotates: whether the density is invariant under rotation, so that the frame with y_xi = 0 stands for all.
    """
    if not rotates or _is_large(matrix) or matrix.has(epsilon) or without_functions(matrix)[0] != matrix:
        return matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    framed = matrix.subs(METRIC).subs({x_xi: _p, x_eta: _q, y_xi: 0, y_eta: _r}).applyfunc(sympy.cancel)
    value = in_invariants(sympy.factor(framed.det()))
    return matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0] if value is None else value


def in_invariants(framed: Expr) -> Expr | None:
    """Rewrite an expression of the frame g1 = (p, 0), g2 = (q, r) in g11, g22, g12 and J; None if it is impossible."""
    above, below = framed.as_numer_denom()
    constant, factors = sympy.factor_list(above)
    constant_below, factors_below = sympy.factor_list(below)
    result, power_of_p = constant / constant_below, 0
    for factor, power in (*factors, *((factor, -power) for factor, power in factors_below)):
        if factor == _p:
            power_of_p += power
        elif factor == _q:  # q = g12/p and r = J/p: p must come out in even powers at the end
            result, power_of_p = result * g12**power, power_of_p - power
        elif factor == _r:
            result, power_of_p = result * J**power, power_of_p - power
        else:
            result *= _reduce(factor) ** power
    result *= g11 ** sympy.Rational(power_of_p, 2)
    return None if power_of_p % 2 or result.has(_p, _q, _r) else result


def _reduce(polynomial: Expr) -> Expr:
    """Return the polynomial modulo what the metric stands for, lowest in p, q and r."""
    others = sorted({k1, k2} | polynomial.free_symbols - {_p, _q, _r}, key=str)
    terms = [
        (sympy.prod(v**n for v, n in zip(others, powers, strict=True)), part)
        for powers, part in sympy.Poly(polynomial, *others).terms()
    ]
    return sum((_metric_basis().reduce(part)[1] * monomial for monomial, part in terms), sympy.S.Zero)


@lru_cache(maxsize=1)
def _metric_basis() -> sympy.polys.polytools.GroebnerBasis:
    relations = [_p**2 - g11, _p * _q - g12, _q**2 + _r**2 - g22, _p * _r - J]
    return sympy.groebner(relations, _p, _q, _r, J, g12, g11, g22, order="lex")


def sampled_type(matrix: sympy.Matrix) -> Type:
    """Return the type as random points with J > 0 show it, without a proof: enough to choose a solver by."""
    values, _, _ = _sample(matrix)
    positive, negative = bool((values > _ROUND_OFF).any()), bool((values < -_ROUND_OFF).any())
    if positive and negative:
        return "changing type"
    return "elliptic" if positive or negative or not values.size else "degenerate"


def ellipticity(matrix: sympy.Matrix, *, rotates: bool, turns: bool, positive: tuple[Symbol, ...]) -> Ellipticity:
    """Decide the type of a principal symbol where J > 0.

    Args:
        matrix: the principal symbol; numbers instead of parameters.
        rotates: whether the density is invariant under rotation of the physical plane.
        turns: whether it is also invariant under rotation of (xi, eta), so that k = (1, 0) stands for all.
        positive: symbols with positive values, such as the weight.
    """
    values, points, symbols = _sample(matrix)
    signs = {sign for sign in (-1, 1) if (sign * values > _ROUND_OFF).any()}
    if not signs and not values.size:
        return Ellipticity("elliptic", "sampled", samples=0)
    if len(signs) == 2:
        witness = _witness(matrix, symbols, points[:, np.argsort(values)[:50]])
        return Ellipticity("changing type", "refuted" if witness else "sampled", witness)
    charts = _charts(matrix, turns=turns) if rotates else _raw_charts(matrix)
    if not signs:
        zero = charts is not None and all(chart == 0 for chart in charts)
        return Ellipticity("degenerate", "proved" if zero else "sampled")
    if charts is None:
        return Ellipticity("elliptic", "sampled")
    sign = signs.pop()
    proved = [_is_positive(sign * chart, positive) for chart in charts]
    if any(chart == 0 for chart in charts):
        known = all(is_nonnegative(sign * chart, (*positive, *_positive_in(chart))) for chart in charts)
        return Ellipticity("weakly elliptic", "proved" if known else "sampled")
    return Ellipticity("elliptic", "proved" if all(proved) else "sampled")


def _is_positive(chart: Expr, positive: tuple[Symbol, ...]) -> bool:
    if chart.free_symbols <= {_t} and sympy.Poly(chart, _t).count_roots() == 0:
        return bool(chart.subs(_t, 0) > 0)
    return is_positive(chart, (*positive, *_positive_in(chart)))


def _positive_in(expression: Expr) -> tuple[Symbol, ...]:
    return tuple(variable for variable in expression.free_symbols if variable.is_positive)


def _is_large(matrix: sympy.Matrix) -> bool:
    """Return whether algebra would take minutes: too many operations, or roots, which stand-ins multiply."""
    roots = any(not power.exp.is_Integer for power in matrix.atoms(sympy.Pow))
    return roots or bool(sympy.count_ops(matrix) > _PROOF_LIMIT)


def _charts(matrix: sympy.Matrix, *, turns: bool) -> list[Expr] | None:
    """Return the determinant in the frame of this module, for k = (1, 0), or for k = (1, t) and (0, 1)."""
    if _is_large(matrix) or matrix.has(epsilon):
        return None
    directions = [(sympy.S.One, sympy.S.Zero)] if turns else [(sympy.S.One, _t), (sympy.S.Zero, sympy.S.One)]
    charts = []
    for a, b in directions:
        frame = {x_xi: _m * a - _l * b, x_eta: _m * b + _l * a, y_xi: -_n * b, y_eta: _n * a}
        charts.append(_determinant_of(matrix.subs({k1: a, k2: b}).subs(METRIC).subs(frame)))
    return charts


def _raw_charts(matrix: sympy.Matrix) -> list[Expr] | None:
    """Return the determinant for k = (1, t) and (0, 1) without any frame, for densities that do not rotate."""
    if _is_large(matrix) or matrix.has(epsilon):
        return None
    directions = ((sympy.S.One, _t), (sympy.S.Zero, sympy.S.One))
    return [_determinant_of(matrix.subs({k1: a, k2: b}).subs(METRIC)) for a, b in directions]


def _determinant_of(matrix: sympy.Matrix) -> Expr:
    rational, _ = without_functions(matrix)
    return sympy.factor(rational.applyfunc(sympy.cancel).det())


def _sample(matrix: sympy.Matrix) -> tuple[NDArray[np.float64], NDArray[np.float64], list[Symbol]]:
    """Return det A relative to |A|² at random points with J > 0, the points, and their symbols."""
    symbols = sorted({*FIRST_DERIVATIVES, *expand_metric_of(matrix).free_symbols, k1, k2}, key=str)
    random = np.random.default_rng(0)
    points = random.normal(size=(len(symbols), SAMPLES))
    row = {str(variable): points[i] for i, variable in enumerate(symbols)}
    for variable, values in zip(symbols, points, strict=True):
        if variable not in (*FIRST_DERIVATIVES, k1, k2):
            np.abs(values, out=values)
    folded = row["x_xi"] * row["y_eta"] < row["x_eta"] * row["y_xi"]
    size = np.exp(random.normal(size=SAMPLES))
    for name in ("x_xi", "y_xi", "x_eta", "y_eta"):
        row[name] *= np.where(folded & name.endswith("_eta"), -size, size) if name.endswith("_eta") else size
    with np.errstate(all="ignore"):
        evaluate = sympy.lambdify(symbols, list(expand_metric_of(matrix)), "numpy", cse=True)
        a, b, c, d = (np.broadcast_to(entry, SAMPLES) for entry in evaluate(*points))
        scale = np.maximum(np.maximum(np.abs(a), np.abs(d)), np.abs(b)) ** 2
        relative = (a * d - b * c) / np.where(scale > 0, scale, 1)
    finite = np.isfinite(relative) & (scale < 1e100)
    return relative[finite], points[:, finite], symbols


def expand_metric_of(matrix: sympy.Matrix) -> sympy.Matrix:
    """Return the matrix with the metric written out in every entry."""
    return matrix.applyfunc(expand_metric)


def _witness(
    matrix: sympy.Matrix, symbols: list[Symbol], points: NDArray[np.float64]
) -> tuple[tuple[Symbol, Expr], ...]:
    """Return the first of the points, rounded to rationals, at which J > 0 and det A < 0 hold exactly."""
    for digits in (1, 10, 1000):
        for point in points.T:
            values = {s: sympy.Rational(round(float(v) * digits), digits) for s, v in zip(symbols, point, strict=True)}
            if any(values[s] <= 0 for s in symbols if s not in (*FIRST_DERIVATIVES, k1, k2)):
                continue
            if METRIC[J].subs(values) > 0 and _determinant_at(matrix, values) < 0:
                return tuple(values.items())
    return ()


def _determinant_at(matrix: sympy.Matrix, values: dict[Symbol, Expr]) -> Expr:
    """Return det A at a point, exactly, or to 30 digits where the density has functions."""
    value = expand_metric_of(matrix).subs(values).det()
    return value if value.is_Rational else sympy.re(value.evalf(30))
