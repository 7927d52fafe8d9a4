"""Where the nodes of lines between opposite sides are, one or both of which are walls: fractions of their lengths."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..boundary.laws import growing_from_both, two_ended
from ..boundary.wall import Wall


def fractions_between(low: Wall | None, high: Wall | None, coordinates: Array, home: tuple[int, int]) -> Array | None:
    """Return the fractions (ni, nj) of the lines along the last axis between two sides, walls or not."""
    if low is None and high is None:
        return None
    nj = coordinates.shape[2]
    cells, length = home[1] - 1, distances(coordinates)
    ends = _ends(coordinates, cells)
    if low is not None and high is not None:
        law = _between_walls(low, high, length, ends, cells, home[0], coordinates)
    elif low is not None:
        first, growth = _at_lines(low, length, ends[0], home[0], coordinates[:, :, 0])
        law = low.fractions(length, first, growth, cells)
    else:
        assert high is not None
        first, growth = _at_lines(high, length, ends[1], home[0], coordinates[:, :, -1])
        law = 1 - high.fractions(length, first, growth, cells)[:, ::-1]
    return _sampled(law, nj)


def both_grow(low: Wall, high: Wall, coordinates: Array) -> bool:
    """Return whether cells grow by their growth from both of two opposite walls; else Vinokur's law holds."""
    nj = coordinates.shape[2]
    lines = _at_both(low, high, distances(coordinates), _ends(coordinates, nj - 1), coordinates.shape[1], coordinates)
    return _growing_between(*lines, nj - 1) is not None


def _between_walls(
    low: Wall, high: Wall, length: Array, ends: tuple[Array, Array], cells: int, count: int, coordinates: Array
) -> Array:
    """Return the fractions at the nodes of lines between two walls, (m, cells + 1)."""
    lines = _at_both(low, high, length, ends, count, coordinates)
    law = _growing_between(*lines, cells)
    return two_ended(lines[0], lines[2], cells) if law is None else law


def _at_both(
    low: Wall, high: Wall, length: Array, ends: tuple[Array, Array], count: int, coordinates: Array
) -> tuple[Array, Array | None, Array, Array | None]:
    """Return the first height, as a part of the line, and the growth at every line, from both ends."""
    first, growth = _at_lines(low, length, ends[0], count, coordinates[:, :, 0])
    last, growth_high = _at_lines(high, length, ends[1], count, coordinates[:, :, -1])
    return first / length, growth, last / length, growth_high


def _growing_between(
    first: Array, growth: Array | None, last: Array, growth_high: Array | None, cells: int
) -> Array | None:
    """Return the fractions of cells that grow from both walls; None where one has no growth, or it does not fit."""
    if growth is None or growth_high is None:
        return None
    return growing_from_both(first, growth, last, growth_high, cells)


def _ends(coordinates: Array, cells: int) -> tuple[Array, Array]:
    """Return the first and last cells of the sides' own lines, as they would be on a grid of so many cells."""
    own, step = side_fractions(coordinates), (coordinates.shape[2] - 1) / max(cells, 1)
    return own[:, 1] * step, (1 - own[:, -2]) * step


def _at_lines(wall: Wall, length: Array, ends: Array, count: int, side: Array) -> tuple[Array, Array | None]:
    """Return the first height and the growth at every line, from the values at the nodes of a side at home.

    Beside a wall that is a part of the side, heights pass geometrically, with the arc length, to those of the side's
    ends, and growth is that at the wall's end.
    """
    lines = np.linspace(0, count - 1, len(length))
    index, first = wall.along(wall.first, count, "first")
    known, heights = index.astype(float), np.log(first)
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(side, axis=1)))))
    place = np.interp(known, lines, arc)
    if known[0] > 0:
        place, heights = np.append(arc[0], place), np.append(np.log(ends[0] * length[0]), heights)
    if known[-1] < count - 1:
        place, heights = np.append(place, arc[-1]), np.append(heights, np.log(ends[-1] * length[-1]))
    first_at = np.exp(np.interp(arc, place, heights))
    if wall.growth is None:
        return first_at, None
    index, growth = wall.along(wall.growth, count, "growth")
    return first_at, np.interp(lines, index, growth)


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
