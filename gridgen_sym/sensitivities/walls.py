"""The cells that walls ask for: derivatives in first heights, growth and the boundary, and changes with these.

Cells depend on the boundary by the lengths of its edges and of lines between opposite sides. What the spacing laws give
for one line depends on that line alone: a few differences, for all lines at once, are their derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..boundary.sides import Sides
from ..boundary.wall import Wall
from ..fields.wall_cells import LEAST_ANGLE, own_cells
from ..fields.wall_fractions import distances, heights_along
from ..grids import transfinite
from ..grids.grid import corner_edges
from .edges import corner_edges_transposed, fractions_transposed, lengths_transposed, transfinite_transposed
from .wall_lines import STEP, LineLaws, difference


@dataclass(eq=False)
class WallDerivative:
    """The derivatives in one wall: at its nodes in the first heights and in the growth, (k,); zero without a growth."""

    first: Array
    growth: Array


class _Direction:
    """Lines along the last axis, from one side (low) to the opposite one (high), of which some may be walls.

    Attributes:
        place: (2, n, m), coordinates of which the boundary is used.
        laws: of the lines.
        in_place: (2, n, m), derivatives in the boundary, which are added up here.
        in_walls: derivatives in the low and in the high wall.
    """

    def __init__(self, laws: LineLaws, place: Array) -> None:
        self.place, self.in_place, self.laws = place, np.zeros_like(place), laws
        self.fractions, self.length = laws.fractions, distances(place)
        self.in_walls: list[WallDerivative | None] = [None, None]

    def take_lengths(self, in_lengths: Array) -> None:
        """Take derivatives in the lengths of the lines between the sides, (n,)."""
        apart = self.place[:, :, -1] - self.place[:, :, 0]
        pull = apart * (in_lengths / np.hypot(*apart))
        self.in_place[:, :, -1] += pull
        self.in_place[:, :, 0] -= pull

    def take_edges(self, at: int, in_lengths: Array) -> None:
        """Take derivatives in the edges of the first (0) or the last line (-1), (m - 1,)."""
        self.in_place[:, at] += lengths_transposed(self.place[:, at], in_lengths)

    def take_cells(self, in_edges: Array, across: Array) -> tuple[Array, Array]:
        """Take derivatives in the lengths (n, m - 1) of edges along the last axis.

        Args:
            in_edges: the derivatives.
            across: (n, m), the fractions of the lines between the other two sides.

        Returns:
            Derivatives in the own fractions, and in those.
        """
        own, other = np.zeros_like(self.fractions), np.zeros_like(across)
        if self.laws.walled:
            self.take_lengths((in_edges * np.diff(self.fractions, axis=1)).sum(axis=1))
            pull = in_edges * self.length[:, None]
            own[:, 1:] += pull
            own[:, :-1] -= pull
            return own, other
        first, last = (np.hypot(*np.diff(self.place[:, at], axis=1)) for at in (0, -1))
        share, pull = (across[:, 1:] + across[:, :-1]) / 2, 0.5 * in_edges * (last - first)
        self.take_edges(0, ((1 - share) * in_edges).sum(axis=0))
        self.take_edges(-1, (share * in_edges).sum(axis=0))
        other[:, 1:] += pull
        other[:, :-1] += pull
        return own, other

    def take_fractions(self, in_fractions: Array) -> None:
        """Take derivatives in the fractions, (n, m)."""
        if not self.laws.walled:
            share = np.linspace(0, 1, len(self.length))
            for at, part in ((0, 1 - share), (-1, share)):
                edges = np.hypot(*np.diff(self.place[:, at], axis=1))
                self.take_edges(at, fractions_transposed(edges, part @ in_fractions))
            return
        in_lines = {name: (in_fractions * along).sum(axis=1) for name, along in self.laws.along.items()}
        self.take_lengths(in_lines["length"])
        for number, (first, growth) in enumerate((("first", "growth"), ("last", "growth_last"))):
            wall = self.laws.walls[number]
            if wall is not None:
                found = self._in_wall(wall, number, in_lines[first], in_lines.get(growth))
                self.in_walls[number] = found

    def _in_wall(self, wall: Wall, number: int, in_heights: Array, in_growth: Array | None) -> WallDerivative:
        """Return derivatives at a wall's nodes, given those at all lines; add what heights beside it take along."""
        count, at = len(self.length), -number
        index, first = wall.along(wall.first, count, "first")
        growth = np.zeros(len(index))
        if in_growth is not None:
            lines = np.arange(count)
            growth = np.array([in_growth @ np.interp(lines, index, row) for row in np.eye(len(index))])
        if len(index) == count:
            return WallDerivative(in_heights, growth)
        side = self.place[:, :, at]
        edges = np.hypot(*np.diff(side, axis=1))
        ends = [_end_cell(self.place[:, line], at) * self.length[line] for line in (0, -1)]
        given = np.concatenate((first, edges, ends))

        def heights(numbers: Array) -> Array:
            parts = np.split(numbers, (len(first), len(first) + len(edges)))
            return heights_along(index, parts[0], parts[1], (float(parts[2][0]), float(parts[2][1])), count)

        def column(unit: Array) -> Array:
            return difference(lambda t: heights(given * (1 + t * unit)), STEP)

        columns = [column(unit) for unit in np.eye(len(given))]
        pulled = np.array([in_heights @ column for column in columns]) / given
        in_first, in_edges, in_ends = np.split(pulled, (len(first), len(first) + len(edges)))
        self.in_place[:, :, at] += lengths_transposed(side, in_edges)
        in_lengths = np.zeros(count)
        for line, pull, end in zip((0, -1), in_ends, ends, strict=True):
            in_lengths[line] += pull * end / self.length[line]
            own = np.hypot(*np.diff(self.place[:, line], axis=1))
            in_own = np.full_like(own, -own[at] / own.sum() ** 2)
            in_own[at] += 1 / own.sum()
            self.take_edges(line, pull * self.length[line] * in_own)
        self.take_lengths(in_lengths)
        return WallDerivative(in_first, growth)


def _end_cell(line: Array, at: int) -> float:
    """Return the first (0) or the last (-1) edge of a line (2, m) over its length."""
    edges = np.hypot(*np.diff(line, axis=1))
    return float(edges[at] / edges.sum())


def in_wall_cells(
    laws: tuple[LineLaws, LineLaws], place: Array, in_xi: Array, in_eta: Array, in_angle: Array
) -> tuple[Sides[WallDerivative | None], Array]:
    """Return derivatives in walls and in the boundary (2, ni, nj), given those in the cells that walls ask for.

    Args:
        laws: of the lines along eta and along xi, as `laws_of` returns them.
        place: (2, ni, nj), of which the boundary is used.
        in_xi: (4, ni-1, nj-1), derivatives in the lengths of edges along xi, in the order of `WallCells`.
        in_eta: the same along eta.
        in_angle: the same in the angles.
    """
    eta, xi = _Direction(laws[0], place), _Direction(laws[1], place.transpose(0, 2, 1))
    edges_eta, edges_xi = np.zeros((place.shape[1], place.shape[2] - 1)), np.zeros((place.shape[1] - 1, place.shape[2]))
    edges_eta[:-1], edges_xi[:, :-1] = in_eta[0] + in_eta[3], in_xi[0] + in_xi[1]
    edges_eta[1:] += in_eta[1] + in_eta[2]
    edges_xi[:, 1:] += in_xi[2] + in_xi[3]
    of_eta, across_eta = eta.take_cells(edges_eta, xi.fractions.T)
    of_xi, across_xi = xi.take_cells(edges_xi.T, eta.fractions.T)
    eta.take_fractions(of_eta + across_xi.T)
    xi.take_fractions(of_xi + across_eta.T)
    found = eta.in_place + xi.in_place.transpose(0, 2, 1)
    if not all(wall.orthogonal for law in laws for wall in law.walls if wall is not None):
        found += _in_angles(place, in_angle)
    return Sides(eta.in_walls[0], xi.in_walls[1], eta.in_walls[1], xi.in_walls[0]), found


def _in_angles(place: Array, in_angle: Array) -> Array:
    """Return derivatives in the boundary, given those in the angles that transfinite interpolation gives."""
    sides = place[:, :, 0], place[:, :, -1], place[:, 0], place[:, -1]
    grid = transfinite(*(side.T for side in sides)).planes
    pulled = np.where(np.abs(own_cells(grid)[2] - np.pi / 2) < np.pi / 2 - LEAST_ANGLE, in_angle, 0.0)
    x_xi, x_eta, y_xi, y_eta = corner_edges(*grid)
    cross, dot = x_xi * y_eta - x_eta * y_xi, x_xi * x_eta + y_xi * y_eta
    pulled = pulled / (cross**2 + dot**2)
    in_cross, in_dot = dot * pulled, -cross * pulled
    entries = (
        in_cross * y_eta + in_dot * x_eta,
        in_dot * x_xi - in_cross * y_xi,
        in_dot * y_eta - in_cross * x_eta,
        in_cross * x_xi + in_dot * y_xi,
    )
    return transfinite_transposed(corner_edges_transposed(entries))
