"""From the density of nodes that is wanted to the weight s that makes a functional place them so.

Adaptation holds the weight at the nodes and renews it between moves (mode `frozen`). Area then makes s·J constant, and
J is one over the density: so s is the density. With length, s times the edges' lengths is constant along each line:
the counterpart in the logical square of the variable diffusion of A. M. Winslow (1981).
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..fields.weight import LARGEST
from ..grids import Grid
from .equidistribution import cell_areas, cell_means

#: The power of the density that the weight is, and the degree in J of what it multiplies.
_LAWS: dict[str, tuple[float, float]] = {
    "area": (1, 2),
    "area_winslow": (1, 2),
    "combined": (1, 2),
    "length": (1, 1),
}


def law_of(functional: str, power: float | None = None) -> tuple[float, float]:
    """Return the power of the density that the weight must be, and the degree in J of the term that it multiplies.

    Args:
        functional: its name.
        power: given by the user, for a functional of their own; the weight's mean is about 1 then.

    Raises:
        GridgenError: for a functional without a known law, where no power is given.
    """
    if power is not None:
        return float(power), 0.0
    if functional not in _LAWS:
        raise GridgenError(
            f"how {quoted(functional)} places nodes with a weight is not known: pass power=, the power of the density "
            f"of nodes that its weight must be, or take one of {', '.join(_LAWS)}"
        )
    return _LAWS[functional]


def weight_values(density: Array, grid: Grid, law: tuple[float, float]) -> Array:
    """Return the weight (ni, nj) at the nodes of a grid, scaled so that the energy has no unit.

    With the density over its mean in place of the density, and J over its mean in place of J, the balance of the
    weighted term with a barrier depends neither on the size of the domain, nor on the number of nodes, nor on the
    scale of the density.

    Raises:
        GridgenError: where it overflows: tiny cells, or a large power of a density that varies much.
    """
    power, degree = law
    area = cell_areas(grid)
    relative = density / float((cell_means(density) * area).sum() / area.sum())
    with np.errstate(over="ignore"):
        weight = np.asarray(relative**power / area.mean() ** degree)
    if weight.max() <= LARGEST:
        return weight
    if degree:
        raise GridgenError(
            f"the grid's cells have a mean area of {area.mean():.3g}, and the weight that places nodes overflows: "
            "scale the grid to a size of about 1"
        )
    raise GridgenError(
        f"the density of nodes is {relative.min():.3g} to {relative.max():.3g} of its mean, and its power {power:g}, "
        "the weight, overflows: take another power, or a density that varies less"
    )
