"""What a density names beside the metric, as kernels read it: a value at every corner of every cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError

#: The corners of a cell as kernels count them, at the nodes (i, j), (i+1, j), (i, j+1) and (i+1, j+1).
_CORNERS = ((0, 0), (1, 0), (0, 1), (1, 1))
#: Their places in `corner_jacobians`, where corners follow counter-clockwise.
_COUNTER_CLOCKWISE = (0, 1, 3, 2)


@dataclass(frozen=True, slots=True)
class Values:
    """Planes of values on a grid of (ni, nj) nodes, each given per node, per cell or per corner.

    Attributes:
        nodes: for each plane its values at the nodes (ni, nj); where they are given otherwise, the mean over the
            corners that meet there.
        corners: for each plane four views (ni-1, nj-1): its values at the corners of cells (i, j) at the nodes (i, j),
            (i+1, j), (i, j+1) and (i+1, j+1). Rows are nj doubles apart.
        pointers: (4 * planes), the addresses of these views, for compiled kernels.
    """

    nodes: tuple[Array, ...]
    corners: tuple[tuple[Array, Array, Array, Array], ...]
    pointers: npt.NDArray[np.uintp]

    @classmethod
    def of(cls, planes: Sequence[Array] | Array, shape: tuple[int, int]) -> Values:
        """Arrange planes as kernels read them; those per node are not copied.

        Args:
            planes: each (ni, nj), one value per node; (ni-1, nj-1), one per cell; or (4, ni-1, nj-1), one per corner in
                the order of `corner_jacobians`.
            shape: (ni, nj).

        Raises:
            GridgenError: for a plane of another shape.
        """
        nodes, corners = [], []
        for plane in planes:
            views = _views(np.ascontiguousarray(plane, dtype=np.float64), shape)
            corners.append(views)
            nodes.append(plane if plane.shape == shape else _means(views, shape))
        addresses = [view.ctypes.data for views in corners for view in views]
        return cls(tuple(nodes), tuple(corners), np.array(addresses, dtype=np.uintp))

    @property
    def per_node(self) -> tuple[bool, ...]:
        """Whether each plane is given per node."""
        return tuple(map(_is_shared, self.corners))

    def at_nodes(self) -> Values:
        """Return the values of the nodes alone, for kernels that work on nodes and not on cells."""
        return self if all(self.per_node) else Values.of(self.nodes, self.nodes[0].shape)


def _views(plane: Array, shape: tuple[int, int]) -> tuple[Array, Array, Array, Array]:
    """Return the four views of a plane, or of a copy whose rows are as far apart as those of nodes."""
    ni, nj = shape
    cells = (ni - 1, nj - 1)
    if plane.shape == shape:
        found = [plane[i : ni - 1 + i, j : nj - 1 + j] for i, j in _CORNERS]
    elif plane.shape == cells:
        found = [_with_rows_of(nj, plane)] * 4
    elif plane.shape == (4, *cells):
        found = [_with_rows_of(nj, plane[place]) for place in _COUNTER_CLOCKWISE]
    else:
        raise GridgenError(
            f"values on {ni} x {nj} nodes must be one per node, shape {shape}, one per cell, shape {cells}, or one per "
            f"corner, shape {(4, *cells)}; came {plane.shape}"
        )
    return found[0], found[1], found[2], found[3]


def _with_rows_of(length: int, plane: Array) -> Array:
    """Return a copy of a plane whose rows are `length` doubles apart."""
    memory = np.zeros((plane.shape[0], length))
    memory[:, : plane.shape[1]] = plane
    return memory[:, : plane.shape[1]]


def _means(views: tuple[Array, Array, Array, Array], shape: tuple[int, int]) -> Array:
    """Return at each node the mean of the values of the corners that meet there."""
    ni, nj = shape
    total, count = np.zeros(shape), np.zeros(shape)
    for (i, j), view in zip(_CORNERS, views, strict=True):
        total[i : ni - 1 + i, j : nj - 1 + j] += view
        count[i : ni - 1 + i, j : nj - 1 + j] += 1
    return total / count


def _is_shared(views: tuple[Array, Array, Array, Array]) -> bool:
    """Return whether the corners that meet at a node share its value."""
    first, other = views[0], views[1]
    return other.ctypes.data - first.ctypes.data == first.strides[0]
