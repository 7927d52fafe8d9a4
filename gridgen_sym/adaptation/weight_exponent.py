"""From a density of nodes to the weight s with which a functional places the nodes so.

Adaptation holds the weight at the nodes and renews it between moves (mode `frozen`). Area then makes s·J constant, and
J is one over the density: so s is the density. With length, s times the edges' lengths is constant along each line:
the counterpart in the logical square of the variable diffusion of A. M. Winslow (1981).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import GridgenError
from ..fields.weight import LARGEST
from .nodes import Nodes, mean_of


class WeightExponent(NamedTuple):
    """How the weight of a functional follows from the density of nodes.

    Attributes:
        exponent: the weight is the density to this power.
        degree: of the weighted term in J; the weight is divided by the mean J to this power.
    """

    exponent: float
    degree: float


_KNOWN = {
    "area": WeightExponent(1, 2),
    "area_winslow": WeightExponent(1, 2),
    "combined": WeightExponent(1, 2),
    "length": WeightExponent(1, 1),
}


def weight_exponent_of(functional: str, given: float | None = None) -> WeightExponent:
    """Return the weight exponent of a functional.

    Args:
        functional: its name.
        given: the exponent of a functional of the user's own; the weight's mean is about 1 then.

    Raises:
        GridgenError: for a functional whose exponent is not known, where none is given.
    """
    if given is not None:
        return WeightExponent(float(given), 0.0)
    if functional not in _KNOWN:
        raise GridgenError(
            f"how {functional!r} places nodes with a weight is not known: pass weight_exponent=, the power of the "
            f"density of nodes that its weight is, or take one of {', '.join(_KNOWN)}"
        )
    return _KNOWN[functional]


def weight_values(density: Array, nodes: Nodes, weight_exponent: WeightExponent) -> Array:
    """Return the weight at the nodes of a grid, scaled so that the energy has no unit.

    The density is taken relative to its mean, and J relative to its mean, which on the unit square is the grid's area.
    The balance of the weighted term with a barrier then depends neither on the size of the domain, nor on the number of
    nodes, nor on the scale of the density.

    Raises:
        GridgenError: where it overflows, or underflows to zero: tiny cells, or a large power of a density that varies
            much.
    """
    power, degree = weight_exponent
    area, relative = nodes.areas, density / mean_of(nodes, density)
    with np.errstate(over="ignore", under="ignore"):
        weight = np.asarray(relative**power / area.sum() ** degree)
    if 0 < weight.min() <= weight.max() <= LARGEST:
        return weight
    how = "overflows" if weight.max() > LARGEST else "underflows to zero"
    if degree:
        raise GridgenError(
            f"the grid has an area of {area.sum():.3g}, and the weight that places nodes {how}: scale the grid to a "
            "size of about 1"
        )
    raise GridgenError(
        f"the density of nodes is {relative.min():.3g} to {relative.max():.3g} of its mean, and its power {power:g}, "
        f"the weight, {how}: take another exponent, or a density that varies less"
    )
