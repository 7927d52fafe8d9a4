"""The cells that walls ask for: the lengths of their edges and their angles, at every corner of a grid.

Across lines between two opposite sides, of which one or both are walls, the lengths of edges follow the walls' laws;
along the walls they pass from those of the one side to those of the other.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.sides import Sides
from ..boundary.wall import Wall
from ..grids import transfinite
from ..grids.grid import corner_edges
from .wall_fractions import distances, fractions_between, side_fractions

#: A height that came out wrong by more than this factor is corrected by the factor at once.
_LARGEST_CORRECTION = 1.5
#: Where the nodes of the sides that meet a wall are spaced otherwise by more than this factor, that is said.
_MISPLACED = 3.0
#: Angles that are kept are no sharper than this, in radians.
LEAST_ANGLE = 0.1
#: The sides that a side meets at its first and at its last node.
_MEETS = {"bottom": ("left", "right"), "right": ("bottom", "top"), "top": ("left", "right"), "left": ("bottom", "top")}


@dataclass(frozen=True, slots=True)
class WallCells:
    """The cells that walls ask for on a grid of (ni, nj) nodes.

    Attributes:
        along_xi: (4, ni-1, nj-1), the lengths of edges along xi at every corner, in the order of `corner_jacobians`.
        along_eta: the same of edges along eta.
        angle: between the two, in radians.
        eta: (ni, nj), what fraction of a line from the bottom to the top its nodes have behind them; None where neither
            is a wall.
        xi: the same of lines from the left to the right.
    """

    along_xi: Array
    along_eta: Array
    angle: Array
    eta: Array | None
    xi: Array | None

    def matrix(self) -> Array:
        """Return the target W, row by row: (4, 4, ni-1, nj-1), corners along the second axis."""
        zero = np.zeros_like(self.along_xi)
        return np.stack((self.along_xi, self.along_eta * np.cos(self.angle), zero, self.along_eta * np.sin(self.angle)))


def own_cells(coordinates: Array) -> tuple[Array, Array, Array]:
    """Return the edge lengths along xi and along eta, and the angles, of a grid's own corners, (4, ni-1, nj-1) each."""
    x_xi, x_eta, y_xi, y_eta = corner_edges(coordinates[0], coordinates[1])
    angle = np.arctan2(x_xi * y_eta - x_eta * y_xi, x_xi * x_eta + y_xi * y_eta)
    return np.hypot(x_xi, y_xi), np.hypot(x_eta, y_eta), angle


def wall_cells(walls: Sides[Wall | None], coordinates: Array, home: tuple[int, int]) -> WallCells:
    """Return the cells that walls ask for.

    Args:
        walls: of the four sides.
        coordinates: (2, ni, nj), of which the boundary is used.
        home: (ni, nj) of the grid that the walls were given for, of which this may be a coarser one: the law is that of
            the cells there, evaluated where the nodes of the coarser one are.
    """
    turned = coordinates.transpose(0, 2, 1)
    eta = fractions_between(walls.bottom, walls.top, coordinates, home)
    xi = fractions_between(walls.left, walls.right, turned, (home[1], home[0]))
    xi = None if xi is None else xi.T
    eta_lines = side_fractions(coordinates) if eta is None else eta
    xi_lines = side_fractions(turned).T if xi is None else xi
    edges_eta = _lengths_across(coordinates, xi_lines) if eta is None else _lengths_of_law(coordinates, eta)
    edges_xi = _lengths_across(turned, eta_lines.T).T if xi is None else _lengths_of_law(turned, xi.T).T
    along_xi = np.stack([edges_xi[:, :-1], edges_xi[:, :-1], edges_xi[:, 1:], edges_xi[:, 1:]])
    along_eta = np.stack([edges_eta[:-1], edges_eta[1:], edges_eta[1:], edges_eta[:-1]])
    angle = np.full_like(along_xi, np.pi / 2)
    if not all(wall.orthogonal for wall in walls if wall is not None):
        sides = coordinates[:, :, 0], coordinates[:, :, -1], coordinates[:, 0], coordinates[:, -1]
        angle = np.clip(own_cells(transfinite(*(side.T for side in sides)).planes)[2], LEAST_ANGLE, np.pi - LEAST_ANGLE)
    return WallCells(along_xi, along_eta, angle, eta, xi)


def first_heights(coordinates: Array) -> Sides[Array]:
    """Return the heights of the first cells at the nodes of all sides, (ni,) or (nj,) each."""
    lines = (
        coordinates[:, :, 1] - coordinates[:, :, 0],
        coordinates[:, -2] - coordinates[:, -1],
        coordinates[:, :, -2] - coordinates[:, :, -1],
        coordinates[:, 1] - coordinates[:, 0],
    )
    return Sides(*(np.hypot(*line) for line in lines))


def misplaced_sides(walls: Sides[Wall | None], coordinates: Array) -> str:
    """Return a remark on sides whose own nodes, which stay, are spaced far otherwise than the wall that they meet.

    Args:
        walls: of the four sides.
        coordinates: (2, ni, nj), of which the boundary is used.
    """
    found = []
    for side, wall, heights in zip(Sides._fields, walls, first_heights(coordinates), strict=True):
        if wall is None:
            continue
        index, first = wall.along(wall.first, len(heights), "first")
        for end, which in ((0, 0), (len(heights) - 1, -1)):
            if index[which] == end and max(heights[end] / first[which], first[which] / heights[end]) > _MISPLACED:
                meets = _MEETS[side][which]
                found.append(f"those of {meets} begin with {heights[end]:.3g} where {side} asks for {first[which]:.3g}")
    if not found:
        return ""
    return (
        f" Boundary nodes stay, and {'; '.join(found)}: lines are skewed there. Space the nodes of these sides as the "
        "walls ask."
    )


def corrected(
    walls: Sides[Wall | None], asked: Sides[Wall | None], coordinates: Array
) -> tuple[Sides[Wall | None], float]:
    """Return walls whose first heights make up for what came out wrong, and by how much that is wrong at most.

    Where a wall bends within few cells, the minimum has not quite the heights of its target.

    Args:
        walls: for which the grid was made.
        asked: what is wanted.
        coordinates: (2, ni, nj), the grid.
    """
    found: list[Wall | None] = []
    worst = 0.0
    for wall, wanted, height in zip(walls, asked, first_heights(coordinates), strict=True):
        if wall is None or wanted is None:
            found.append(None)
            continue
        index, factor = height_factors(wanted, height)
        # The nodes of the sides that meet the wall do not move.
        factor[(index == 0) | (index == len(height) - 1)] = 1.0
        worst = max(worst, float(np.abs(factor - 1).max()))
        found.append(scaled_heights(wall, factor, len(height)))
    return Sides(*found), worst


def height_factors(asked: Wall, heights: Array) -> tuple[npt.NDArray[np.intp], Array]:
    """Return the nodes of a wall along its side, and by what factors its first heights there should be larger."""
    index, goal = asked.along(asked.first, len(heights), "first")
    return index, goal / heights[index]


def scaled_heights(wall: Wall, factor: Array, count: int) -> Wall:
    """Return a wall on a side of `count` nodes whose first heights are larger by factors, which are limited."""
    now = wall.along(wall.first, count, "first")[1]
    return replace(wall, first=now * np.clip(factor, 1 / _LARGEST_CORRECTION, _LARGEST_CORRECTION))


def _lengths_of_law(coordinates: Array, fractions: Array) -> Array:
    """Return the lengths of edges along the last axis, (ni, nj-1)."""
    return np.asarray(np.diff(fractions, axis=1) * distances(coordinates)[:, None])


def _lengths_across(coordinates: Array, fractions: Array) -> Array:
    """Return the lengths of edges along the last axis, (ni, nj-1), between those of the first and the last line.

    Args:
        coordinates: (2, ni, nj).
        fractions: (ni, nj), along the first axis.
    """
    first, last = (np.hypot(*np.diff(coordinates[:, k], axis=1)) for k in (0, -1))
    share = (fractions[:, 1:] + fractions[:, :-1]) / 2
    return np.asarray((1 - share) * first + share * last)


def corrected_beside(
    walls: Sides[Wall | None], asked: Sides[Wall | None], sliding: Collection[str]
) -> Sides[Wall | None]:
    """Return corrected walls where boundary nodes stay, and what is asked for where nodes slide.

    Corrections are for boundary nodes that hold cells off what walls ask for: those of the wall and of the two sides
    that meet it.
    """
    return Sides(
        *(
            wanted if {side, *_MEETS[side]} & {*sliding} else wall
            for side, wall, wanted in zip(Sides._fields, walls, asked, strict=True)
        )
    )
