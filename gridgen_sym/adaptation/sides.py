"""The boundary in adaptation: nodes slide along the sides of the start, so that the density rules there too.

A front that meets the boundary needs nodes where it does. On a side, de Boor's equidistribution is exact: with the
integral of the density along the side as the new coordinate, the nodes are evenly spaced (C. de Boor, "Good
approximation by splines with variable knots", 1973).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array, Mask
from ..grids import Grid, quality
from ..solvers.multilevel.prolongation import from_boundary

Boundary = Literal["fixed", "straight", "all"]

#: Where the nodes of the four sides stand in an array (ni, nj).
_PLACES: tuple[Any, ...] = (np.s_[:, 0], np.s_[:, -1], np.s_[0, :], np.s_[-1, :])
#: How far from the line between its ends a straight side may be, over its length; how often a step is halved.
_STRAIGHT, _HALVINGS = 1e-9, 8


@dataclass(slots=True)
class Side:
    """One side: the polygon of the start, and where the nodes now are on it.

    Attributes:
        place: indices of its nodes.
        polygon: (2, n), the nodes of the start.
        length: (n,), the way along the polygon to each of its points.
        at: (n,), the way along the polygon to each node.
    """

    place: Any
    polygon: Array
    length: Array
    at: Array

    def nodes(self, at: Array) -> Array:
        """Return the points (2, n) at ways along the polygon."""
        return np.stack([np.interp(at, self.length, plane) for plane in self.polygon])

    def wanted(self, density: Array) -> Array:
        """Return where the nodes are evenly spaced in the integral of the density, (n,) along the present nodes."""
        integral = np.concatenate(([0.0], np.cumsum(np.diff(self.at) * (density[1:] + density[:-1]) / 2)))
        return np.interp(np.linspace(0.0, integral[-1], len(integral)), integral, self.at)


def sliding_sides(grid: Grid, boundary: Boundary, fixed: npt.ArrayLike | None) -> list[Side]:
    """Return the sides on which nodes may slide: none, the straight ones, or all without nodes that are fixed."""
    sides = []
    for place in _PLACES:
        polygon = grid.planes[(slice(None), *place)].copy()
        length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(polygon, axis=1)))))
        held = fixed is not None and bool(np.asarray(fixed)[place][1:-1].any())
        if boundary != "fixed" and not held and (boundary == "all" or _straight(polygon)):
            sides.append(Side(place, polygon, length, length.copy()))
    return sides


def slide(sides: list[Side], grid: Grid, density: Array, fixed: Mask, damping: float) -> Grid:
    """Return the grid with its boundary nodes moved towards equidistribution, and the free inner nodes carried along.

    A step that would fold a cell is halved, and not taken at all if that does not help.
    """
    targets = [side.wanted(density[side.place]) for side in sides]
    for _ in range(_HALVINGS if sides else 0):
        places = [side.at + damping * (target - side.at) for side, target in zip(sides, targets, strict=True)]
        move = np.zeros_like(grid.planes)
        for side, at in zip(sides, places, strict=True):
            place = (slice(None), *side.place)
            move[place] = side.nodes(at) - grid.planes[place]
        inner = from_boundary(move)[:, 1:-1, 1:-1]
        move[:, 1:-1, 1:-1] = np.where(fixed[1:-1, 1:-1], 0.0, inner)
        moved = Grid.from_planes(*(grid.planes + move))
        if quality(moved).valid:
            for side, at in zip(sides, places, strict=True):
                side.at = at
            return moved
        damping /= 2
    return grid


def _straight(polygon: Array) -> bool:
    """Return whether a side runs straight; that of a valid grid then runs forwards only."""
    along = polygon[:, -1] - polygon[:, 0]
    reach = float(np.hypot(*along))
    if reach == 0:
        return False
    steps = polygon - polygon[:, :1]
    off = np.abs(along[0] * steps[1] - along[1] * steps[0]).max() / reach
    return bool(off <= _STRAIGHT * reach)
