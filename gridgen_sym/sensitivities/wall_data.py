"""Walls as they were given: derivatives in their data and in the boundary, and the target's changes with these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, real_array
from ..boundary.sides import Sides
from ..boundary.wall import Wall
from ..errors import GridgenError, quoted
from ..fields.wall_cells import WallCells, wall_cells
from .wall_lines import STEP, LineLaws, difference, laws_of
from .walls import in_wall_cells

Walls = Sides[Wall | None]


@dataclass(frozen=True, slots=True, eq=False)
class WallGradient:
    """The derivatives of a number in what was asked of one wall, each in the form in which that was given.

    Attributes:
        first: in the first heights.
        growth: in the growth; None without one.
    """

    first: Array
    growth: Array | None


class WallData:
    """The walls of one block.

    First heights that were corrected are what was asked for times factors, which are held.

    Attributes:
        asked: of the four sides.
        used: the same with corrected first heights.
        place: (2, ni, nj), the start, whose boundary the cells are for.
    """

    def __init__(self, asked: Walls, used: Walls, place: Array) -> None:
        """Take the walls and the start."""
        self.asked, self.used, self.place = asked, used, place
        self._shape: tuple[int, int] = (place.shape[1], place.shape[2])

    # ---- derivatives ----

    def derivatives(self, in_matrix: Sequence[Array]) -> tuple[dict[str, WallGradient], Array]:
        """Return the derivatives in walls, by side, and in the boundary (2, ni, nj).

        Args:
            in_matrix: those in the entries of the target W, row by row, corners counter-clockwise.
        """
        cells, (in_xi, in_second, _, in_fourth) = self._used_cells, in_matrix
        cosine, sine = np.cos(cells.angle), np.sin(cells.angle)
        in_eta = cosine * in_second + sine * in_fourth
        in_angle = cells.along_eta * (cosine * in_fourth - sine * in_second)
        found, in_place = in_wall_cells(self._laws, self.place, in_xi, in_eta, in_angle)
        gradients = {}
        for side, asked, one in zip(Sides._fields, self.asked, found, strict=True):
            if asked is not None and one is not None:
                count = self._count(side)
                first = _as_given(one.first * self._factor(side), asked.first, asked, count)
                growth = None if asked.growth is None else _as_given(one.growth, asked.growth, asked, count)
                gradients[side] = WallGradient(first, growth)
        return gradients, in_place

    # ---- changes ----

    def along(self, walls: Mapping[str, Any], boundary: Array) -> list[Array]:
        """Return the change of the target's entries, row by row, corners counter-clockwise.

        Args:
            walls: changes by side, each a mapping with `first`, `growth` or both.
            boundary: (2, ni, nj), the change of the nodes of the start.
        """
        moved = {side: self._change(side, dict(change)) for side, change in walls.items()}
        relative = [np.abs(boundary).max() / self._shortest()]
        for side, (first, growth) in moved.items():
            wall = getattr(self.used, side)
            relative += [
                np.abs(first / wall.first).max(),
                0.0 if growth is None else np.abs(growth / wall.growth).max(),
            ]
        scale = max(map(float, relative))
        if scale == 0:
            return [np.zeros((4, self._shape[0] - 1, self._shape[1] - 1))] * 4

        def matrix(t: float) -> Array:
            sides = {side: _moved(getattr(self.used, side), t, *change) for side, change in moved.items()}
            return self._cells(self.used._replace(**sides), self.place + t * boundary).matrix()

        return list(difference(matrix, STEP / scale))

    def _change(self, side: str, change: dict[str, Any]) -> tuple[Array, Array | None]:
        """Return the change of the first heights and the growth of the wall that is used."""
        asked = getattr(self.asked, side, None)
        if asked is None:
            raise GridgenError(f"there is no wall at {quoted(side)} along which the grid could change")
        unknown = set(change) - {"first", "growth"}
        if unknown or (asked.growth is None and "growth" in change):
            raise GridgenError(
                f"the change of the wall at {side} is of first, and of growth where it has one; came {sorted(change)}"
            )
        count = self._count(side)
        first = asked.along(real_array(change.get("first", 0.0), "the change of first"), count, "the change of first")[
            1
        ]
        growth = None
        if "growth" in change:
            growth = asked.along(change["growth"], count, "the change of growth")[1]
        return first * self._factor(side), growth

    # ---- both ----

    @cached_property
    def _laws(self) -> tuple[LineLaws, LineLaws]:
        return laws_of(self.used, self.place)

    @cached_property
    def _used_cells(self) -> WallCells:
        return self._cells(self.used, self.place)

    def _cells(self, walls: Walls, place: Array) -> WallCells:
        return wall_cells(walls, place, self._shape)

    def _count(self, side: str) -> int:
        ni, nj = self._shape
        return ni if side in ("bottom", "top") else nj

    def _factor(self, side: str) -> Array:
        """Return by what factors the first heights of a wall were corrected, at its nodes."""
        asked, used, count = getattr(self.asked, side), getattr(self.used, side), self._count(side)
        return np.asarray(used.along(used.first, count, "first")[1] / asked.along(asked.first, count, "first")[1])

    def _shortest(self) -> float:
        """Return the length of the shortest edge of the boundary."""
        place = self.place
        sides = place[:, :, 0], place[:, :, -1], place[:, 0], place[:, -1]
        return min(float(np.hypot(*np.diff(side, axis=1)).min()) for side in sides)


def _moved(wall: Wall, t: float, first: Array, growth: Array | None) -> Wall:
    """Return a wall whose data have changed, at its nodes."""
    if growth is None:
        return replace(wall, first=wall.first + t * first)
    return replace(wall, first=wall.first + t * first, growth=wall.growth + t * growth)


def _as_given(at_nodes: Array, given: Any, wall: Wall, count: int) -> Array:  # noqa: ANN401
    """Return derivatives at the nodes of a wall in the form of what was given there: a number, or one for each node."""
    if np.ndim(given) == 0:
        return np.asarray(at_nodes.sum())
    if np.shape(given) == at_nodes.shape:
        return at_nodes
    whole = np.zeros(count)
    whole[wall.along(1.0, count, "first")[0]] = at_nodes
    return whole
