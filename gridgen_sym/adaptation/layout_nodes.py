"""The nodes of several blocks as adaptation sees them: values of all blocks in one array.

Sums over the corners at a node, of which derivatives and averages are made, are sums over all its copies. So what is
recovered is the same, to rounding, however a grid is cut, and any number of blocks may meet at a node. Only the second
differences of the hierarchical indicator are those of each block.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..fields import Weight
from ..grids import Grid
from ..solvers.layout.sparse import turned_blocks
from ..topology import MultiBlock
from ..topology.copies import first_copies
from .equidistribution import cell_areas, cell_means
from .error_estimate import hierarchical_indicator, recovery_indicator
from .nodes import BlockNodes, Measure, Nodes
from .outer_sides import OuterSides
from .recovery import nodal_values, weighted_gradient


class LayoutNodes:
    """Those of several blocks: values are arrays (n,), block after block, all copies alike; in cells likewise."""

    def __init__(self, layout: MultiBlock) -> None:
        """Take a layout."""
        self._layout = layout
        shapes, copies = [grid.shape for grid in layout.blocks], layout.copies
        self._ends = np.cumsum([ni * nj for ni, nj in shapes])
        self._cell_ends = np.cumsum([(ni - 1) * (nj - 1) for ni, nj in shapes])
        self._number = np.concatenate([one.ravel() for one in first_copies(copies, shapes)])
        self._turn = np.stack((np.ones(self._ends[-1]), np.zeros(self._ends[-1])))
        widths, begin = np.array([nj for _, nj in shapes]), self._ends - [ni * nj for ni, nj in shapes]
        self._turn[:, begin[copies.block] + copies.i * widths[copies.block] + copies.j] = copies.turn
        self._turned = bool((copies.turn[0] != 1).any())
        self._corners = np.concatenate([_corner_counts(shape).ravel() for shape in shapes])
        self._outer = OuterSides(layout)
        self._beyond = self._sums(self._join(self._outer.counts))
        self.x, self.y = (self._join([grid.planes[axis] for grid in layout.blocks]) for axis in (0, 1))

    @cached_property
    def areas(self) -> Array:
        """The areas of the cells."""
        return self._join([cell_areas(grid) for grid in self._layout.blocks])

    def _join(self, parts: Sequence[Array]) -> Array:
        return np.concatenate([part.ravel() for part in parts])

    def _split(self, values: Array) -> list[Array]:
        """Return values (..., n) of each block, (..., ni, nj)."""
        parts = [part.copy() for part in np.split(values, self._ends[:-1], axis=-1)]
        return [
            part.reshape(*values.shape[:-1], *grid.shape) for part, grid in zip(parts, self._layout.blocks, strict=True)
        ]

    def _sums(self, values: Array) -> Array:
        """Return the sums over the copies of every node."""
        return np.asarray(np.bincount(self._number, values, len(self._number))[self._number])

    def values(self, given: object, what: str) -> Array:
        """Return checked values, by the names of blocks or in their order; of copies the mean."""
        names = self._layout.names
        if isinstance(given, Mapping) and set(given) == set(names):
            given = [given[name] for name in names]
        if isinstance(given, Mapping) or not isinstance(given, Sequence | np.ndarray) or len(given) != len(names):
            raise GridgenError(
                f"{what} must be given for every block, by name or in the order {', '.join(names)}; came "
                f"{quoted(given)}"
            )
        found = []
        for name, grid, part in zip(names, self._layout.blocks, given, strict=True):
            try:
                found.append(nodal_values(grid, part, what))
            except GridgenError as error:
                raise GridgenError(f"block {name}: {error}") from error
        joined = self._join(found)
        return np.asarray(self._sums(joined) / self._sums(np.ones_like(joined)))

    def given_back(self, values: Array) -> dict[str, Array]:
        """Return values by the names of blocks."""
        return dict(zip(self._layout.names, self._split(values), strict=True))

    def weights(self, values: Array) -> dict[str, Weight]:
        """Return the weights of the blocks, by name."""
        return {name: Weight(part.copy()) for name, part in self.given_back(values).items()}

    def place(self, values: Array) -> str:
        """Return where values are the least."""
        k = int(values.argmin())
        block = int(np.searchsorted(self._ends, k, side="right"))
        shape = self._layout.blocks[block].shape
        i, j = divmod(k - int(self._ends[block]) + shape[0] * shape[1], shape[1])
        return f"node ({i}, {j}) of block {self._layout.names[block]}, x = {self.x[k]:.6g}, y = {self.y[k]:.6g}"

    def cell_means(self, values: Array) -> Array:
        """Return the means over the cells."""
        return self._join([cell_means(part) for part in self._split(values)])

    def at_nodes(self, cells: Array) -> Array:
        """Return the means around nodes."""
        return np.asarray(self._around_nodes(cells) / self._sums(self._corners))

    def _around_nodes(self, cells: Array) -> Array:
        """Return the sums of values in the cells around each node."""
        parts = []
        for grid, part in zip(self._layout.blocks, np.split(cells, self._cell_ends[:-1]), strict=True):
            ni, nj = grid.shape
            padded = np.pad(part.reshape(ni - 1, nj - 1), 1)
            parts.append(padded[1:, 1:] + padded[:-1, 1:] + padded[1:, :-1] + padded[:-1, :-1])
        return self._sums(self._join(parts))

    def smoothed(self, values: Array, passes: int) -> Array:
        """Average over the cells around each node; beyond the outer boundary values go on as they are on it."""
        count = self._sums(self._corners) + self._beyond
        for _ in range(passes):
            beyond = self._sums(self._join([self._outer.beyond(*one) for one in enumerate(self._split(values))]))
            values = (self._around_nodes(self.cell_means(values)) + beyond) / count
        return values

    def gradient(self, values: Array) -> Array:
        """Return the recovered gradient."""
        return self._recovered(values)[0]

    def _recovered(self, *fields: Array) -> list[Array]:
        """Return the recovered gradients (2, n) of some fields, the components of one vector where they are two."""
        split = [self._split(field) for field in fields]
        parts = [
            [weighted_gradient(grid, part[block]) for block, grid in enumerate(self._layout.blocks)] for part in split
        ]
        jacobians = self._sums(self._corners * self._join([jacobian for _, jacobian in parts[0]]))
        rows = np.concatenate(
            [np.stack([self._join([one[axis] for one, _ in part]) for axis in (0, 1)]) for part in parts]
        )
        summed = self._summed_tensor(rows * self._corners)
        return [summed[2 * k : 2 * k + 2] / jacobians for k in range(len(fields))]

    def _summed_tensor(self, rows: Array) -> Array:
        """Return the sums over copies of vectors (2, n), or tensors (4, n), each in the turn of its own copy."""
        if not self._turned:
            return np.stack([self._sums(row) for row in rows])
        turn, back = self._turn, self._turn * [[1.0], [-1.0]]
        if len(rows) == 2:
            return _turned(np.stack([self._sums(row) for row in _turned(rows, back)]), turn)
        rows = turned_blocks(rows, turn, turn)
        return turned_blocks(np.stack([self._sums(row) for row in rows]), back, back)

    def hessian(self, values: Array) -> Array:
        """Return the recovered second derivatives."""
        (u_xx, u_xy), (u_yx, u_yy) = self._recovered(*self._recovered(values)[0])
        parts = self._split(np.stack((u_xx, (u_xy + u_yx) / 2, u_yy)))
        for block, part in enumerate(parts):
            self._outer.take_from_inside(block, part)
        found = np.concatenate([part.reshape(3, -1) for part in parts], axis=1)
        xx, xy, _, yy = self._summed_tensor(found[[0, 1, 1, 2]]) / self._sums(np.ones(len(self._number)))
        return np.stack((xx, xy, yy))

    def recovery_error(self, values: Array) -> Array:
        """Return the indicator."""
        return self._in_cells(recovery_indicator, values)

    def hierarchical_error(self, values: Array) -> Array:
        """Return the indicator."""
        return self._in_cells(hierarchical_indicator, values)

    def _in_cells(self, indicator: Callable[[Grid, Array, Array], Array], values: Array) -> Array:
        gradient = self._split(self.gradient(values))
        blocks = zip(self._layout.blocks, self._split(values), gradient, strict=True)
        return self._join([indicator(*block) for block in blocks])

    def measured(self, measure: Measure, values: Array) -> Array:
        """Return what a user's measure gives on every block."""
        parts = zip(self._layout.blocks, self._split(values), strict=True)
        found: list[npt.ArrayLike] = [measure(grid, part) for grid, part in parts]
        return self.values(found, "a monitor's measure")


def _corner_counts(shape: tuple[int, int]) -> Array:
    """Return how many corners of a block's cells meet at each of its nodes, (ni, nj)."""
    rows, columns = (np.r_[1.0, np.full(count - 2, 2.0), 1.0] for count in shape)
    return np.outer(rows, columns)


def _turned(vectors: Array, turn: Array) -> Array:
    """Return vectors (2, n) turned by angles with these cosines and sines."""
    (x, y), (c, s) = vectors, turn
    return np.stack((c * x - s * y, s * x + c * y))


def nodes_of(grid: Grid | MultiBlock) -> Nodes:
    """Return the nodes of a grid of one block or several."""
    return LayoutNodes(grid) if isinstance(grid, MultiBlock) else BlockNodes(grid)
