"""The boundary of a block around an airfoil: C-grids, with a cut along the wake, and O-grids.

Lines along xi run clockwise, from the lower side of the cut over the leading edge to its upper side; eta grows from the
airfoil outwards. Nodes on both sides of the cut have the same places.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import Array
from .airfoil_section import AirfoilSection
from .laws import geometric
from .sides import Sides

Kind = Literal["C", "O"]
#: The wake turns from the trailing edge's direction to that of x within so many chords.
_TURN = 0.5
#: Outer nodes over the wake are so far between equally spaced ones (0) and those straight over the wake's (1).
_ABOVE = 0.5


@dataclass(frozen=True, slots=True)
class AirfoilSides:
    """The nodes of the four sides, and those of the bottom that are the airfoil's.

    Attributes:
        sides: `bottom` and `top` (ni, 2), `right` and `left` (nj, 2).
        wall: the first node of the bottom on the airfoil, and the one after the last.
        edge: how many cells of the bottom at each end of the wall lie on half of a blunt trailing edge.
    """

    sides: Sides[Array]
    wall: tuple[int, int]
    edge: int


def airfoil_sides(
    section: AirfoilSection,
    kind: Kind,
    *,
    cells: tuple[int, int],
    wake: int,
    edge: int,
    first: float,
    far: float,
    leading: float,
    trailing: float,
) -> AirfoilSides:
    """Return the boundary of a C- or an O-grid.

    Args:
        section: of the airfoil.
        kind: of grid.
        cells: on the section, without its blunt edge, and from it outwards.
        wake: cells along the wake of a C-grid.
        edge: cells on each half of a blunt trailing edge.
        first: height of the first cells at the airfoil.
        far: distance of the outer boundary.
        leading: length of the cells at the leading edge.
        trailing: the same at the trailing edge.
    """
    wall = section.nodes(cells[0], leading, trailing)
    if section.base:
        share = np.linspace(0, 1, edge + 1)[:-1, None]
        middle = section.trailing_edge
        wall = np.concatenate((middle + share * (wall[0] - middle), wall, (middle + share * (wall[-1] - middle))[::-1]))
    beside = section.base / 2 / edge if section.base else trailing
    cut = _wake(section, far, geometric(first / far, cells[1])[0] if kind == "O" else geometric(beside / far, wake)[0])
    if kind == "O":
        top = _circle(section.trailing_edge, cut[-1], len(wall))
        return AirfoilSides(Sides(bottom=wall, right=cut, top=top, left=cut), (0, len(wall)), edge)
    out = float(np.sqrt(first * far / cells[1]))
    lines = geometric(out / far, cells[1])[0]
    x, y = cut[-1]
    left = np.stack((np.full(len(lines), x), y - far * lines), axis=-1)
    right = np.stack((left[:, 0], y + far * lines), axis=-1)
    bottom = np.concatenate((cut[:0:-1], wall, cut[1:]))
    top = _outer(section, cut, len(wall) - 1, far)
    return AirfoilSides(Sides(bottom=bottom, right=right, top=top, left=left), (wake, wake + len(wall)), edge)


def _wake(section: AirfoilSection, length: float, fractions: Array) -> Array:
    """Return nodes on the line from the trailing edge that turns to the direction of x."""
    turn = _TURN * section.chord
    x = length * fractions
    return np.stack((x, -section.wake_slope * turn * np.expm1(-x / turn)), axis=-1) + section.trailing_edge


def _circle(trailing: Array, end: Array, count: int) -> Array:
    """Return nodes on the circle around a point near the trailing edge, clockwise from the cut's end to itself."""
    angle = np.arctan2(*(end - trailing)[::-1]) - np.linspace(0, 2 * np.pi, count)
    radius = np.hypot(*(end - trailing))
    nodes = trailing + radius * np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    nodes[0] = nodes[-1] = end
    return np.asarray(nodes)


def _outer(section: AirfoilSection, cut: Array, cells: int, far: float) -> Array:
    """Return nodes on the outer boundary of a C-grid: a half circle in front, and two lines along the wake."""
    x, y = cut[-1]
    behind = cut[:, 0] - cut[0, 0]  # From over the trailing edge to the outflow.
    over = (1 - _ABOVE) * np.linspace(0, behind[-1], len(cut)) + _ABOVE * behind
    ahead = np.pi / 2 * far + section.chord / 2  # From the foremost point to over the trailing edge.
    half = cells // 2
    before = ahead * (1 - geometric(over[1] / ahead, half)[0][::-1])
    place = np.concatenate((before, ahead + over[1:]))
    angle = np.minimum(place / far, np.pi / 2)
    center = cut[0, 0] - section.chord / 2
    upper = np.stack(
        (center - far * np.cos(angle) + np.maximum(place - np.pi / 2 * far, 0), y + far * np.sin(angle)), axis=-1
    )
    upper[-1] = x, y + far
    lower = np.stack((upper[:, 0], 2 * y - upper[:, 1]), axis=-1)
    return np.concatenate((lower[:0:-1], upper))
