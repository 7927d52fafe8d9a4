"""What adaptation computes from values at the nodes of a grid, whether that is one block or several."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..fields import Weight
from ..fields.sampled import nodal
from ..grids import Grid
from .equidistribution import cell_areas, cell_means
from .error_estimate import hierarchical_error, recovery_error
from .recovery import nodal_values, recover_gradient, recover_hessian

#: A user's measure of features: of a grid of one block, and the values at its nodes.
Measure = Callable[[Grid, Array], npt.ArrayLike]


class Nodes(Protocol):
    """The nodes of a grid; values at nodes, and those in cells, are arrays of a shape of its own."""

    @property
    def x(self) -> Array:
        """The first coordinate of the nodes."""

    @property
    def y(self) -> Array:
        """The second one."""

    @property
    def areas(self) -> Array:
        """The areas of the cells."""

    def values(self, given: Any, what: str) -> Array:  # noqa: ANN401
        """Return what a user gives as values at the nodes, checked."""

    def given_back(self, values: Array) -> Any:  # noqa: ANN401
        """Return values as a user has them."""

    def weights(self, values: Array) -> Any:  # noqa: ANN401
        """Return values as the weight of a functional."""

    def place(self, values: Array) -> str:
        """Return where values are the least, in words."""

    def cell_means(self, values: Array) -> Array:
        """Return the means of the values at the nodes of each cell."""

    def at_nodes(self, cells: Array) -> Array:
        """Return the means of values in the cells around each node."""

    def smoothed(self, values: Array, passes: int) -> Array:
        """Return values after some passes of the binomial average of 3 x 3 nodes."""

    def gradient(self, values: Array) -> Array:
        """Return the recovered gradient: u_x and u_y."""

    def hessian(self, values: Array) -> Array:
        """Return the recovered second derivatives: u_xx, u_xy and u_yy."""

    def recovery_error(self, values: Array) -> Array:
        """Return the indicator of Zienkiewicz and Zhu in the cells."""

    def hierarchical_error(self, values: Array) -> Array:
        """Return the hierarchical indicator in the cells."""

    def measured(self, measure: Measure, values: Array) -> Array:
        """Return what a user's measure gives, checked."""


def mean_of(nodes: Nodes, values: Array) -> float:
    """Return the mean of values at the nodes over the area of the grid."""
    areas = nodes.areas
    return float((nodes.cell_means(values) * areas).sum() / areas.sum())


class BlockNodes:
    """Those of one block: values are arrays (ni, nj), in cells (ni-1, nj-1)."""

    def __init__(self, grid: Grid) -> None:
        """Take a grid."""
        self._grid, self.x, self.y = grid, grid.x, grid.y

    @cached_property
    def areas(self) -> Array:
        """The areas of the cells."""
        return cell_areas(self._grid)

    def values(self, given: npt.ArrayLike, what: str) -> Array:
        """Return checked values; see `nodal_values`."""
        return nodal_values(self._grid, given, what)

    def given_back(self, values: Array) -> Array:
        """Return values as they are."""
        return values

    def weights(self, values: Array) -> Weight:
        """Return the weight of these values."""
        return Weight(values)

    def place(self, values: Array) -> str:
        """Return where values are the least."""
        i, j = divmod(int(values.argmin()), values.shape[1])
        return f"node ({i}, {j}), x = {self.x[i, j]:.6g}, y = {self.y[i, j]:.6g}"

    def cell_means(self, values: Array) -> Array:
        """Return the means over the cells."""
        return cell_means(values)

    def at_nodes(self, cells: Array) -> Array:
        """Return the means around nodes."""
        return nodal(cells)

    def smoothed(self, values: Array, passes: int) -> Array:
        """Average along both logical directions."""
        for _ in range(passes):
            for axis in (0, 1):
                rows = np.moveaxis(values, axis, 0)
                padded = np.concatenate((rows[:1], rows, rows[-1:]))
                values = np.moveaxis((padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4, 0, axis)
        return values

    def gradient(self, values: Array) -> Array:
        """Return the recovered gradient."""
        return recover_gradient(self._grid, values)

    def hessian(self, values: Array) -> Array:
        """Return the recovered second derivatives."""
        return recover_hessian(self._grid, values)

    def recovery_error(self, values: Array) -> Array:
        """Return the indicator."""
        return recovery_error(self._grid, values)

    def hierarchical_error(self, values: Array) -> Array:
        """Return the indicator."""
        return hierarchical_error(self._grid, values)

    def measured(self, measure: Measure, values: Array) -> Array:
        """Return what a user's measure gives."""
        return nodal_values(self._grid, measure(self._grid, values), "a monitor's measure")
