"""The last means against a fold: lift the smallest Jacobian round it by linear programs.

Minima of a regularised barrier for falling epsilon may lead to a fold that stays although a valid grid exists, in a
narrow corner of the boundary above all. There the smallest Jacobian of the few nodes round the fold is maximised by
itself: Jacobians are linearised, and no node moves further than a trust radius (a sequence of linear programs).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...grids import corner_jacobians
from ..folds import Folds
from ..run.progress import Progress

#: Nodes up to so many cells from a fold are moved, at first and then; of a fold with more of them, none is.
_LAYERS, MOST_NODES = (3, 9), 400
#: First trust radius over the extent of the nodes; the radius at which there is no way up; factors.
_RADIUS, _SMALLEST, _SHRINK, _GROW = 0.3, 1e-7, 0.2, 2.0
#: Seconds for one program: some that are badly scaled would not end.
_SECONDS = 0.5
#: It ends if so many programs have lifted the fold by less than this part of its depth.
_PATIENCE, _LITTLE = 6, 0.02


def lift(coordinates: Array, fixed: Mask, progress: Progress) -> bool:
    """Unfold what is left of a few folds, in place, each by itself; return whether the grid is valid.

    What does not lead to less folded cells is undone. Each program is told to `progress` as a step without an energy.
    """
    for layers in _LAYERS:
        before, folds = coordinates.copy(), Folds.of(coordinates)
        try:
            for free in surroundings(coordinates, fixed, layers):
                if free.sum() <= MOST_NODES:
                    Fold(coordinates, free).lift(progress)
        finally:
            if not Folds.of(coordinates) < folds:
                coordinates[...] = before
    return Folds.of(coordinates).cells == 0


def surroundings(coordinates: Array, fixed: Mask, layers: int) -> Iterator[npt.NDArray[np.bool_]]:
    """Return the free nodes (ni, nj) up to some cells from each fold at a corner with a free node."""
    from scipy.ndimage import binary_dilation, label

    folded = corner_jacobians(coordinates[0], coordinates[1]) <= 0
    cells = (folded & ~Folds.held_corners(fixed)).any(axis=0)
    nodes = np.zeros(fixed.shape, dtype=bool)
    for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
        nodes[i : i + cells.shape[0], j : j + cells.shape[1]] |= cells
    groups, count = label(binary_dilation(nodes, np.ones((3, 3)), iterations=layers), np.ones((3, 3)))
    for group in range(1, count + 1):
        yield (groups == group) & (fixed == 0)


class Fold:
    """The corners of cells that a few free nodes belong to, and the way to lift the smallest of their Jacobians."""

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
        self.place = self.planes[:, self.free].copy()
        self.extent = np.ptp(self.planes[:, np.unique(self.corners)], axis=1)
        self.size = float(np.abs(self._jacobians(self.place)).mean()) or 1.0

    def lift(self, progress: Progress) -> None:
        """Move the nodes until all Jacobians are positive, or until there is no way up."""
        radius, smallest = _RADIUS, float(self._jacobians(self.place).min())
        seen = [smallest]
        while smallest <= 0 and radius > _SMALLEST:
            step = self._program(radius, min(_SECONDS, progress.deadline.check()))
            length = 1.0
            while step is not None and length > _SHRINK:
                reached = float(self._jacobians(self.place + length * step).min())
                if reached > smallest:
                    break
                length /= 2
            else:
                radius *= _SHRINK
                continue
            self.place += length * step
            smallest = reached
            self.planes[:, self.free] = self.place
            seen.append(smallest)
            progress.step(0, float("nan"), float("nan"), smallest)
            radius = min(radius * (_GROW if length == 1.0 else length), _RADIUS)
            if len(seen) > _PATIENCE and smallest - seen[-1 - _PATIENCE] < -_LITTLE * seen[-1 - _PATIENCE]:
                break

    def _points(self, place: Array) -> Array:
        """Return the points (3, 2, corners) of the corners for a place of the free nodes."""
        planes = self.planes.copy()
        planes[:, self.free] = place
        return planes[:, self.corners].transpose(1, 0, 2)

    def _jacobians(self, place: Array) -> Array:
        a, b, c = self._points(place)
        one, two = b - a, c - b
        return np.asarray(one[0] * two[1] - one[1] * two[0])

    def _program(self, radius: float, seconds: float) -> Array | None:
        """Return the step (2, free nodes) that lifts the linearised Jacobians most, or None where none is found."""
        from scipy.optimize import linprog
        from scipy.sparse import coo_array

        points = self._points(self.place)
        jacobians, count = self._jacobians(self.place) / self.size, len(self.free)
        rows, columns, values = [], [], []
        for k in range(3):
            across = points[(k + 1) % 3] - points[(k + 2) % 3]
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
