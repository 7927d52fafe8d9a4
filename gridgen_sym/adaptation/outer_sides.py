"""What of the sides of blocks is on the outer boundary, where averages and derivatives have nothing beyond."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.sides import Sides
from ..solvers.sliding.side import side_index
from ..topology import MultiBlock
from ..topology.outer_lines import outer_edges

#: The corners of a block, and the sides that meet there with the edge of each that ends there.
_CORNERS = (
    ((0, 0), ("bottom", 0), ("left", 0)),
    ((-1, 0), ("bottom", -1), ("right", 0)),
    ((-1, -1), ("top", -1), ("right", -1)),
    ((0, -1), ("top", 0), ("left", -1)),
)


class OuterSides:
    """The outer edges of all blocks.

    Attributes:
        counts: for each block (ni, nj), how many edges of the outer boundary end at a node, and one more at a corner of
            the domain: so many cells would have to be beyond.
    """

    def __init__(self, layout: MultiBlock) -> None:
        """Find them."""
        shapes = [grid.shape for grid in layout.blocks]
        self._edges = [_none_of(shape) for shape in shapes]
        for block, side, k in outer_edges(layout):
            self._edges[block][side][k] = True
        self._corners = [
            [at for at, (a, k), (b, m) in _CORNERS if edges[a][k] and edges[b][m]] for edges in self._edges
        ]
        self.counts = [self.beyond(block, np.ones(shape)) for block, shape in enumerate(shapes)]

    def beyond(self, block: int, values: Array) -> Array:
        """Return at every node of a block (ni, nj) the sum of what the cells beyond the outer boundary have.

        That is the mean of the edge between, and beyond a corner of the domain the value there.
        """
        found = np.zeros_like(values)
        for side, edges in self._edges[block].items():
            i, j = side_index(side, values.shape)
            line = values[i, j]
            means = np.where(edges, (line[1:] + line[:-1]) / 2, 0.0)
            found[i[1:], j[1:]] += means
            found[i[:-1], j[:-1]] += means
        for at in self._corners[block]:
            found[at] += values[at]
        return found

    def take_from_inside(self, block: int, field: Array) -> None:
        """Give the outer nodes of a block's field (m, ni, nj) the values of their inner neighbors, in place."""
        for side, inner in (("left", (1, 0)), ("right", (-1, 0)), ("bottom", (0, 1)), ("top", (0, -1))):
            edges = self._edges[block][side]
            outer = np.append(edges, False) | np.append(False, edges)
            i, j = (index[outer] for index in side_index(side, field.shape[1:]))
            field[:, i, j] = field[:, i + inner[0], j + inner[1]]


def _none_of(shape: tuple[int, int]) -> dict[str, npt.NDArray[np.bool_]]:
    """Return for each side of a block which edges are outer ones: none yet."""
    ni, nj = shape
    return {side: np.zeros((ni if side in ("bottom", "top") else nj) - 1, dtype=bool) for side in Sides._fields}
