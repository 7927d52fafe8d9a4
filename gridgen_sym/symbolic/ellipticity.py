"""The principal symbol of the Euler–Lagrange equations and their type: elliptic, degenerate or of changing type.

A proof looks at one frame that stands for all: with v = k1 g1 + k2 g2 (not zero where J > 0 and k is not
zero), a rotation of the physical plane brings v to the x-axis, and then with real l, m > 0 and n > 0

    g1 = (m k1 - l k2, -n k2),   g2 = (m k2 + l k1, n k1),   J = m n |k|².

There the symbol's determinant is often a product of sums of squares, which proves that it is positive.

Without a proof, random jets decide. On the circle k = (cos(phi/2), sin(phi/2)) the entries of A are
alpha + beta cos(phi) + gamma sin(phi), so that det A has at most two minima and two maxima, which Newton's method
finds from a grid of angles: a direction with det A = 0 is not missed, as a random one would be.
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
from .definiteness import almost_everywhere, is_nonnegative, is_positive, without_functions
from .discrete import hessian

k1, k2 = symbol("k1"), symbol("k2")

_l, _t, _q = (sympy.Dummy(name, real=True) for name in "ltq")
_m, _n, _p, _r = (sympy.Dummy(name, positive=True) for name in "mnpr")
#: More operations than this in a matrix, and no proof is tried: it would take minutes.
_PROOF_LIMIT = 1200
_ROUND_OFF = 1e-9
#: A minimum of |det A|/|A|² this small, at this share of the moderate jets, is a zero.
_ZERO, _SHARE = 1e-12, 0.1
#: Random jets: so many of moderate size and shape, then as many of any.
_JETS = 2000
_ANGLES = 64
_NEWTON_STEPS = 15

Type = Literal["elliptic", "weakly elliptic", "degenerate", "changing type"]


@dataclass(frozen=True, slots=True)
class Ellipticity:
    """The type of the Euler–Lagrange equations where J > 0, and how it is known.

    Attributes:
        type: `elliptic`: det A(k) is not zero for any real k other than zero; `weakly elliptic`: it is nowhere
            negative but zero for some k; `degenerate`: it is zero for all k; `changing type`: it takes both signs.
        proof: `proved` by algebra; `refuted`: not elliptic, by the exact `witness`; `sampled` at random jets.
        witness: for `changing type`, rational values with J > 0 at which det A is negative.
        samples: number of random jets that were tried, each for all k.
    """

    type: Type
    proof: Literal["proved", "refuted", "sampled"]
    witness: tuple[tuple[Symbol, Expr], ...] = ()
    samples: int = 2 * _JETS


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


@dataclass(frozen=True, slots=True)
class _Extremes:
    """The least and the greatest det A/|A|² over all k at each jet, the k of the least, and where det A is zero."""

    symbols: list[Symbol]
    jets: NDArray[np.float64]
    least: NDArray[np.float64]
    greatest: NDArray[np.float64]
    angle: NDArray[np.float64]
    moderate: NDArray[np.bool_]

    @property
    def sign(self) -> int:
        """Return the sign of det A, if it has one."""
        return 1 if (self.greatest > _ROUND_OFF).any() else -1

    @property
    def type(self) -> Type:
        """Return the type that the jets show."""
        if not self.least.size:
            return "elliptic"
        positive, negative = bool((self.greatest > _ROUND_OFF).any()), bool((self.least < -_ROUND_OFF).any())
        if positive == negative:
            return "changing type" if positive else "degenerate"
        size = (self.least if positive else -self.greatest)[self.moderate]
        return "weakly elliptic" if size.size and (size <= _ZERO).mean() > _SHARE else "elliptic"


def sampled_type(matrix: sympy.Matrix) -> Type:
    """Return the type as random jets with J > 0 show it, without a proof: enough to choose a solver by."""
    return _extremes(matrix).type


def ellipticity(matrix: sympy.Matrix, *, rotates: bool, turns: bool, positive: tuple[Symbol, ...]) -> Ellipticity:
    """Decide the type of a principal symbol where J > 0.

    Args:
        matrix: the principal symbol; numbers instead of parameters.
        rotates: whether the density is invariant under rotation of the physical plane.
        turns: whether it is also invariant under rotation of (xi, eta), so that k = (1, 0) stands for all.
        positive: symbols with positive values, such as the weight.
    """
    found = _extremes(matrix)
    if not found.least.size:
        return Ellipticity("elliptic", "sampled", samples=0)
    if found.type == "changing type":
        witness = _witness(matrix, found)
        return Ellipticity("changing type", "refuted" if witness else "sampled", witness)
    charts = _charts(matrix, turns=turns) if rotates else _raw_charts(matrix)
    if charts is None:
        return Ellipticity(found.type, "sampled")
    if all(_is_constant(chart) for chart in charts):
        return Ellipticity(_exact_type(charts), "proved")
    return _proved(found, charts, positive)


def _proved(found: _Extremes, charts: list[Expr], positive: tuple[Symbol, ...]) -> Ellipticity:
    """Return what the factors of the charts prove, and else what the jets show."""
    signed = [(found.sign * chart, (*positive, *_positive_in(chart))) for chart in charts]
    if all(is_positive(chart, symbols) for chart, symbols in signed):
        return Ellipticity("elliptic", "proved")
    if any(_has_zero(chart) for chart in charts):
        known = all(is_nonnegative(chart, symbols) for chart, symbols in signed)
        return Ellipticity("weakly elliptic", "proved" if known else "sampled")
    return Ellipticity(found.type, "sampled")


def _is_constant(chart: Expr) -> bool:
    """Return whether a chart is a polynomial in t alone with rational coefficients."""
    return bool(
        chart.free_symbols <= {_t}
        and chart.is_polynomial(_t)
        and all(coefficient.is_Rational for coefficient in sympy.Poly(chart, _t).coeffs())
    )


def _exact_type(charts: list[Expr]) -> Type:
    """Return the type where the coefficients are constant, from the multiplicities of the real roots."""
    if all(chart == 0 for chart in charts):
        return "degenerate"
    _, factors = sympy.Poly(charts[0], _t).factor_list()
    multiplicities = [power for factor, power in factors if factor.count_roots()]
    if any(power % 2 for power in multiplicities):
        return "changing type"
    return "weakly elliptic" if multiplicities or any(chart == 0 for chart in charts) else "elliptic"


def _has_zero(chart: Expr) -> bool:
    """Return whether a chart is zero, or has a factor in t alone with a real root."""
    _, factors = sympy.factor_list(sympy.numer(chart))
    return chart == 0 or any(
        _is_constant(factor) and factor.has(_t) and sympy.Poly(factor, _t).count_roots() for factor, _ in factors
    )


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


def _extremes(matrix: sympy.Matrix) -> _Extremes:
    """Return the extremes of det A over the circle of k at random jets with J > 0."""
    matrix = expand_metric_of(matrix)
    symbols = sorted({*FIRST_DERIVATIVES, *matrix.free_symbols} - {k1, k2}, key=str)
    jets = _random_jets(symbols)
    evaluate = sympy.lambdify((*symbols, k1, k2), [matrix[0, 0], matrix[0, 1], matrix[1, 1]], "numpy", cse=True)
    with np.errstate(all="ignore"):
        first, second, both = (
            np.stack([np.broadcast_to(entry, 2 * _JETS) for entry in evaluate(*jets, *k)])
            for k in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
        )
        # The entries of A at k = (cos(phi/2), sin(phi/2)): parts[0] + parts[1] cos(phi) + parts[2] sin(phi).
        parts = np.stack([(first + second) / 2, (first - second) / 2, (both - first - second) / 2])
        scale = np.abs(parts).sum(axis=0).max(axis=0)
        finite = np.isfinite(scale) & (scale < 1e50)
        parts = parts[:, :, finite] / np.where(scale > 0, scale, 1)[finite]
    least, angle = _minimum(parts, 1)
    greatest, _ = _minimum(parts, -1)
    return _Extremes(symbols, jets[:, finite], least, -greatest, angle, (np.arange(2 * _JETS) < _JETS)[finite])


def _random_jets(symbols: list[Symbol]) -> NDArray[np.float64]:
    """Return values of the symbols, one column for each jet: J > 0, and all else positive."""
    random = np.random.default_rng(0)
    values = np.abs(random.normal(size=(len(symbols), 2 * _JETS)))
    jacobian = random.normal(size=(2, 2, 2 * _JETS)) * np.exp(random.normal(size=2 * _JETS))
    jacobian[:, 1] *= np.where(jacobian[0, 0] * jacobian[1, 1] < jacobian[0, 1] * jacobian[1, 0], -1, 1)
    # A conformal map of size 1, plus less than half of it in each of the two ways to be another one.
    angle, turn = random.uniform(0, 2 * np.pi, size=(2, _JETS))
    stretch, size = random.uniform(0, 0.5, size=_JETS), random.uniform(0.8, 1.25, size=_JETS)
    conformal = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    mirrored = np.array([[np.cos(turn), np.sin(turn)], [np.sin(turn), -np.cos(turn)]])
    jacobian[:, :, :_JETS] = size * (conformal + stretch * mirrored)
    for variable, row in zip((x_xi, x_eta, y_xi, y_eta), jacobian.reshape(4, -1), strict=True):
        values[symbols.index(variable)] = row
    return values


def _minimum(parts: NDArray[np.float64], sign: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the minimum of sign * det A over phi at each jet, and the phi, by Newton's method from two angles."""
    grid = np.linspace(0, 2 * np.pi, _ANGLES, endpoint=False)[:, None]
    values = sign * _determinants(parts, grid)[0]
    valley = (values <= np.roll(values, 1, axis=0)) & (values <= np.roll(values, -1, axis=0))
    phi = grid[np.where(valley, values, np.inf).argsort(axis=0)[:2], 0]
    best, where = np.full(phi.shape, np.inf), phi
    for _ in range(_NEWTON_STEPS):
        value, slope, bend = (sign * part for part in _determinants(parts, phi))
        best, where = np.minimum(best, value), np.where(value < best, phi, where)
        step = np.divide(slope, np.abs(bend), out=np.zeros_like(slope), where=np.abs(bend) > np.abs(slope))
        phi = phi - step
    lower = best.argmin(axis=0)[None]
    return np.take_along_axis(best, lower, 0)[0], np.take_along_axis(where, lower, 0)[0]


def _determinants(parts: NDArray[np.float64], phi: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Return det A and its first and second derivative in phi; A is symmetric."""
    cos, sin = np.cos(phi), np.sin(phi)
    (a, b, d) = (parts[0, i] + parts[1, i] * cos + parts[2, i] * sin for i in range(3))
    (a1, b1, d1) = (parts[2, i] * cos - parts[1, i] * sin for i in range(3))
    (a2, b2, d2) = (parts[0, i] - entry for i, entry in enumerate((a, b, d)))
    return a * d - b * b, a1 * d + a * d1 - 2 * b * b1, a2 * d + 2 * a1 * d1 + a * d2 - 2 * (b1 * b1 + b * b2)


def expand_metric_of(matrix: sympy.Matrix) -> sympy.Matrix:
    """Return the matrix with the metric written out in every entry."""
    return matrix.applyfunc(expand_metric)


def _witness(matrix: sympy.Matrix, found: _Extremes) -> tuple[tuple[Symbol, Expr], ...]:
    """Return the first of the lowest points, rounded to rationals, at which J > 0 and det A < 0 hold exactly."""
    lowest = np.argsort(found.least)[:50]
    phi, symbols = found.angle[lowest], [*found.symbols, k1, k2]
    points = np.concatenate([found.jets[:, lowest], 2 * np.stack([np.cos(phi / 2), np.sin(phi / 2)])])
    matrix = expand_metric_of(matrix)
    evaluate = sympy.lambdify(symbols, matrix[0, 0] * matrix[1, 1] - matrix[0, 1] ** 2, "numpy", cse=True)
    for digits in (1, 10, 1000):
        whole = np.round(points * digits)
        with np.errstate(all="ignore"):
            below = np.broadcast_to(evaluate(*(whole / digits)) < 0, lowest.shape)
        for point in whole.T[below]:
            values = {variable: sympy.Rational(int(n), digits) for variable, n in zip(symbols, point, strict=True)}
            if any(values[s] <= 0 for s in symbols if s not in (*FIRST_DERIVATIVES, k1, k2)):
                continue
            if METRIC[J].subs(values) > 0 and _determinant_at(matrix, values) < 0:
                return tuple(values.items())
    return ()


def _determinant_at(matrix: sympy.Matrix, values: dict[Symbol, Expr]) -> Expr:
    """Return det A at a point, exactly, or to 30 digits where the density has functions."""
    value = matrix.subs(values).det()
    return value if value.is_Rational else sympy.re(value.evalf(30))
