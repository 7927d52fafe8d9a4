"""Affine coordinates: they neither fold nor unfold a cell, but a functional sees another grid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Mask

#: A boundary that extends so much more one way than the other is looked at in stretched coordinates, too.
_THIN = 1.5
#: Coordinates in which the boundary extends evenly are stretched by these factors, in so many directions.
_STRETCHES, _DIRECTIONS = (3.0, 10.0), 4


@dataclass(frozen=True, slots=True)
class Frame:
    """Affine coordinates: `matrix` (2, 2), if any, times what is left of a point when `center` (2,) is taken away."""

    matrix: Array | None
    center: Array

    def of(self, coordinates: Array) -> Array:
        """Return coordinates (2, ni, nj) in this frame, a copy."""
        if self.matrix is None:
            return coordinates.copy()
        return np.ascontiguousarray(np.tensordot(self.matrix, coordinates - self.center[:, None, None], axes=1))

    def back(self, coordinates: Array, like: Array, fixed: Mask) -> Array:
        """Return them from this frame, with the fixed nodes bit by bit as in `like`."""
        if self.matrix is None:
            return coordinates
        there = np.tensordot(np.linalg.inv(self.matrix), coordinates, axes=1) + self.center[:, None, None]
        return np.where(fixed != 0, like, there)


def frames(coordinates: Array) -> Iterator[Frame]:
    """Return the coordinates to search in: as they are, and, for a thin boundary, with its extent made even."""
    yield Frame(None, np.zeros(2))
    center, axes, extents = _boundary_extents(coordinates)
    if extents[1] > _THIN * extents[0] > 0:
        yield Frame(axes @ np.diag(extents[1] / extents) @ axes.T, center)


def stretched_frames(coordinates: Array) -> Iterator[Frame]:
    """Return coordinates in which the boundary extends evenly, and these stretched; all areas stay as they are."""
    center, axes, extents = _boundary_extents(coordinates)
    if not extents[0] > 0:
        return
    even = np.diag(np.sqrt([extents[1] / extents[0], extents[0] / extents[1]]))
    yield Frame(axes @ even @ axes.T, center)
    for stretch in _STRETCHES:
        for angle in np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS:
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            stretched = turn @ np.diag([np.sqrt(stretch), 1 / np.sqrt(stretch)]) @ turn.T
            yield Frame(axes @ stretched @ even @ axes.T, center)


def _boundary_extents(coordinates: Array) -> tuple[Array, Array, Array]:
    """Return the center of the boundary nodes, the axes along which they extend least and most (columns), and how far.

    How far is told in units of their size.
    """
    sides = coordinates[:, :, 0], coordinates[:, :, -1], coordinates[:, 0], coordinates[:, -1]
    boundary = np.concatenate(sides, axis=1)
    center, size = boundary.mean(axis=1), float(np.ptp(boundary)) or 1.0
    spread, axes = np.linalg.eigh(np.cov((boundary - center[:, None]) / size))
    return center, axes, np.sqrt(np.maximum(spread, 0.0))
