"""The boundary in adaptation: the curves along which nodes slide, and springs that equidistribute the density there.

A front that meets the boundary needs nodes where it does. Newton's method moves them with the inner ones, as
`optimize(..., slide=...)` does. The functional alone would leave it open how area is shared along a side, and would cut
off bends; springs between the nodes of a side, weighted by the density, pull it to de Boor's equidistribution, in which
the integral of the density is the same between neighbors (C. de Boor, "Good approximation by splines with variable
knots", 1973).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.sides import Sides
from ..boundary.slide_curve import SlideCurve, sharp_turns
from ..grids import Grid
from ..solvers.sliding.side import side_index

Boundary = Literal["fixed", "straight", "all"]

#: How far from the line between its ends a straight stretch may be, over its length: round-off of its coordinates.
_STRAIGHT = 1e-9
#: The energy of a side's springs over that of the functional, where both are equidistributed. Errors are the least with
#: it, of the values tried from 1/40 to 25: with stiffer springs a side follows the density as if it were alone, with
#: weaker ones a front gets too few of its nodes.
_STIFFNESS = 0.25


def sliding_curves(grid: Grid, boundary: Boundary, fixed: npt.ArrayLike | None) -> dict[str, SlideCurve]:
    """Return the curves of the sides along which nodes may slide, by side.

    Fixed nodes are corners of these curves and stay; so are the turns of a side, and with `straight` all nodes that are
    not within a straight stretch.
    """
    curves = {}
    for name in Sides._fields if boundary != "fixed" else ():
        index = side_index(name, grid.shape)
        points = grid.planes[:, *index]
        stays = np.zeros(points.shape[1], dtype=bool) if fixed is None else np.asarray(fixed)[index] != 0
        stays |= staying(points, boundary)
        if not stays[1:-1].all():
            curves[name] = SlideCurve.of_points(points.T, 1 + np.flatnonzero(stays[1:-1]))
    return curves


def staying(points: Array, boundary: Boundary) -> npt.NDArray[np.bool_]:
    """Return which nodes (2, n) of a line stay: what is off straight stretches, or turns."""
    return _off_straight_stretches(points) if boundary == "straight" else sharp_turns(points.T)


@dataclass(slots=True)
class SideSpacing:
    """How the nodes of sliding sides are spaced.

    Attributes:
        curves: of the sides, by name.
        exponent: the power of the density that nodes are to equidistribute.
        wanted: (n - 1,) for each side, the density at its edges, damped as the weight is; at first that under which the
            start is equidistributed.
    """

    curves: Mapping[str, SlideCurve]
    exponent: float = 1.0
    wanted: dict[str, Array] = field(default_factory=dict)

    def toward(self, grid: Grid, density: Array, damping: float, energy: float) -> dict[str, SlideCurve]:
        """Return the curves with springs that go toward a density (ni, nj) at the nodes of a grid.

        Args:
            grid: whose boundary nodes are on the curves.
            density: of nodes.
            damping: how far to go from the last springs to those of the density, by geometric means; at most all of it.
            energy: of the functional, which gives the springs their size.
        """
        sprung = {}
        for name in self.curves:
            index = side_index(name, grid.shape)
            sprung[name] = self.sprung(name, grid.planes[:, *index], density[index], damping, energy)
        return sprung

    def sprung(self, name: str, points: Array, density: Array, damping: float, energy: float) -> SlideCurve:
        """Return the curve of a side with nodes (2, n) with springs that go toward a density (n,); see `toward`."""
        edges = np.hypot(*np.diff(points, axis=1))
        at_nodes = density**self.exponent
        new = _normalized((at_nodes[1:] + at_nodes[:-1]) / 2, edges)
        last = self.wanted.get(name, _normalized(1 / edges, edges))
        damped = last ** (1 - min(damping, 1.0)) * new ** min(damping, 1.0)
        self.wanted[name] = damped
        size = 2 * _STIFFNESS * energy * len(edges) / float(edges.sum()) ** 2
        return replace(self.curves[name], springs=size * _normalized(damped, edges))


def _normalized(density: Array, edges: Array) -> Array:
    """Return a density at edges over its mean along them."""
    return np.asarray(density * (edges.sum() / float((density * edges).sum())))


def _off_straight_stretches(points: Array) -> npt.NDArray[np.bool_]:
    """Return which points (2, n) are not within a straight stretch."""
    stays = np.ones(points.shape[1], dtype=bool)
    for first, last in straight_stretches(points):
        stays[first + 1 : last] = False
    return stays


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
