"""A lower bound of a density where J > 0: the greatest one if it can be proved, else zero if that can."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import sympy
from sympy import Expr

from ...functionals.choices import branches
from ..coordinates import FIRST_DERIVATIVES, METRIC, chi, root, s, x_xi, y_eta, y_xi
from ..definiteness import is_nonnegative, without_functions

_p, _r = (sympy.Dummy(name, positive=True) for name in "pr")
_SEARCH_SIZES = (1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0)


@dataclass(frozen=True, slots=True)
class LowerBound:
    """What a density cannot go below where J > 0.

    Attributes:
        value: the bound; None if there is none, or if none is known.
        proof: `proved`; `refuted`: it is unbounded below, by scaling; `sampled`: no proof was found.
    """

    value: Expr | None
    proof: Literal["proved", "refuted", "sampled"]


def lower_bound(density: Expr, *, rotates: bool, degree: Expr | None) -> LowerBound:
    """Find a provable lower bound of a density where J > 0 (and s > 0), with numbers instead of parameters.

    Args:
        density: in the metric symbols.
        rotates: whether it is invariant under rotation, so that the frame with y_xi = 0, x_xi > 0 stands for all.
        degree: its degree of scaling, if it has one.
    """
    least = _smallest_sample(density)
    if least is None:
        return LowerBound(None, "sampled")
    if least < 0 and degree is not None and degree != 0:
        return LowerBound(None, "refuted")
    for candidate in dict.fromkeys((sympy.nsimplify(round(least, 6)), sympy.S.Zero)):
        if float(candidate) <= least + 1e-6 and _is_bounded(density, candidate, rotates=rotates):
            return LowerBound(candidate, "proved")
    return LowerBound(None, "sampled")


def _is_bounded(density: Expr, bound: Expr, *, rotates: bool) -> bool:
    """Return whether density - bound is a product of provably non-negative factors."""
    frame = {x_xi: _p, y_xi: 0, y_eta: _r} if rotates else {}
    above = (density - bound).subs(METRIC).subs(frame)
    # A density with comparisons is bounded if it is for every way to decide them.
    return any(all(map(_is_nonnegative, cases)) for cases in ([above], branches(above) or [above]))


def _is_nonnegative(expression: Expr) -> bool:
    rest, positive = without_functions(sympy.Matrix([[expression]]))
    allowed = (variable for variable in rest.free_symbols if variable.is_nonnegative)
    return is_nonnegative(rest[0], (_p, _r, s, chi, root, *positive, *allowed))


def _smallest_sample(density: Expr) -> float | None:
    """Return the smallest value at conformal maps and at random ones, of many sizes, with J > 0."""
    random = np.random.default_rng(0)
    jets = random.normal(size=(4, 2000))
    jets[2:] *= np.where(jets[0] * jets[3] - jets[1] * jets[2] < 0, -1, 1)
    angle = np.linspace(0, 2 * np.pi, 20)
    conformal = np.stack([np.cos(angle), np.sin(angle), -np.sin(angle), np.cos(angle)])
    points = np.concatenate([size * np.concatenate([jets, conformal], axis=1) for size in _SEARCH_SIZES], axis=1)
    others = sorted(density.subs(METRIC).free_symbols - set(FIRST_DERIVATIVES), key=str)
    evaluate = sympy.lambdify((*FIRST_DERIVATIVES, *others), density.subs(METRIC), "numpy")
    with np.errstate(all="ignore"):
        values = np.broadcast_to(evaluate(*points, *(1.0 for _ in others)), points.shape[1:])
    finite = values[np.isfinite(values)]
    return float(finite.min()) if finite.size else None
