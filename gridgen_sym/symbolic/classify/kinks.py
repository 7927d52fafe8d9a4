"""Find where a density has no continuous first derivative although J > 0: kinks, jumps, and roots that vanish.

Kinks are those of abs(), max() and min(), jumps those of sign(); where() may have either.

Classification and equations hold away from these places. A minimum may sit in a kink, and then need not solve the
equations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import sympy
from sympy import Expr, Symbol

from ...arrays import Array
from ...functionals.smoothness import rough_part
from ..coordinates import FIRST_DERIVATIVES, METRIC, J, expand_metric
from ..definiteness import almost_everywhere
from ..ties import turning, zeros_between

#: Pairs of corners with J > 0 on whose connecting lines zeros are looked for.
_LINES = 200
#: Distances from the zero on both sides, along the line: where a jump is measured, and where the slopes beside which
#: it counts are; the least jump beside them.
_NEAR, _FAR, _JUMP = 1e-7, 1e-2, 1e-4
_SIZES = (0.1, 0.3, 1.0, 3.0, 10.0)


def kinks(density: Expr, values: Mapping[Symbol, float] | None = None) -> tuple[Expr, ...]:
    """Return expressions at whose zeros the first derivatives of the density jump or do not exist, where J > 0.

    They are found numerically: zeros of arguments of abs() and sign(), and ties of comparisons, on lines between random
    corners, across which the value or a slope jumps; and roots, acos() and asin() without a derivative where cells are
    square or rectangular.

    Args:
        density: in the metric symbols, parameters, and what else it names.
        values: numbers at which parameters, fields and so on are judged, 1 without one. What is returned is in symbols.
    """
    others = sorted(density.free_symbols - {*METRIC, *FIRST_DERIVATIVES}, key=str)
    numbers = {one: sympy.nsimplify((values or {}).get(one, 1), rational=True) for one in others}
    judged = density.subs(numbers)
    ends = _corners(2 * _LINES)
    first, last = ends[:, :_LINES], ends[:, _LINES:]
    found = [part for part in turning(density) if _jumps(judged, part.subs(numbers), first, last)]
    rough = rough_part(density, _regular_corners(), {str(one): float(number) for one, number in numbers.items()})
    if rough is not None and rough.order == 1:
        found.append(_singular(rough.part))
    return tuple(dict.fromkeys(found))


def _singular(part: Expr) -> Expr:
    """Return an expression at whose zeros a part has no derivative."""
    if isinstance(part, (sympy.acos, sympy.asin)):
        return 1 - part.args[0] ** 2
    base = part.base if part.is_Pow else part
    return base.args[0] if isinstance(base, sympy.Abs) else base


def _corners(count: int) -> Array:
    """Return random corners with J > 0 of many sizes, (4, count)."""
    random = np.random.default_rng(3)
    corners = random.normal(size=(4, count))
    corners[2:] *= np.where(corners[0] * corners[3] < corners[1] * corners[2], -1, 1)
    return np.asarray(corners * random.choice(_SIZES, size=count))


def _regular_corners() -> Array:
    """Return squares and rectangles of two sizes, turned and not, (4, n)."""
    corners = [
        [size * c, size * s, -size * ratio * s, size * ratio * c]
        for size in (1.0, 2.0)
        for ratio in (1.0, 2.0, 0.5)
        for c, s in ((1.0, 0.0), (0.6, 0.8))
    ]
    return np.array(corners).T


def _jumps(density: Expr, argument: Expr, first: Array, last: Array) -> bool:
    """Return whether the density or its slope jumps at a zero of `argument` on one of the lines, where J > 0."""
    crosses, low, _ = zeros_between(_function(argument), first, last)
    at = first + low * (last - first)
    inside = crosses & (_function(J)(at) > 0)
    jump = np.zeros_like(inside)
    for quantity in (_function(density), _slope(density, last - first)):
        with np.errstate(all="ignore"):
            sides = {way: quantity(at + way * (last - first)) for way in (-_FAR, -_NEAR, _NEAR, _FAR)}
            jump |= ~(np.abs(sides[_NEAR] - sides[-_NEAR]) <= _JUMP * (np.abs(sides[-_FAR]) + np.abs(sides[_FAR])))
    return bool((jump & inside).any())


def _slope(density: Expr, along: Array) -> Callable[[Array], Array]:
    """Return the derivative of the density along a direction at corners; its impulses count as none."""
    written = expand_metric(density)
    parts = [_function(almost_everywhere(sympy.diff(written, p))) for p in FIRST_DERIVATIVES]
    return lambda corners: np.asarray(sum(part(corners) * way for part, way in zip(parts, along, strict=True)))


def _function(expression: Expr) -> Callable[[Array], Array]:
    function = sympy.lambdify(FIRST_DERIVATIVES, expand_metric(expression), "numpy")

    def values(corners: Array) -> Array:
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(function(*corners), dtype=float), corners.shape[1:])

    return values
