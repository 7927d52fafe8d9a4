"""The Hessian with sliding nodes: couplings along their tangents, and the second derivative along their curves.

The tangential entry of a sliding node is t^T H t + g . c'', with c'' per length and without its tangential part; the
normal one is of the size of the others, and coupled with nothing.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from .side import Index, SlidingSide

#: The couplings that the stored half of a Hessian holds: the shift of the neighbor and the first plane.
_COUPLINGS = (((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))


class Couplings:
    """Where a stored Hessian has entries of sliding nodes."""

    __slots__ = ("_blocks", "_nodes")

    def __init__(self, nodes: Index, shape: tuple[int, ...]) -> None:
        """Find the blocks of the nodes of a grid (ni, nj), each with the numbers of its two nodes."""
        ni, nj = shape
        count = len(nodes[0])
        self._nodes = nodes[0] * nj + nodes[1]
        number = np.full(shape, count)  # Of nodes that do not slide: one after the last.
        number[nodes] = np.arange(count)
        self._blocks: list[tuple[int, npt.NDArray[np.intp], Array, Array]] = []
        for (di, dj), first in _COUPLINGS:
            i, j = np.concatenate((np.stack(nodes), np.stack(nodes) - np.array([[di], [dj]])), axis=1)
            there = (i >= 0) & (i + di < ni) & (np.minimum(j, j + dj) >= 0) & (np.maximum(j, j + dj) < nj)
            here = np.unique(i[there] * nj + j[there])
            self._blocks.append((first, here, number.ravel()[here], number.ravel()[here + di * nj + dj]))

    def constrain(self, planes: Array, tangents: Array, curvature: Array) -> None:
        """Project blocks on the tangents (2, nodes), and set the nodes' own, with a curvature (nodes,); in place."""
        flat = planes.reshape(len(planes), -1)
        projectors = np.empty((2, 2, tangents.shape[1] + 1))
        projectors[:, :, :-1] = tangents[:, None] * tangents
        projectors[:, :, -1] = np.eye(2)
        for first, here, one, other in self._blocks:
            block = flat[first : first + 4, here].reshape(2, 2, -1)
            block = np.einsum("abn,bcn,cdn->adn", projectors[:, :, one], block, projectors[:, :, other])
            flat[first : first + 4, here] = block.reshape(4, -1)
        xx, xy, yy = flat[:3, self._nodes]
        tx, ty = tangents
        size = 0.5 * (np.abs(xx) + np.abs(yy))
        along = xx * tx * tx + 2 * xy * tx * ty + yy * ty * ty + curvature
        flat[0, self._nodes] = along * tx * tx + size * ty * ty
        flat[1, self._nodes] = (along - size) * tx * ty
        flat[2, self._nodes] = along * ty * ty + size * tx * tx


def along_curves(sides: list[SlidingSide], gradient: Array) -> Array:
    """Return what bends add to the second derivatives along the curves, from the gradient (2, nodes) at their nodes."""
    found, begin = [np.empty(0)], 0
    for side in sides:
        _, slope, bend = (part.T for part in side.derivatives)
        square = (slope**2).sum(axis=0)
        normal = bend - slope * ((bend * slope).sum(axis=0) / square)
        found.append((gradient[:, begin : begin + len(square)] * normal).sum(axis=0) / square)
        begin += len(square)
    return np.concatenate(found)
