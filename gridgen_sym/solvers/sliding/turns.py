"""Which nodes hold the sharp turns of sliding sides: sides without turns first, and then the nodes nearest to turns.

A grid that is nearly conformal has its boundary nodes where the map has them; nodes that stay at turns from the start
on force others upon it. So nodes slide first along curves that round the turns off, and the order of turns and nodes
along a side tells which node belongs to which turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...boundary.polygon import first_crossing
from ...boundary.slide_curve import SlideCurve, slide_curve
from ...grids import Grid
from ...grids.grid import boundary_indices
from ..harmonic import move_sides
from .side import AT_CORNER, side_index

Lines = tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]

#: Where the boundary crosses itself when nodes are moved to turns, they move this part of their way only.
_PARTS = (1.0, 0.75, 0.5, 0.25)


@dataclass(frozen=True, slots=True, eq=False)
class TurnedSide:
    """A sliding side with sharp turns that nodes hold.

    Attributes:
        curve: of the side.
        at: the parameters (n,) of the start's nodes on it.
        turns: the numbers of the nodes that hold turns, and of the two ends.
        lines: (m,), some nodes of the start, also the two ends.
        rounded: a cubic B-spline whose control points are these nodes: it follows them without their turns, and does
            not swing out.
        places: (m,), where they belong on it.
    """

    curve: SlideCurve
    at: Array
    turns: Array
    lines: npt.NDArray[np.intp]
    rounded: SlideCurve
    places: Array

    @classmethod
    def of(cls, curve: SlideCurve, nodes: Array, lines: npt.NDArray[np.intp]) -> TurnedSide | None:
        """Return the side of nodes (n, 2) on a curve; None without turns between the ends."""
        if len(curve.corners) == 2:
            return None
        at = curve.nearest(nodes)
        turns = np.flatnonzero(np.abs(at[:, None] - curve.corners).min(axis=1) < AT_CORNER)
        inner = turns[(turns > 0) & (turns < len(nodes) - 1)]
        if not len(inner) or len(lines) < 4:
            return None
        from scipy.interpolate import BSpline

        knots = np.concatenate(([0.0] * 3, np.linspace(0, 1, len(lines) - 2), [1.0] * 3))
        places = (knots[1:-3] + knots[2:-2] + knots[3:-1]) / 3
        rounded = slide_curve(BSpline(knots, nodes[lines], 3))
        return cls(curve, at, np.concatenate(([0.0], inner, [len(nodes) - 1.0])), lines, rounded, places)

    def stays(self, found: Array) -> bool:
        """Whether the nearest nodes are those that hold the turns now, as exactly as `lines` can tell.

        Args:
            found: (m, 2), nodes on the rounded curve.
        """
        away = np.abs(nearest_in_order(self._counted(found, 1.0), self.turns) - self.turns)
        return bool(away.max() < np.diff(self.lines).max())

    def move(self, found: Array, part: float) -> Array:
        """Return nodes (n, 2) on the curve of which the nearest ones hold the turns.

        Args:
            found: (m, 2), nodes on the rounded curve.
            part: of the way from the start's nodes to those.
        """
        place = self._counted(found, part)
        along = _between(place, nearest_in_order(place, self.turns), self.turns)
        return self.curve.point(np.interp(along, np.arange(len(self.at)), self.at))

    def _counted(self, found: Array, part: float) -> Array:
        """Return where nodes are between those of the start, by their numbers."""
        count = np.arange(len(self.at), dtype=np.float64)
        to = np.maximum.accumulate(np.interp(self.rounded.nearest(found), self.places, self.lines))
        return np.asarray(part * np.interp(count, self.lines, to) + (1 - part) * count)


def turned_sides(grid: Grid, curves: Mapping[str, SlideCurve], lines: Lines) -> dict[str, TurnedSide]:
    """Return the sliding sides whose nodes hold sharp turns between the corners of the grid.

    Args:
        grid: with its nodes on the curves.
        curves: of the sliding sides.
        lines: of xi and of eta, whose ends are control points of the rounded curves.
    """
    found = {
        name: TurnedSide.of(curve, grid.xy[side_index(name, grid.shape)], lines[name in ("left", "right")])
        for name, curve in curves.items()
    }
    return {name: side for name, side in found.items() if side is not None}


def nearest_in_order(place: Array, turns: Array) -> Array:
    """Return for every turn the index of a node, so that the sum of the distances is least and the order is kept.

    Args:
        place: (n,), of the nodes, increasing.
        turns: (m,), of the turns; the first and the last belong to the first and the last node.
    """
    apart = np.abs(place - turns[:, None])
    cost = np.full_like(apart, np.inf)
    cost[0, 0] = 0.0
    for k in range(1, len(turns)):
        cost[k, 1:] = np.minimum.accumulate(cost[k - 1])[:-1] + apart[k, 1:]
    node = len(place) - 1
    chosen = [node]
    for row in cost[-2::-1]:
        node = int(row[:node].argmin())
        chosen.append(node)
    return np.array(chosen[::-1])


def on_side(name: str, grid: Array) -> Array:
    """Return the nodes (n, 2) of a side of a grid (2, ni, nj)."""
    return grid[:, *side_index(name, grid.shape[1:])].T


def with_turns(start: Grid, coarse: Array, lines: Lines, sides: Mapping[str, TurnedSide]) -> Array | None:
    """Return a grid (2, ni, nj) whose nearest nodes hold the turns; None where its boundary would cross itself.

    Args:
        start: the grid before nodes slid along rounded sides.
        coarse: (2, mi, mj), the lines of the grid after it; those between them are interpolated.
        lines: of xi and of eta.
        sides: those with turns.
    """
    across = [
        np.array([np.interp(np.arange(n), of, e) for e in np.eye(len(of))])
        for n, of in zip(start.shape, lines, strict=True)
    ]
    ring = boundary_indices(*start.shape)
    between = np.einsum("aIJ,Ii,Jj->aij", coarse, *across, optimize=True)
    for part in _PARTS:
        moved = between.copy()
        for name, side in sides.items():
            moved[:, *side_index(name, start.shape)] = side.move(on_side(name, coarse), part).T
        if first_crossing(moved[:, ring[:, 0], ring[:, 1]].T) is None:
            return move_sides(between, moved)
    return None


def _between(place: Array, holders: Array, turns: Array) -> Array:
    """Return where nodes are, counted in nodes of the start: holders at their turns, others by their shares between."""
    along = np.empty_like(place)
    for k in range(len(turns) - 1):
        nodes = slice(int(holders[k]), int(holders[k + 1]) + 1)
        length = place[nodes][-1] - place[nodes][0]
        count = nodes.stop - nodes.start
        share = (place[nodes] - place[nodes][0]) / length if length > 0 else np.linspace(0, 1, count)
        along[nodes] = turns[k] + share * (turns[k + 1] - turns[k])
    return along
