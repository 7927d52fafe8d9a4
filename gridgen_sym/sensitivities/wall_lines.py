"""The laws of lines between opposite sides of which one or both are walls, and how they change with what is asked."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..boundary.laws import vinokur, vinokur_slopes
from ..boundary.sides import Sides
from ..boundary.wall import Wall
from ..fields.wall_fractions import Lines, both_grow, law_of_lines, lines_between, side_fractions

#: Factors of differences of the sixth and of the fourth order, and their step over what is changed.
SIXTH, _FOURTH = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)), ((1, 2 / 3), (2, -1 / 12))
STEP = 1e-3


def difference(
    function: Callable[[float], Array], step: float, factors: tuple[tuple[int, float], ...] = SIXTH
) -> Array:
    """Return the derivative of a function of a number at zero, by differences."""
    total = sum(factor * (function(k * step) - function(-k * step)) for k, factor in factors)
    return np.asarray(total / step)


class LineLaws:
    """Lines along the last axis, from one side (low) to the opposite one (high).

    Attributes:
        walls: the low and the high one.
        lines: what is asked of every line.
        walled: whether a side is a wall.
        fractions: (n, m), at the nodes of the lines.
    """

    def __init__(self, low: Wall | None, high: Wall | None, place: Array) -> None:
        """Take the walls and coordinates (2, n, m), of which the boundary is used."""
        self.walls, self._cells, self._place = (low, high), place.shape[2] - 1, place
        self.lines = lines_between(low, high, place, (place.shape[1], place.shape[2]))
        self.walled = low is not None or high is not None
        self.fractions = self._law(self.lines) if self.walled else side_fractions(place)

    def _law(self, lines: Lines) -> Array:
        return law_of_lines(*self.walls, lines, self._cells)

    @cached_property
    def along(self) -> dict[str, Array]:
        """How the fractions (n, m) of every line change with each of the things that are asked of it, by name."""
        found = self._along_of_two_ends()
        if found is None:
            found = {name: self._difference(name) for name in Lines._fields if name != "length" and self._asked(name)}
        # Laws are of heights over the length of the line.
        heights = (getattr(self.lines, name)[:, None] * found[name] for name in ("first", "last") if name in found)
        return found | {"length": -sum(heights) / self.lines.length[:, None]}

    def _asked(self, name: str) -> bool:
        return getattr(self.lines, name) is not None

    def _along_of_two_ends(self) -> dict[str, Array] | None:
        """Return the same of Vinokur's law between two walls, by its slopes at the ends; None where it does not hold.

        The slopes are such that the end cells have the lengths that are asked for.
        """
        low, high = self.walls
        length, first, _, last, _ = self.lines
        if low is None or high is None or first is None or last is None or both_grow(low, high, self._place):
            return None
        slope, other = vinokur_slopes(first / length, last / length, self._cells)
        moves = (
            difference(lambda t: vinokur(slope * (1 + t), other, self._cells), STEP, _FOURTH),
            difference(lambda t: vinokur(slope, other * (1 + t), self._cells), STEP, _FOURTH),
        )
        (a, b), (c, d) = ((one[:, 1], one[:, -1] - one[:, -2]) for one in moves)
        determinant = (a * d - b * c) * length
        of_first = (d[:, None] * moves[0] - b[:, None] * moves[1]) / determinant[:, None]
        of_last = (a[:, None] * moves[1] - c[:, None] * moves[0]) / determinant[:, None]
        return {"first": of_first, "last": of_last}

    def _difference(self, name: str) -> Array:
        asked = getattr(self.lines, name)
        moved = difference(lambda t: self._law(self.lines._replace(**{name: asked * (1 + t)})), STEP, _FOURTH)
        return np.asarray(moved / asked[:, None])


def laws_of(walls: Sides[Wall | None], place: Array) -> tuple[LineLaws, LineLaws]:
    """Return the laws of the lines along eta, and of those along xi, between the sides of coordinates (2, ni, nj)."""
    turned = place.transpose(0, 2, 1)
    return LineLaws(walls.bottom, walls.top, place), LineLaws(walls.left, walls.right, turned)
