"""The boundary in adaptation: nodes slide along straight stretches of the sides, and equidistribute the density there.

A front that meets the boundary needs nodes where it does. On a curve, de Boor's equidistribution is exact: with the
integral of the density along the curve as the new coordinate, the nodes are evenly spaced (C. de Boor, "Good
approximation by splines with variable knots", 1973). Nodes at the turns of a side stay, so that the domain keeps its
shape.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array, Mask
from ..grids import Grid, quality
from ..solvers.multilevel.prolongation import from_boundary

Boundary = Literal["fixed", "straight", "all"]

#: Where the nodes of the four sides are in an array (ni, nj).
_SIDE_NODES: tuple[Any, ...] = (np.s_[:, 0], np.s_[-1, :], np.s_[:, -1], np.s_[0, :])
#: How far from the line between its ends a straight stretch may be, over its length: round-off of its coordinates.
_STRAIGHT = 1e-9
#: How often a step that would fold a cell is halved.
_HALVINGS = 8


@dataclass(slots=True)
class Side:
    """A side or a stretch of one: the polygon of the start, and where the nodes now are on it; both ends stay.

    Attributes:
        index: of its nodes in an array (ni, nj).
        polygon: (2, n), the nodes of the start.
        length: (n,), the arc length of each of its points.
        at: (n,), the arc length of each node.
    """

    index: Any
    polygon: Array
    length: Array
    at: Array

    def nodes(self, at: Array) -> Array:
        """Return the points (2, n) at arc lengths of the polygon."""
        return np.stack([np.interp(at, self.length, plane) for plane in self.polygon])

    def wanted(self, density: Array) -> Array:
        """Return where the nodes are evenly spaced in the integral of the density, (n,) along the present nodes."""
        integral = np.concatenate(([0.0], np.cumsum(np.diff(self.at) * (density[1:] + density[:-1]) / 2)))
        return np.interp(np.linspace(0.0, integral[-1], len(integral)), integral, self.at)


def sliding_sides(grid: Grid, boundary: Boundary, fixed: npt.ArrayLike | None) -> list[Side]:
    """Return the stretches of the boundary along which nodes may slide.

    They are none, the straight ones of every side, or all four sides; without those that have a fixed node inside.
    """
    sides = []
    for side in _SIDE_NODES if boundary != "fixed" else ():
        points = grid.planes[(slice(None), *side)]
        stretches = [(0, points.shape[1] - 1)] if boundary == "all" else straight_stretches(points)
        for first, last in stretches:
            part = tuple(slice(first, last + 1) if isinstance(one, slice) else one for one in side)
            if fixed is None or not np.asarray(fixed)[part][1:-1].any():
                polygon = points[:, first : last + 1].copy()
                length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(polygon, axis=1)))))
                sides.append(Side(part, polygon, length, length.copy()))
    return sides


def slide(sides: list[Side], grid: Grid, density: Array, fixed: Mask, damping: float) -> Grid:
    """Return the grid with its boundary nodes moved toward equidistribution, and the free inner nodes carried along.

    A step that would fold a cell is halved, and not taken at all if that does not help.
    """
    targets = [side.wanted(density[side.index]) for side in sides]
    for _ in range(_HALVINGS if sides else 0):
        arcs = [side.at + damping * (target - side.at) for side, target in zip(sides, targets, strict=True)]
        move = np.zeros_like(grid.planes)
        for side, at in zip(sides, arcs, strict=True):
            planes = (slice(None), *side.index)
            move[planes] = side.nodes(at) - grid.planes[planes]
        inner = from_boundary(move)[:, 1:-1, 1:-1]
        move[:, 1:-1, 1:-1] = np.where(fixed[1:-1, 1:-1], 0.0, inner)
        moved = Grid.from_planes(*(grid.planes + move))
        if quality(moved).valid:
            for side, at in zip(sides, arcs, strict=True):
                side.at = at
            return moved
        damping /= 2
    return grid


def straight_stretches(points: Array) -> Iterator[tuple[int, int]]:
    """Yield the first and the last index of every longest straight stretch of a polygon (2, n) with a node inside."""
    first, end = 0, points.shape[1] - 1
    while first < end:
        last = _end_of_stretch(points, first)
        if last > first + 1:
            yield first, last
        first = last


def _end_of_stretch(points: Array, first: int) -> int:
    """Return the index of the last point that is reached straight from point `first`.

    By doubling, then by bisection: a turn in a part of a stretch would show in the whole.
    """
    end, straight, step = points.shape[1] - 1, first + 1, 2
    while straight < end and _straight(points[:, first : first + step + 1]):
        straight, step = min(first + step, end), 2 * step
    bent = min(first + step, end + 1)
    while bent - straight > 1:
        middle = (straight + bent) // 2
        straight, bent = (middle, bent) if _straight(points[:, first : middle + 1]) else (straight, middle)
    return straight


def _straight(polygon: Array) -> bool:
    """Return whether a polygon (2, n) runs straight and only forwards."""
    along = polygon[:, -1] - polygon[:, 0]
    reach = float(np.hypot(*along))
    if reach == 0:
        return False
    steps = polygon - polygon[:, :1]
    off = np.abs(along[0] * steps[1] - along[1] * steps[0]).max() / reach
    forwards = bool((np.diff(along[0] * steps[0] + along[1] * steps[1]) > 0).all())
    return forwards and bool(off <= _STRAIGHT * reach)
