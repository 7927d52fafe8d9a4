"""What random jets tell of the determinant of a principal symbol: its signs, its zeros, and where it is negative.

On the circle k = (cos(phi/2), sin(phi/2)) the entries of A are alpha + beta cos(phi) + gamma sin(phi), so that det A
has at most two minima and two maxima, which Newton's method finds from a grid of angles: a direction with det A = 0 is
not missed, as a random one would be.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import sympy
from numpy.typing import NDArray
from sympy import Expr, Symbol

from ..coordinates import (
    DEFINITIONS,
    FIRST_DERIVATIVES,
    METRIC,
    J,
    chi,
    epsilon,
    eta,
    expand_metric,
    root,
    s,
    x_eta,
    x_xi,
    xi,
    y_eta,
    y_xi,
)
from .principal_symbol import k1, k2

_ROUND_OFF = 1e-9
#: A minimum of |det A|/|A|² this small, at this share of the moderate jets, is a zero.
_ZERO, _SHARE = 1e-12, 0.1
#: Random jets: so many of moderate size and shape, then as many of any.
_JETS = 2000
SAMPLES = 2 * _JETS
_ANGLES = 64
_NEWTON_STEPS = 15

#: Symbols that are not negative, and not said to be so by their assumptions.
_POSITIVE = (s, epsilon, root, chi, xi, eta)

Type = Literal["elliptic", "weakly elliptic", "degenerate", "changing type"]


@dataclass(frozen=True, slots=True)
class Extremes:
    """The least and the greatest det A/|A|² over all k at each jet, the phi of the least, and the moderate jets."""

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
    return extremes(matrix).type


def extremes(matrix: sympy.Matrix) -> Extremes:
    """Return the extremes of det A over the circle of k at random jets with J > 0."""
    matrix = matrix.applyfunc(expand_metric)
    symbols = sorted({*FIRST_DERIVATIVES, *matrix.free_symbols} - {k1, k2}, key=str)
    jets = _random_jets(symbols)
    evaluate = sympy.lambdify((*symbols, k1, k2), [matrix[0, 0], matrix[0, 1], matrix[1, 1]], "numpy", cse=True)
    with np.errstate(all="ignore"):
        first, second, both = (
            np.stack([np.broadcast_to(entry, SAMPLES) for entry in evaluate(*jets, *k)])
            for k in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
        )
        # The entries of A at k = (cos(phi/2), sin(phi/2)): parts[0] + parts[1] cos(phi) + parts[2] sin(phi).
        parts = np.stack([(first + second) / 2, (first - second) / 2, (both - first - second) / 2])
        scale = np.abs(parts).sum(axis=0).max(axis=0)
        finite = np.isfinite(scale) & (scale < 1e50)
        parts = parts[:, :, finite] / np.where(scale > 0, scale, 1)[finite]
    least, angle = _minimum(parts, 1)
    greatest, _ = _minimum(parts, -1)
    return Extremes(symbols, jets[:, finite], least, -greatest, angle, (np.arange(SAMPLES) < _JETS)[finite])


def _random_jets(symbols: list[Symbol]) -> NDArray[np.float64]:
    """Return values of the symbols, one column for each jet: J > 0, and all else positive but places and fields."""
    random = np.random.default_rng(0)
    values = random.normal(size=(len(symbols), SAMPLES))
    for variable, row in zip(symbols, values, strict=True):
        if variable.is_positive or variable in _POSITIVE:
            np.abs(row, out=row)
    jacobian = random.normal(size=(2, 2, SAMPLES)) * np.exp(random.normal(size=SAMPLES))
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


def witness(matrix: sympy.Matrix, found: Extremes) -> tuple[tuple[Symbol, Expr], ...]:
    """Return the first of the lowest points, rounded to rationals, at which J > 0 and det A < 0 hold exactly."""
    lowest = np.argsort(found.least)[:50]
    phi, symbols = found.angle[lowest], [*found.symbols, k1, k2]
    points = np.concatenate([found.jets[:, lowest], 2 * np.stack([np.cos(phi / 2), np.sin(phi / 2)])])
    first, mixed, second = (expand_metric(matrix[place]) for place in ((0, 0), (0, 1), (1, 1)))
    evaluate = sympy.lambdify(symbols, first * second - mixed**2, "numpy", cse=True)
    for digits in (1, 10, 1000):
        whole = np.round(points * digits)
        with np.errstate(all="ignore"):
            below = np.broadcast_to(evaluate(*(whole / digits)) < 0, lowest.shape)
        for point in whole.T[below]:
            values = {variable: sympy.Rational(int(n), digits) for variable, n in zip(symbols, point, strict=True)}
            if any(values[v] <= 0 for v in symbols if v in _POSITIVE or v.is_positive):
                continue
            if METRIC[J].subs(values) > 0 and _determinant_at(matrix, values) < 0:
                return tuple(values.items())
    return ()


def _determinant_at(matrix: sympy.Matrix, values: dict[Symbol, Expr]) -> Expr:
    """Return det A at a point, exactly, or to 30 digits where the density has functions."""
    numbers = dict(values)
    for name, meaning in DEFINITIONS.items():
        if meaning.free_symbols <= numbers.keys():
            numbers[name] = meaning.xreplace(numbers)
    value = matrix.xreplace(numbers).det()
    return value if value.is_Rational else sympy.re(value.evalf(30))
