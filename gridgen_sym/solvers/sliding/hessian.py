"""The Hessian with sliding nodes: couplings along their tangents, and the second derivative along their curves.

The tangential entry of a sliding node is t^T H t + g . c'', with c'' per length and without its tangential part; the
normal one is of the size of the others, and coupled with nothing.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from .side import Index

#: The couplings that the stored half of a Hessian holds: the shift of the neighbor and the first plane.
_COUPLINGS = (((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))


class Couplings:
    """Where a stored Hessian has entries of sliding nodes."""

    __slots__ = ("_entries", "_first", "_nodes", "_second")

    def __init__(self, nodes: Index, shape: tuple[int, ...]) -> None:
        """Find the blocks of the nodes of a grid (ni, nj): first those whose first node alone slides, then both."""
        ni, nj = shape
        count = len(nodes[0])
        self._nodes = nodes[0] * nj + nodes[1]
        number = np.full(shape, count)  # Of nodes that do not slide: one after the last.
        number[nodes] = np.arange(count)
        places, ones, others = [], [], []
        for (di, dj), first in _COUPLINGS:
            i, j = np.concatenate((np.stack(nodes), np.stack(nodes) - np.array([[di], [dj]])), axis=1)
            there = (i >= 0) & (i + di < ni) & (np.minimum(j, j + dj) >= 0) & (np.maximum(j, j + dj) < nj)
            here = np.unique(i[there] * nj + j[there])
            places.append(first * number.size + here)
            ones.append(number.ravel()[here])
            others.append(number.ravel()[here + di * nj + dj])
        place, one, other = (np.concatenate(part) for part in (places, ones, others))
        order = np.argsort((one == count) * 2 + ((one < count) & (other < count)), kind="stable")
        place, one, other = place[order], one[order], other[order]
        self._entries = place + number.size * np.arange(4)[:, None]
        self._first = one[: np.count_nonzero(one < count)]
        self._second = other[np.count_nonzero(other == count) :]

    def constrain(self, planes: Array, tangents: Array, curvature: Array) -> None:
        """Project blocks on the tangents (2, nodes), and set the nodes' own, with a curvature (nodes,); in place."""
        flat = planes.reshape(-1)
        block = flat[self._entries].reshape(2, 2, -1)
        rows = block[:, :, : len(self._first)]
        tangent = tangents[:, self._first]
        rows[...] = tangent[:, None] * (tangent[:, None] * rows).sum(axis=0)
        columns = block[:, :, block.shape[2] - len(self._second) :]
        tangent = tangents[:, self._second]
        columns[...] = tangent * (tangent * columns).sum(axis=1, keepdims=True)
        flat[self._entries] = block.reshape(4, -1)
        self._constrain_own(planes.reshape(len(planes), -1), tangents, curvature)

    def _constrain_own(self, flat: Array, tangents: Array, curvature: Array) -> None:
        xx, xy, yy = flat[:3, self._nodes]
        tx, ty = tangents
        size = 0.5 * (np.abs(xx) + np.abs(yy))
        along = xx * tx * tx + 2 * xy * tx * ty + yy * ty * ty + curvature
        flat[0, self._nodes] = along * tx * tx + size * ty * ty
        flat[1, self._nodes] = (along - size) * tx * ty
        flat[2, self._nodes] = along * ty * ty + size * tx * tx


def along_curves(slopes: Array, bends: Array, gradient: Array) -> Array:
    """Return what bends add to the second derivatives along the curves, at every sliding node.

    Args:
        slopes: (2, nodes), the first derivatives of the curves.
        bends: likewise, the second ones.
        gradient: likewise, of the energy.
    """
    square = (slopes * slopes).sum(axis=0)
    normal = bends - slopes * ((bends * slopes).sum(axis=0) / square)
    return np.asarray((gradient * normal).sum(axis=0) / square)
