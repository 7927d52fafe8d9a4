"""Where the nodes of lines between opposite sides are, one or both of which are walls: fractions of their lengths."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.laws import growing_from_both, two_ended
from ..boundary.wall import Wall


class Lines(NamedTuple):
    """What walls ask of lines between two opposite sides, of which one or both are walls.

    Attributes:
        length: of every line, (m,).
        first, growth: the height of the first cell at the low side, and the factor from one height to the next, (m,);
            None where that is no wall, or has no growth.
        last, growth_last: the same at the high side.
    """

    length: Array
    first: Array | None
    growth: Array | None
    last: Array | None
    growth_last: Array | None


def fractions_between(low: Wall | None, high: Wall | None, coordinates: Array, home: tuple[int, int]) -> Array | None:
    """Return the fractions (ni, nj) of the lines along the last axis between two sides, walls or not."""
    if low is None and high is None:
        return None
    law = law_of_lines(low, high, lines_between(low, high, coordinates, home), home[1] - 1)
    return _sampled(law, coordinates.shape[2])


def both_grow(low: Wall, high: Wall, coordinates: Array) -> bool:
    """Return whether cells grow by their growth from both of two opposite walls; else Vinokur's law holds."""
    shape = coordinates.shape[1], coordinates.shape[2]
    return _growing_between(lines_between(low, high, coordinates, shape), shape[1] - 1) is not None


def lines_between(low: Wall | None, high: Wall | None, coordinates: Array, home: tuple[int, int]) -> Lines:
    """Return what walls ask of the lines along the last axis, from the values at the nodes of the sides at home."""
    length = distances(coordinates)
    ends = _ends(coordinates, home[1] - 1)
    first = growth = last = growth_last = None
    if low is not None:
        first, growth = _at_lines(low, length, ends[0], home[0], coordinates[:, :, 0])
    if high is not None:
        last, growth_last = _at_lines(high, length, ends[1], home[0], coordinates[:, :, -1])
    return Lines(length, first, growth, last, growth_last)


def law_of_lines(low: Wall | None, high: Wall | None, lines: Lines, cells: int) -> Array:
    """Return the fractions at the nodes of lines with so many cells, (m, cells + 1), each by what is asked of it."""
    length, first, growth, last, growth_last = lines
    if first is not None and last is not None:
        law = _growing_between(lines, cells)
        return two_ended(first / length, last / length, cells) if law is None else law
    if low is not None and first is not None:
        return low.fractions(length, first, growth, cells)
    assert high is not None
    assert last is not None
    return 1 - high.fractions(length, last, growth_last, cells)[:, ::-1]


def _growing_between(lines: Lines, cells: int) -> Array | None:
    """Return the fractions of cells that grow from both walls; None where one has no growth, or it does not fit."""
    length, first, growth, last, growth_last = lines
    if first is None or last is None or growth is None or growth_last is None:
        return None
    return growing_from_both(first / length, growth, last / length, growth_last, cells)


def _ends(coordinates: Array, cells: int) -> tuple[Array, Array]:
    """Return the first and last cells of the sides' own lines, as they would be on a grid of so many cells."""
    own, step = side_fractions(coordinates), (coordinates.shape[2] - 1) / max(cells, 1)
    return own[:, 1] * step, (1 - own[:, -2]) * step


def _at_lines(wall: Wall, length: Array, ends: Array, count: int, side: Array) -> tuple[Array, Array | None]:
    """Return the first height and the growth at every line, from the values at the nodes of a side at home.

    Beside a wall that is a part of the side, growth is that at the wall's end.
    """
    index, first = wall.along(wall.first, count, "first")
    edges, beyond = np.hypot(*np.diff(side, axis=1)), (ends[0] * length[0], ends[-1] * length[-1])
    first_at = heights_along(index, first, edges, beyond, count)
    if wall.growth is None:
        return first_at, None
    index, growth = wall.along(wall.growth, count, "growth")
    return first_at, np.interp(np.linspace(0, count - 1, len(length)), index, growth)


def heights_along(
    index: npt.NDArray[np.intp], first: Array, edges: Array, ends: tuple[float, float], count: int
) -> Array:
    """Return the first heights at every line.

    Beside a wall that is a part of the side they pass geometrically, with the arc length, to those of the side's ends.

    Args:
        index: of the wall's nodes, of `count` ones of the side at home.
        first: the heights there.
        edges: the lengths of the edges between the lines.
        ends: the heights at the ends of the side.
        count: nodes of the side at home.
    """
    arc = np.concatenate(([0.0], np.cumsum(edges)))
    known, heights = index.astype(float), np.log(first)
    place = np.interp(known, np.linspace(0, count - 1, len(arc)), arc)
    if known[0] > 0:
        place, heights = np.append(arc[0], place), np.append(np.log(ends[0]), heights)
    if known[-1] < count - 1:
        place, heights = np.append(place, arc[-1]), np.append(heights, np.log(ends[1]))
    return np.asarray(np.exp(np.interp(arc, place, heights)))


def _sampled(law: Array, count: int) -> Array:
    """Return fractions at the nodes of a line at home, evaluated at so many nodes."""
    cells = law.shape[1] - 1
    if count == cells + 1:
        return law
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(np.linspace(0, 1, cells + 1), law, axis=1)(np.linspace(0, 1, count)))


def distances(coordinates: Array) -> Array:
    """Return the distance from each node of the first line along the last axis to that of the last one."""
    return np.asarray(np.hypot(*(coordinates[:, :, -1] - coordinates[:, :, 0])))


def side_fractions(coordinates: Array) -> Array:
    """Return fractions of the lines along the last axis that pass from those of the one side to those of the other."""
    first, last = _arc_fractions(coordinates[:, 0]), _arc_fractions(coordinates[:, -1])
    share = np.linspace(0, 1, coordinates.shape[1])[:, None]
    return np.asarray((1 - share) * first + share * last)


def _arc_fractions(line: Array) -> Array:
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=1)))))
    return np.asarray(arc / arc[-1])
