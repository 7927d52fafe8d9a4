"""Decide what the paper says of the minimum of a sum, on the grid of 3 x 3 nodes."""

from __future__ import annotations

import sympy
from sympy import Expr

from ...functionals import Functional
from ..coordinates import METRIC, J, expand_metric
from ..derive.discrete import corner_model
from .comparison import agreement
from .errata import Finding
from .small_grid import UNKNOWNS, Place, SmallGrid

_GRID = "on the unit square with 3 x 3 nodes, the lower middle one at (0.15, 0.5)"
#: A largest corner energy is lower than another where it is so by this factor: the raster of places is no finer.
_LOWER = 0.99


def compare_inner_sum(known: Functional) -> Finding:
    """Decide whether the minimum of the sum over the corners at inner nodes is unfolded."""
    inner, full = (SmallGrid(_energy(known), inner_only=only).minimum() for only in (True, False))
    text = (
        f"{_GRID}, its minimum is at {_at(inner)} with energy {inner.energy:.2f}, where a corner at a boundary node "
        f"has J = {inner.smallest:.3f}; the sum over all corners has its minimum at {_at(full)}, where J >= "
        f"{full.smallest:.4f}"
    )
    if inner.smallest > 0 or full.smallest <= 0:
        return agreement(text)
    return Finding(False, "claim refuted", "folded at a boundary node", sympy.Float(inner.smallest, 6), text)


def compare_each(known: Functional) -> Finding:
    """Decide whether the minimum of the sum has the smallest energy in each corner, by the largest one of them."""
    grid = SmallGrid(_energy(known), inner_only=True)
    of_sum, of_largest = grid.minimum(), grid.least_largest()
    text = (
        f"{_GRID}, the sum has its minimum at {_at(of_sum)}, where the largest term is {of_sum.largest:.2f}; "
        f"at {_at(of_largest)} it is {of_largest.largest:.2f}"
    )
    if of_largest.largest > _LOWER * of_sum.largest:
        return agreement(text)
    condition = "claim holds under a condition: of the sum, not of each corner"
    return Finding(False, condition, "of the sum only", sympy.Float(of_sum.largest, 6), text)


def negative_weight_bounds(weight: Expr) -> str:
    """Return what bounds the sum of s J² at a negative s, where J > 0 and where the inner node may go anywhere."""
    total = sympy.expand(SmallGrid(METRIC[J], inner_only=True).energy)
    energy = sympy.expand(SmallGrid(weight * METRIC[J] ** 2, inner_only=True).energy)
    far = sympy.limit(energy.subs(UNKNOWNS[1], 0), UNKNOWNS[0], sympy.oo)
    # Positive numbers of a given sum have squares that sum to less than its square.
    where_valid = f"is at least {weight * total**2} while J > 0" if total.is_number else "has no bound while J > 0"
    return f"{_GRID} and this s everywhere, the sum {where_valid} and tends to {far} as the inner node moves away"


def _energy(known: Functional) -> Expr:
    return expand_metric(corner_model(known, "plain").energy)


def _at(place: Place) -> str:
    return "({:.3f}, {:.3f})".format(*place.at)
