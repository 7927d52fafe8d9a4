"""The principal symbol of the Euler–Lagrange equations and their type: elliptic, degenerate or of changing type.

A proof looks at one frame that stands for all: with v = k1 g1 + k2 g2 (not zero where J > 0 and k is not
zero), a rotation of the physical plane brings v to the x-axis, and then with real l, m > 0 and n > 0

    g1 = (m k1 - l k2, -n k2),   g2 = (m k2 + l k1, n k1),   J = m n |k|².

There the symbol's determinant is often a product of sums of squares, which proves that it is positive.

Without a proof, random jets decide (`random_jets`). Where comparisons choose between branches, the equations of every
branch must be of the type that is proved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import sympy
from sympy import Expr, Symbol

from ...functionals.choices import CHOICES, branches
from ..coordinates import METRIC, J, epsilon, x_eta, x_xi, y_eta, y_xi
from ..definiteness import is_nonnegative, is_positive, without_functions, without_square_roots
from .frame_determinant import frame_determinant
from .principal_symbol import is_large, k1, k2
from .random_jets import SAMPLES, Extremes, Type, extremes, witness

_l, _t = (sympy.Dummy(name, real=True) for name in "lt")
_m, _n = (sympy.Dummy(name, positive=True) for name in "mn")


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
    samples: int = SAMPLES

    @property
    def how_known(self) -> str:
        """How the type is known, in words: what is refuted is that the equations are elliptic."""
        return "shown by an exact witness" if self.proof == "refuted" else self.proof


def ellipticity(matrix: sympy.Matrix, *, rotates: bool, turns: bool, positive: tuple[Symbol, ...]) -> Ellipticity:
    """Decide the type of a principal symbol where J > 0.

    Args:
        matrix: the principal symbol; numbers instead of parameters.
        rotates: whether the density is invariant under rotation of the physical plane.
        turns: whether it is also invariant under rotation of (xi, eta), so that k = (1, 0) stands for all.
        positive: symbols with positive values, such as the weight.
    """
    found = extremes(matrix)
    if not found.least.size:
        return Ellipticity("elliptic", "sampled", samples=0)
    if found.type == "changing type":
        point = witness(matrix, found)
        return Ellipticity("changing type", "refuted" if point else "sampled", point)
    if matrix.has(*CHOICES):
        parts = [ellipticity(part, rotates=rotates, turns=turns, positive=positive) for part in branches(matrix) or ()]
        proved = all(part.type == found.type and part.proof == "proved" for part in parts)
        return Ellipticity(found.type, "proved" if parts and proved else "sampled")
    charts = _charts(matrix, turns=turns) if rotates else _raw_charts(matrix)
    if charts is None:
        return Ellipticity(found.type, "sampled")
    if all(_is_constant(chart) for chart in charts):
        return Ellipticity(_exact_type(charts), "proved")
    return _proved(found, charts, positive)


def proved_by_operator(
    found: Ellipticity, determinant: Expr, discriminant: Expr, positive: tuple[Symbol, ...]
) -> Ellipticity:
    """Return what a scalar operator proves of a type that was sampled: det A = det M (alpha k1² + ... + gamma k2²)².

    Args:
        found: by other means.
        determinant: of the matrix M before the operator, in the metric.
        discriminant: of the operator, 4 alpha gamma - beta², in the metric.
        positive: symbols with positive values, such as the weight.
    """
    if found.type != "elliptic" or found.proof != "sampled":
        return found
    jacobian = sympy.Dummy("J", positive=True)
    signs = [without_square_roots(part.subs(J, jacobian)) for part in (determinant, discriminant)]
    known = (*positive, *_positive_in(signs[0]), *_positive_in(signs[1]))
    return Ellipticity("elliptic", "proved") if all(is_positive(part, known) for part in signs) else found


def _proved(found: Extremes, charts: list[Expr], positive: tuple[Symbol, ...]) -> Ellipticity:
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


def _charts(matrix: sympy.Matrix, *, turns: bool) -> list[Expr] | None:
    """Return the determinant in the frame of this module, for k = (1, 0), or for k = (1, t) and (0, 1)."""
    if is_large(matrix) or matrix.has(epsilon):
        return None
    directions = [(sympy.S.One, sympy.S.Zero)] if turns else [(sympy.S.One, _t), (sympy.S.Zero, sympy.S.One)]
    charts: list[Expr | None] = []
    for a, b in directions:
        frame = {x_xi: _m * a - _l * b, x_eta: _m * b + _l * a, y_xi: -_n * b, y_eta: _n * a}
        charts.append(_determinant_of(matrix.xreplace({k1: a, k2: b}), frame))
    return _if_all_known(charts)


def _raw_charts(matrix: sympy.Matrix) -> list[Expr] | None:
    """Return the determinant for k = (1, t) and (0, 1) without any frame, for densities that do not rotate."""
    if is_large(matrix) or matrix.has(epsilon):
        return None
    directions = ((sympy.S.One, _t), (sympy.S.Zero, sympy.S.One))
    return _if_all_known([_determinant_of(matrix.xreplace({k1: a, k2: b}), {}) for a, b in directions])


def _if_all_known(charts: list[Expr | None]) -> list[Expr] | None:
    known = [chart for chart in charts if chart is not None]
    return known if len(known) == len(charts) else None


def _determinant_of(matrix: sympy.Matrix, frame: dict[Symbol, Expr]) -> Expr | None:
    rational, _ = without_functions(matrix.xreplace(dict(METRIC)).xreplace(frame))
    return frame_determinant(rational, {})
