"""Layouts round sections: C- and O-grids whose cut is a connection, and the passage of a cascade."""

from __future__ import annotations

import os
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...boundary.airfoil_boundary import airfoil_boundary
from ...boundary.airfoil_section import AirfoilSection
from ...boundary.airfoil_sides import Kind
from ...boundary.laws import geometric
from ...boundary.sides import Sides, grid_of_sides
from ...grids import Grid
from ..connection import Connection, PartLike
from ..multiblock import MultiBlock
from .registry import require, shape

#: A NACA number, the path of a `.dat` file, or points.
Section: TypeAlias = "str | os.PathLike[str] | AirfoilSection | npt.ArrayLike"
#: Cells at both edges of a blade are shorter than the mean one by this factor.
_EDGES = 3.0


@shape("a C-grid round a section: one block, whose cut along the wake is a connection")
def airfoil_c(
    section: Section = "naca0012",
    first: float = 1e-3,
    far: float = 10.0,
    around: int = 64,
    outwards: int = 32,
    wake: int = 24,
) -> MultiBlock:
    """Make the grid that `airfoil_grid` starts from; its boundaries are `wall`, `farfield` and `outlet`.

    Args:
        section: a NACA number, the path of a `.dat` file in Selig's form, or points (n, 2).
        first: height of the first cells of the cut's ends, in the unit of the section.
        far: distance of the outer boundary, in chords.
        around: an even number of cells on the section, at least 16.
        outwards: cells from it outwards, at least 4.
        wake: cells along the wake, at least 3.
    """
    return _round_airfoil(section, "C", first, far, (around, outwards), wake)


@shape("an O-grid round a section: one block, closed at a cut behind the trailing edge")
def airfoil_o(
    section: Section = "naca0012", first: float = 1e-3, far: float = 10.0, around: int = 64, outwards: int = 32
) -> MultiBlock:
    """Make the grid that `airfoil_grid` starts from; its boundaries are `wall` and `farfield`.

    Args:
        section: a NACA number, the path of a `.dat` file in Selig's form, or points (n, 2).
        first: height of the first cells of the cut, in the unit of the section.
        far: distance of the outer boundary, in chords.
        around: an even number of cells on the section, at least 16.
        outwards: cells from it outwards, at least 4.
    """
    return _round_airfoil(section, "O", first, far, (around, outwards), wake=3)


@shape("the passage between two blades of a cascade, periodic from pitch to pitch")
def cascade(
    section: Section = "naca4510",
    pitch: float = 0.8,
    stagger: float = 25.0,
    inlet_angle: float = 35.0,
    outlet_angle: float = 15.0,
    upstream: float = 0.7,
    downstream: float = 1.0,
    along: int = 24,
    before: int = 12,
    behind: int = 16,
    across: int = 16,
) -> MultiBlock:
    """Make the passage over a blade and under the next one; its boundaries are `inlet`, `outlet` and `wall`.

    The bottom of the block is the periodic line to the leading edge, the upper side of the blade and the line behind
    it; the top has the lower side of the next blade. A blunt trailing edge is closed in its middle.

    Args:
        section: a NACA number, the path of a `.dat` file in Selig's form, or points (n, 2); its chord becomes 1.
        pitch: the distance of the blades along y, positive.
        stagger: by how many degrees the section is turned counter-clockwise, between -80 and 80.
        inlet_angle: of the periodic lines before the blades to x, in degrees, between -80 and 80.
        outlet_angle: of those behind the blades, in degrees, between -80 and 80.
        upstream: the length along x before the blades, in chords, positive.
        downstream: the length along x behind the blades, in chords, positive.
        along: cells on each side of a blade, at least 4.
        before: cells before the blades.
        behind: cells behind the blades.
        across: cells from blade to blade.
    """
    require(
        "cascade",
        pitch=pitch > 0,
        stagger=abs(stagger) < 80,
        inlet_angle=abs(inlet_angle) < 80,
        outlet_angle=abs(outlet_angle) < 80,
        upstream=upstream > 0,
        downstream=downstream > 0,
        along=along >= 4,
    )
    lower, upper = _blade(AirfoilSection.of(section), stagger, along)
    edge = float(np.hypot(*(upper[1] - upper[0])))
    ahead = lower[0] - _line(upstream, inlet_angle, edge, before)[::-1]
    after = lower[-1] + _line(downstream, outlet_angle, edge, behind)
    bottom, top = (np.concatenate((ahead, side[1:], after[1:])) for side in (upper, lower))
    top = top + np.array([0.0, pitch])
    share = np.linspace(0, pitch, across + 1)[:, None] * np.array([0.0, 1.0])
    grid = grid_of_sides(Sides(bottom, bottom[-1] + share, top, bottom[0] + share))
    last = before + along + behind
    parts = [(0, before), (before + along, last)]
    blade = (before, before + along)
    return MultiBlock(
        {"passage": grid},
        [Connection(("passage", "bottom", part), ("passage", "top", part), translation=(0.0, pitch)) for part in parts],
        boundaries={
            "inlet": [("passage", "left")],
            "outlet": [("passage", "right")],
            "wall": [("passage", "bottom", blade), ("passage", "top", blade)],
        },
    )


def _round_airfoil(
    section: Section, kind: Kind, first: float, far: float, cells: tuple[int, int], wake: int
) -> MultiBlock:
    boundary = airfoil_boundary(section, kind, first=first, far=far, cells=cells, wake=wake)
    wall = (boundary.wall[0], boundary.wall[1] - 1)
    last = len(boundary.sides.bottom) - 1
    boundaries: dict[str, list[PartLike]] = {"wall": [("airfoil", "bottom", wall)], "farfield": [("airfoil", "top")]}
    if kind == "C":
        cut = Connection(("airfoil", "bottom", (0, wall[0])), ("airfoil", "bottom", (wall[1], last)))
        boundaries["outlet"] = [("airfoil", "left"), ("airfoil", "right")]
        grid = grid_of_sides(boundary.sides)
    else:
        cut = Connection(("airfoil", "left"), ("airfoil", "right"))
        grid = _closed(boundary.sides)
    return MultiBlock({"airfoil": grid}, [cut], boundaries=boundaries)


def _closed(sides: Sides[Array]) -> Grid:
    """Return the grid of an O-grid's sides, whose straight lines are spaced like the cut: fewer cells fold."""
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(sides.left, axis=0).T))))
    share = (lengths / lengths[-1])[:, None]
    bent = sides.left - (1 - share) * sides.bottom[0] - share * sides.top[0]
    nodes = (1 - share) * sides.bottom[:, None] + share * sides.top[:, None] + bent
    nodes[0] = nodes[-1] = sides.left
    return Grid(nodes)


def _blade(section: AirfoilSection, stagger: float, cells: int) -> tuple[Array, Array]:
    """Return the nodes of the lower and of the upper side, (cells + 1, 2) each, from the leading edge at (0, 0)."""
    short = section.chord / cells / _EDGES
    nodes = section.nodes(2 * cells, short, short) / section.chord
    nodes[0] = nodes[-1] = section.trailing_edge / section.chord
    nodes = nodes - nodes[cells]
    angle = np.radians(stagger)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    nodes = nodes @ turn.T
    return nodes[cells::-1], nodes[cells:]


def _line(length: float, angle: float, first: float, cells: int) -> Array:
    """Return the nodes of a straight line from (0, 0), whose extent along x is given, (cells + 1, 2)."""
    along = length / np.cos(np.radians(angle))
    fractions = geometric(min(first / along, 1 / cells), cells)[0]
    return np.asarray(fractions[:, None] * np.array([length, length * np.tan(np.radians(angle))]))
