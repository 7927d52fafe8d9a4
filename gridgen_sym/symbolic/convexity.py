"""Decide whether a density is convex, where comparisons in it choose between branches, too.

Away from ties the second derivative decides. At a tie the slope must jump upwards, and the value not at all: that is
tried on short lines across ties. It is proved for a density in which maxima of branches enter with non-negative slopes,
such as max(0, 1 - J)**2, where the density is proved convex for every way to decide the comparisons.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import sympy
from sympy import Expr, Symbol

from ..arrays import Array
from ..functionals.choices import CHOICES, branches, maximum
from .admissible import Admissible
from .definiteness import Definiteness, almost_everywhere, is_nonnegative, semidefinite
from .ties import turning, zeros_between

#: Lines between random points on which ties are looked for; length of the lines across them over that of the line;
#: excess of the value in their middle over the mean of the ends, beside the values, that is no round-off.
_LINES, _SHORT, _EXCESS = 20_000, 1e-4, 1e-9


def convexity(
    density: Expr, variables: Sequence[Symbol], *, positive: Sequence[Symbol], parameters: Admissible
) -> Definiteness:
    """Decide whether a density is convex in some variables.

    Args:
        density: rational, with functions and choices.
        variables: in which.
        positive: symbols that take positive values only.
        parameters: the values that other symbols may take.
    """
    branched = density.has(sympy.sign, *CHOICES)
    second = sympy.hessian(density, variables)
    found = semidefinite(almost_everywhere(second) if branched else second, nonnegative=positive, parameters=parameters)
    if not found.holds or not branched:
        return found
    refuted = _refuted_at_a_tie(density, variables, positive, parameters)
    if refuted is not None:
        return refuted
    cases = branches(density) if _rises_with_maxima(density) else None
    proved = cases is not None and all(
        semidefinite(sympy.hessian(case, variables), nonnegative=positive, parameters=parameters).proof == "proved"
        for case in cases
    )
    return Definiteness(holds=True, proof="proved" if proved else "sampled")


def _rises_with_maxima(density: Expr) -> bool:
    """Return whether the only choices are maxima, not nested, in which the density is provably nowhere falling."""
    maxima = density.atoms(maximum)
    if density.has(sympy.Abs, sympy.sign) or density.atoms(*CHOICES) != maxima:
        return False
    # A maximum is not negative where one of its two values is not.
    stand_ins = {
        part: sympy.Dummy(nonnegative=True) if any(one.is_nonnegative for one in part.args) else sympy.Dummy(real=True)
        for part in maxima
    }
    outer = density.xreplace(stand_ins)
    known = [name for name in stand_ins.values() if name.is_nonnegative]
    return not any(part.has(maximum) for one in maxima for part in one.args) and all(
        is_nonnegative(outer.diff(name), known) for name in stand_ins.values()
    )


def _refuted_at_a_tie(
    density: Expr, variables: Sequence[Symbol], positive: Sequence[Symbol], parameters: Admissible
) -> Definiteness | None:
    """Return a refutation by short lines across ties, in the middle of which the value is above that of the chord."""
    random = np.random.default_rng(1)
    allowed = parameters.sample(random, _LINES)
    symbols = sorted(density.free_symbols, key=lambda variable: (variable not in allowed, str(variable)))
    ends = random.normal(size=(2, len(symbols), _LINES))
    for k, variable in enumerate(symbols):
        if variable in allowed:
            ends[:, k] = allowed[variable]
        elif variable in positive:
            np.abs(ends[:, k], out=ends[:, k])
        if variable not in variables:
            ends[1, k] = ends[0, k]
    first, last = ends
    value = _function(density, symbols)
    for tie in turning(density):
        crosses, *sides = zeros_between(_function(tie, symbols), first, last)
        for at in sides:
            middle, way = first + at * (last - first), _SHORT * (last - first)
            found, ahead, behind = value(middle), value(middle + way), value(middle - way)
            with np.errstate(all="ignore"):  # Powers of large parameters overflow; what is not finite refutes nothing.
                excess = found - (ahead + behind) / 2
            above = crosses & (excess > _EXCESS * (np.abs(found) + np.abs(ahead) + np.abs(behind)))
            if above.any():
                point = middle[:, above.argmax()]
                return Definiteness(False, "refuted", tuple(zip(symbols, map(float, point), strict=True)))
    return None


def _function(expression: Expr, symbols: Sequence[Symbol]) -> Callable[[Array], Array]:
    function = sympy.lambdify(symbols, expression, "numpy")

    def values(points: Array) -> Array:
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(function(*points), dtype=float), points.shape[1:])

    return values
