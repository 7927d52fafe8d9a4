"""Equidistribution, measured: how much s·J and sqrt(s)·J vary over the cells of a grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError
from ..fields import Weight
from ..grids import Grid, corner_jacobians
from ..grids.grid import check_grid


@dataclass(frozen=True, slots=True)
class Spread:
    """How much a positive quantity varies over the cells.

    Attributes:
        variation: standard deviation over mean; 0 where it is constant.
        ratio: the largest over the smallest value; 1 where it is constant, infinite where it is not positive.
    """

    variation: float
    ratio: float

    def __str__(self) -> str:
        """Say both."""
        return f"variation {self.variation:.3f}, ratio {self.ratio:.3g}"


@dataclass(frozen=True, slots=True)
class Equidistribution:
    """The two products that the area functional makes constant.

    Attributes:
        weight: the spread of s·J, constant for a frozen weight.
        root: the spread of sqrt(s)·J, constant for a weight that is differentiated through.
    """

    weight: Spread
    root: Spread


def equidistribution(grid: Grid, weight: Weight | npt.ArrayLike) -> Equidistribution:
    """Measure the spread of s·J and sqrt(s)·J over the cells; J is the cell's area.

    Args:
        grid: the grid.
        weight: s; a `Weight` or a source of one. A function of position is evaluated at the means of the cells' nodes,
            values per node are averaged over the cell's.

    Raises:
        GridgenError: if the weight is negative somewhere, for then the spreads mean nothing.
    """
    check_grid(grid)
    given = weight if isinstance(weight, Weight) else Weight(weight)
    if given.per_node:
        s = cell_means(given.values(grid.planes))
    else:
        middles = np.stack([cell_means(plane) for plane in grid.planes])
        given.field.check_samples(middles[0], middles[1], "cell")
        s = given.values(middles, "cell")
    if s.min() < 0:
        raise GridgenError(f"the spread of s·J needs a weight that is nowhere negative; it is {s.min():.6g} somewhere")
    area = cell_areas(grid)
    return Equidistribution(_spread(s * area), _spread(np.sqrt(s) * area))


def cell_means(nodes: Array) -> Array:
    """Return the means (ni-1, nj-1) of nodal values (ni, nj) over the cells."""
    mean: Array = (nodes[1:, 1:] + nodes[:-1, 1:] + nodes[1:, :-1] + nodes[:-1, :-1]) / 4
    return mean


def cell_areas(grid: Grid) -> Array:
    """Return the signed areas of the cells, (ni-1, nj-1)."""
    return np.asarray(corner_jacobians(grid.x, grid.y).mean(axis=0))


def variation(values: Array) -> float:
    """Return standard deviation over mean; infinite where the mean is not positive."""
    mean = float(values.mean())
    return float(values.std()) / mean if mean > 0 else np.inf


def _spread(values: Array) -> Spread:
    least = float(values.min())
    return Spread(variation(values), float(values.max()) / least if least > 0 else np.inf)
