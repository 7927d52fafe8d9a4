"""The four sides of a boundary, in the order of the whole package: bottom, right, top, left, counter-clockwise."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from ..arrays import Array
from ..grids.grid import Grid
from ..grids.transfinite import transfinite

Each = TypeVar("Each")


class Sides(NamedTuple, Generic[Each]):
    """One thing for each side: a curve, or its nodes.

    The order is counter-clockwise; every side runs as a grid's does, bottom and top along xi, right and left along eta.
    """

    bottom: Each
    right: Each
    top: Each
    left: Each


def sides_of_ring(pieces: Iterable[Array]) -> Sides[Array]:
    """Return the sides from four pieces of a boundary, each (n, 2), that follow each other counter-clockwise."""
    bottom, right, top, left = pieces
    return Sides(bottom, right, top[::-1], left[::-1])


def ring_of_sides(sides: Sides[Array]) -> Array:
    """Return the boundary nodes counter-clockwise from corner (0, 0), shape (2 (ni + nj) - 4, 2), each once."""
    return np.concatenate((sides.bottom[:-1], sides.right[:-1], sides.top[:0:-1], sides.left[:0:-1]))


def grid_of_sides(sides: Sides[Array]) -> Grid:
    """Return the transfinite grid between the nodes of the sides; see `transfinite` for its errors."""
    return transfinite(bottom=sides.bottom, top=sides.top, left=sides.left, right=sides.right)
