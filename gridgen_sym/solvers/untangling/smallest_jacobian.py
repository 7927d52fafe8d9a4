"""Maximize the smallest Jacobian around a fold by sequential linear programming.

Minima of a regularized barrier for falling epsilon may lead to a fold that stays although a valid grid exists, above
all in a narrow corner of the boundary. There the smallest Jacobian of the few nodes around the fold is maximized:
Jacobians are linearized, and no node moves farther than a trust radius.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ..run.progress import Progress
from ..subdomains import folded_nodes
from .search import Search

#: Nodes up to so many cells from a fold are moved, at first and then; of a fold with more of them, none is.
_LAYERS, MOST_NODES = (3, 9), 400
#: First trust radius over the extent of the nodes; the radius below which no program raises the minimum; factors.
_RADIUS, _SMALLEST, _SHRINK, _GROW = 0.3, 1e-7, 0.2, 2.0
#: Seconds for one program: some that are badly scaled would not end.
_SECONDS = 0.5
#: It ends if so many programs have reduced the depth of the fold by less than this fraction.
_PATIENCE, _LITTLE = 6, 0.02


@dataclass(frozen=True, slots=True)
class SmallestJacobian:
    """Maximize the smallest Jacobian around each fold of the best grid; revert what does not reduce the folds."""

    name: str = "largest smallest Jacobian (sequential linear programming)"

    def run(self, search: Search) -> None:
        """Work on each group of folds, with more nodes around it where few did not help."""
        for layers in _LAYERS:
            coordinates = search.best.coordinates.copy()
            try:
                for free in surroundings(coordinates, search.problem.fixed, layers):
                    if free.sum() <= MOST_NODES:
                        FoldedRegion(coordinates, free).maximize(search.progress)
            finally:
                search.best.offer(coordinates)


@dataclass(frozen=True, slots=True)
class SmallestJacobianOfAll:
    """Maximize the smallest Jacobian of a small grid with all free nodes, from the start and from the best grid."""

    name: str = "largest smallest Jacobian of all nodes"

    def run(self, search: Search) -> None:
        """Work on the whole grid, if it has few enough free nodes."""
        free = search.problem.fixed == 0
        if not 0 < free.sum() <= MOST_NODES:
            return
        for start in (search.start, search.best.coordinates):
            coordinates = start.copy()
            try:
                FoldedRegion(coordinates, free).maximize(search.progress)
            finally:
                search.best.offer(coordinates)
            if search.done:
                return


def surroundings(coordinates: Array, fixed: Mask, layers: int) -> Iterator[npt.NDArray[np.bool_]]:
    """Return the free nodes (ni, nj) up to some cells from each fold at a corner with a free node."""
    from scipy.ndimage import binary_dilation, label

    nodes = folded_nodes(coordinates, fixed)
    groups, count = label(binary_dilation(nodes, np.ones((3, 3)), iterations=layers), np.ones((3, 3)))
    for group in range(1, count + 1):
        yield (groups == group) & (fixed == 0)


class FoldedRegion:
    """The corners of cells that a few free nodes belong to, and the maximization of the smallest Jacobian there."""

    def __init__(self, coordinates: Array, free: npt.NDArray[np.bool_]) -> None:
        """Find the corners, each as three nodes counter-clockwise, with a free node among them."""
        ni, nj = free.shape
        number = np.arange(ni * nj).reshape(ni, nj)
        cell = np.stack((number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])).reshape(4, -1)
        corners = np.concatenate([cell[[k - 1, k, (k + 1) % 4]] for k in range(4)], axis=1)
        self.corners = corners[:, free.ravel()[corners].any(axis=0)]
        self.planes, self.free = coordinates.reshape(2, -1), np.flatnonzero(free)
        self.unknown = np.full(ni * nj, -1)
        self.unknown[self.free] = np.arange(len(self.free))
        self.points = self.planes[:, self.free].copy()
        self.extent = np.ptp(self.planes[:, np.unique(self.corners)], axis=1)
        self.size = float(np.abs(self._jacobians(self.points)).mean()) or 1.0

    def maximize(self, progress: Progress) -> None:
        """Move the nodes until all Jacobians are positive, or until no program raises the smallest.

        Each program is recorded as a step without an energy.
        """
        radius, smallest = _RADIUS, float(self._jacobians(self.points).min())
        seen = [smallest]
        while not smallest > 0 and radius > _SMALLEST:
            step = self._program(radius, min(_SECONDS, progress.deadline.check()))
            length = 1.0
            while step is not None and length > _SHRINK:
                reached = float(self._jacobians(self.points + length * step).min())
                if reached > smallest:
                    break
                length /= 2
            else:
                radius *= _SHRINK
                continue
            self.points += length * step
            smallest = reached
            self.planes[:, self.free] = self.points
            seen.append(smallest)
            progress.step(0, float("nan"), float("nan"), smallest)
            radius = min(radius * (_GROW if length == 1.0 else length), _RADIUS)
            if len(seen) > _PATIENCE and smallest - seen[-1 - _PATIENCE] < -_LITTLE * seen[-1 - _PATIENCE]:
                break

    def _corner_nodes(self, points: Array) -> Array:
        """Return the nodes (3, 2, corners) of the corners for given points of the free nodes."""
        planes = self.planes.copy()
        planes[:, self.free] = points
        return planes[:, self.corners].transpose(1, 0, 2)

    def _jacobians(self, points: Array) -> Array:
        a, b, c = self._corner_nodes(points)
        one, two = b - a, c - b
        return np.asarray(one[0] * two[1] - one[1] * two[0])

    def _program(self, radius: float, seconds: float) -> Array | None:
        """Return the step (2, free nodes) that raises the smallest linearized Jacobian most, or None."""
        from scipy.optimize import linprog
        from scipy.sparse import coo_array

        nodes = self._corner_nodes(self.points)
        jacobians, count = self._jacobians(self.points) / self.size, len(self.free)
        rows, columns, values = [], [], []
        for k in range(3):
            across = nodes[(k + 1) % 3] - nodes[(k + 2) % 3]
            row = np.flatnonzero(self.unknown[self.corners[k]] >= 0)
            column = self.unknown[self.corners[k][row]]
            for axis, slope in ((0, across[1]), (1, -across[0])):
                rows.append(row)
                columns.append(column + axis * count)
                values.append(slope[row] * self.extent[axis] / self.size)
        rows.append(np.arange(len(jacobians)))
        columns.append(np.full(len(jacobians), 2 * count))
        values.append(np.full(len(jacobians), -1.0))
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        found: Any = linprog(
            np.append(np.zeros(2 * count), -1.0),
            A_ub=-coo_array(entries, shape=(len(jacobians), 2 * count + 1)).tocsr(),
            b_ub=jacobians,
            bounds=[(-radius, radius)] * (2 * count) + [(None, 1.0)],
            method="highs",
            options={"time_limit": seconds},
        )
        return found.x[:-1].reshape(2, count) * self.extent[:, None] if found.status == 0 else None
