"""Affine maps of a grid: they neither fold nor unfold a cell, but a functional sees another grid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Mask

#: A boundary whose longest extent is so many times the shortest is also searched in balanced coordinates.
_THIN = 1.5
#: Balanced coordinates are stretched by these factors, in so many directions.
_STRETCHES, _DIRECTIONS = (3.0, 10.0), 4


@dataclass(frozen=True, slots=True)
class AffineMap:
    """A map of points: `matrix` (2, 2) times their difference from `center` (2,); the identity if `matrix` is None."""

    matrix: Array | None
    center: Array

    def apply(self, coordinates: Array) -> Array:
        """Return mapped coordinates (2, ni, nj), a copy."""
        if self.matrix is None:
            return coordinates.copy()
        return np.ascontiguousarray(np.tensordot(self.matrix, coordinates - self.center[:, None, None], axes=1))

    def invert(self, coordinates: Array, like: Array, fixed: Mask) -> Array:
        """Return the points that are mapped to `coordinates`, with the fixed nodes bit by bit as in `like`."""
        if self.matrix is None:
            return coordinates
        points = np.tensordot(np.linalg.inv(self.matrix), coordinates, axes=1) + self.center[:, None, None]
        return np.where(fixed != 0, like, points)


def balanced_maps(coordinates: Array) -> Iterator[AffineMap]:
    """Return the identity and, for a thin boundary, the map that makes its extents equal."""
    yield AffineMap(None, np.zeros(2))
    center, axes, extents = _boundary_extents(coordinates)
    if extents[1] > _THIN * extents[0] > 0:
        yield AffineMap(axes @ np.diag(extents[1] / extents) @ axes.T, center)


def stretched_maps(coordinates: Array) -> Iterator[AffineMap]:
    """Return the map that makes the boundary's extents equal, and this map stretched; all of them keep areas."""
    center, axes, extents = _boundary_extents(coordinates)
    if not extents[0] > 0:
        return
    balanced = np.diag(np.sqrt([extents[1] / extents[0], extents[0] / extents[1]]))
    yield AffineMap(axes @ balanced @ axes.T, center)
    for stretch in _STRETCHES:
        for angle in np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS:
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            stretched = turn @ np.diag([np.sqrt(stretch), 1 / np.sqrt(stretch)]) @ turn.T
            yield AffineMap(axes @ stretched @ balanced @ axes.T, center)


def _boundary_extents(coordinates: Array) -> tuple[Array, Array, Array]:
    """Return the center of the boundary nodes, their principal axes (columns), and the extents along these.

    The shortest extent comes first; extents are over the size of the boundary.
    """
    sides = coordinates[:, :, 0], coordinates[:, :, -1], coordinates[:, 0], coordinates[:, -1]
    boundary = np.concatenate(sides, axis=1)
    center, size = boundary.mean(axis=1), float(np.ptp(boundary)) or 1.0
    spread, axes = np.linalg.eigh(np.cov((boundary - center[:, None]) / size))
    return center, axes, np.sqrt(np.maximum(spread, 0.0))
