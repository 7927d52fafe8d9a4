"""Carry nodal values from one grid to another of the same domain."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..fields.sampled import grid_field
from ..grids import Grid
from ..grids.grid import check_grid
from .recovery import nodal_values


def transfer(source: Grid, values: npt.ArrayLike, target: Grid, *, smooth: bool = False) -> Array:
    """Return values at the nodes of `target` that interpolate nodal values on `source`.

    Linear in the two triangles of each cell: no value leaves the range of the given ones, so that fronts do not
    overshoot. Nodes of `target` outside `source` (its boundary may be cut a little differently) take the value of the
    nearest point of its boundary. A node that both grids have keeps its value to round-off.

    Args:
        source: the grid of the values.
        values: (ni, nj), or (ni, nj, n) for several fields at once.
        target: the other grid, of any shape.
        smooth: use Clough and Tocher's cubic, which is more accurate for smooth fields and overshoots at fronts.

    Returns:
        An array of the shape of `target`, with the last axis of `values`, if there is one.

    Raises:
        GridgenError: for values of another shape, or that are not finite.
    """
    given = real_array(values, "the values", copy=False)
    if given.ndim == 3 and given.shape[2] > 0:
        return np.stack(
            [transfer(source, given[..., k], target, smooth=smooth) for k in range(given.shape[2])], axis=-1
        )
    check_grid(target)
    return grid_field(source, nodal_values(source, given), smooth=smooth)(target.x, target.y)
