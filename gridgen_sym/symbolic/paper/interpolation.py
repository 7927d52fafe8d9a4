"""Decide what the paper says of transfinite interpolation."""

from __future__ import annotations

import sympy
from sympy import Expr

from ...functionals.paper import PrintedEquation
from ..coordinates import eta, xi
from .comparison import agreement
from .errata import Finding

#: The coordinate y of a lower side with a kink at xi = 1/2; the other sides are those of the unit square.
_KINKED = sympy.Rational(1, 4) - sympy.Abs(xi - sympy.Rational(1, 2)) / 2


def transfinite(bottom: Expr, top: Expr, left: Expr, right: Expr) -> Expr:
    """Interpolate a coordinate linearly between the four sides: `bottom` and `top` in xi, `left` and `right` in eta."""
    corners = (1 - xi) * ((1 - eta) * bottom.subs(xi, 0) + eta * top.subs(xi, 0))
    corners += xi * ((1 - eta) * bottom.subs(xi, 1) + eta * top.subs(xi, 1))
    return (1 - eta) * bottom + eta * top + (1 - xi) * left + xi * right - corners


def compare_interpolation(printed: PrintedEquation) -> Finding:
    """Decide whether the interpolation carries a jump of the slope at the boundary to the lines inside."""
    del printed  # It names nothing: there is one interpolation.
    return carried_jump(transfinite(_KINKED, sympy.S.One, eta, eta))


def carried_jump(coordinate: Expr) -> Finding:
    """Compare the jump of a coordinate's slope at xi = 1/2, on the lines eta = constant, with that at eta = 0."""
    slope = sympy.diff(coordinate, xi)
    above, below = (sympy.limit(slope, xi, sympy.Rational(1, 2), side) for side in "+-")
    jump = sympy.expand(above - below)
    fraction = sympy.cancel(jump / jump.subs(eta, 0))
    text = f"the slope jumps on the line eta by {fraction} times its jump at the side eta = 0"
    if fraction == 0 or fraction.subs(eta, sympy.Rational(1, 2)) == 0:
        return Finding(False, "claim refuted", "other", sympy.S.Zero, text)
    return agreement(text)
