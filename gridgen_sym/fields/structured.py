"""Interpolate nodal values in the cells of a valid grid: a cell is two triangles, and the value is linear in each.

The cell of a point is found by a walk from the nearest node: the triangle's affine map predicts the logical
coordinates of the point, and the walk goes to their cell. No triangulation is made, and a few passes over all points
are enough, whatever the number of nodes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..grids import Grid

#: Points are inside a cell up to this part of it: what rounding does to points on edges.
_ROUNDING = 1e-9
#: Points count as inside up to this part of the cell beside them: a curve that turns by 45 degrees over an edge of the
#: grid is a tenth of the edge away from its middle.
_CUT = 0.1
#: Walks start at so many nodes near a point: where the domain is thin or winding, the nearest ones may be behind a
#: boundary. On all domains of the package, adapted or not, 32 find every point.
_STARTS = 32
#: A walk has so many strides of any length, and then as many steps to neighbors as the grid has rows and columns.
_STRIDES = 20

_Indices = npt.NDArray[np.intp]


class StructuredInterpolation:
    """Where points lie in a valid grid.

    Outside the grid the nearest point of a boundary cell near it counts.
    """

    __slots__ = ("_planes", "_tree")

    def __init__(self, grid: Grid) -> None:
        """Make the search tree of the nodes of a valid grid."""
        from scipy.spatial import cKDTree

        self._planes = grid.planes
        self._tree: Any = cKDTree(grid.xy.reshape(-1, 2))

    def values(self, nodal: Array, x: Array, y: Array) -> Array:
        """Return nodal values (ni, nj), interpolated at points of any shape."""
        i, j, s, t, _ = self._located(np.stack((x.ravel(), y.ravel())))
        return _linear(nodal, i, j, s, t).reshape(x.shape)

    def located(self, x: Array, y: Array) -> tuple[_Indices, _Indices, Array, Array]:
        """Return the cells (i, j) of points, as rows, and the logical coordinates of the points in them."""
        i, j, s, t, _ = self._located(np.stack((x.ravel(), y.ravel())))
        return i, j, s, t

    def covers(self, x: Array, y: Array) -> npt.NDArray[np.bool_]:
        """Return which points lie in the grid, up to a tenth of the cell beside them.

        Two grids of one domain cut its curves at different nodes, so that nodes of one lie a little outside the other.
        """
        points = np.stack((x.ravel(), y.ravel()))
        i, j, _, _, distance = self._located(points)
        a, b, c, d = (self._planes[:, i + di, j + dj] for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
        longest = np.max([np.hypot(*(one - other)) for one, other in ((a, b), (b, c), (c, d), (d, a))], axis=0)
        return np.asarray(distance <= _CUT * longest).reshape(x.shape)

    def _located(self, points: Array) -> tuple[_Indices, _Indices, Array, Array, Array]:
        """Return the cells of points (2, n), the logical coordinates in them, and the distances of points outside."""
        best = self._walked(points, self._tree.query(points.T)[1])
        outside = _ROUNDING * float(np.ptp(self._planes, axis=(1, 2)).max())
        lost = np.flatnonzero(best[4] > outside)
        if not lost.size:
            return best
        nearest = self._tree.query(points[:, lost].T, min(_STARTS, self._planes[0].size))[1]
        for k in range(1, nearest.shape[1]):
            again = self._walked(points[:, lost], nearest[:, k])
            better = again[4] < best[4][lost]
            for one, other in zip(best, again, strict=True):
                one[lost[better]] = other[better]
            still = best[4][lost] > outside
            lost, nearest = lost[still], nearest[still]
        return best

    def _walked(self, points: Array, nodes: _Indices) -> tuple[_Indices, _Indices, Array, Array, Array]:
        """Return what `_located` does, from one start for each point."""
        ni, nj = self._planes[0].shape
        i, j = (np.minimum(index, most - 2) for index, most in zip(np.divmod(nodes, nj), (ni, nj), strict=True))
        s, t = np.zeros(len(nodes)), np.zeros(len(nodes))
        walking = np.arange(len(nodes))
        for stride in range(_STRIDES + ni + nj):
            p, q = self._logical(points[:, walking], i[walking], j[walking])
            s[walking], t[walking] = p, q
            longest = max(ni, nj) if stride < _STRIDES else 1
            to = [
                np.clip(index[walking] + np.clip(_cells_off(coordinate), -longest, longest), 0, most - 2)
                for index, coordinate, most in ((i, p, ni), (j, q, nj))
            ]
            moves = (to[0] != i[walking]) | (to[1] != j[walking])
            i[walking], j[walking] = to
            walking = walking[moves]
            if not walking.size:
                break
        s, t = np.clip(s, 0.0, 1.0), np.clip(t, 0.0, 1.0)
        there = np.stack([_linear(plane, i, j, s, t) for plane in self._planes])
        return i, j, s, t, np.hypot(*(points - there))

    def _logical(self, points: Array, i: _Indices, j: _Indices) -> tuple[Array, Array]:
        """Return the logical coordinates of points in cells, by the affine map of the triangle on their side."""
        a, b, c, d = (self._planes[:, i + di, j + dj] for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
        lower = _cross(c - a, points - a) <= 0
        along, across = np.where(lower, b - a, c - d), np.where(lower, c - b, d - a)
        area = _cross(along, across)
        return _cross(points - a, across) / area, _cross(along, points - a) / area


def _cross(one: Array, other: Array) -> Array:
    return np.asarray(one[0] * other[1] - one[1] * other[0])


def _cells_off(coordinate: Array) -> _Indices:
    """Return how many cells a logical coordinate is off the cell [0, 1]; far off, only its direction is used."""
    off = np.where(
        coordinate < -_ROUNDING,
        np.floor(coordinate),
        np.where(coordinate > 1 + _ROUNDING, np.ceil(coordinate) - 1, 0.0),
    )
    cells: _Indices = np.clip(np.nan_to_num(off), -1e6, 1e6).astype(np.intp)
    return cells


def _linear(nodal: Array, i: _Indices, j: _Indices, s: Array, t: Array) -> Array:
    """Return nodal values at logical coordinates of cells, linear in the triangles at both sides of a diagonal."""
    a, b, c, d = (nodal[i + di, j + dj] for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
    lower = a + s * (b - a) + t * (c - b)
    upper = a + t * (d - a) + s * (c - d)
    return np.asarray(np.where(t <= s, lower, upper))
