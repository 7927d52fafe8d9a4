"""Lengths of edges that targets of neighboring blocks ask for, made equal along the connections between them.

A block asks for lengths by its own walls. Beside it, a block without them, or with fewer, would ask for others along
the same connection, and the cells at its end would be a compromise between both. So what the block with more walls
asks for along a connection holds for both, and inside of the other passes over to its own lengths.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...arrays import Array
from ...boundary.sides import Sides
from ...boundary.wall import Wall
from ...fields.wall_cells import WallCells
from ...topology import MultiBlock
from ...topology.connection import SidePart


def agreed(layout: MultiBlock, walls: Mapping[str, Sides[Wall | None]], cells: Sequence[WallCells]) -> list[WallCells]:
    """Return the cells of all blocks with equal lengths along connections.

    Args:
        layout: the blocks.
        walls: of those that have some, by name.
        cells: what each block asks for by itself.
    """
    sides = [_sides(one) for one in cells]
    factors = [{side: np.zeros(len(line)) for side, line in one.items()} for one in sides]
    for bond in layout.bonds:
        one, other = (sides[part.block][part.side][part.first : part.last] for part in (bond.one, bond.other))
        difference = np.log((other[::-1] if bond.reversed else other) / one)
        rank, other_rank = (_rank(part, walls.get(layout.names[part.block])) for part in (bond.one, bond.other))
        share = 0.5 if rank == other_rank else float(rank < other_rank)
        _add(factors, bond.one, share * difference)
        _add(factors, bond.other, ((share - 1) * difference)[:: -1 if bond.reversed else 1])
    return [_scaled(one, factor) for one, factor in zip(cells, factors, strict=True)]


def _sides(cells: WallCells) -> dict[str, Array]:
    """Return the lengths of the edges of each side, in the order of its nodes."""
    xi, eta = cells.along_xi, cells.along_eta
    return {"bottom": xi[0][:, 0], "right": eta[1][-1], "top": xi[2][:, -1], "left": eta[0][0]}


def _rank(part: SidePart, walls: Sides[Wall | None] | None) -> int:
    """Return how many walls decide about the lengths of edges along a part of a side: those of the sides it meets."""
    if walls is None:
        return 0
    met = (walls.left, walls.right) if part.axis == 0 else (walls.bottom, walls.top)
    return sum(wall is not None for wall in met)


def _add(factors: Sequence[dict[str, Array]], part: SidePart, logarithms: Array) -> None:
    factors[part.block][part.side][part.first : part.last] += logarithms


def _scaled(cells: WallCells, factors: Mapping[str, Array]) -> WallCells:
    """Return cells whose lengths are scaled at the sides, by given logarithms, and between these accordingly."""
    if not any(factor.any() for factor in factors.values()):
        return cells
    ni, nj = (count + 1 for count in cells.along_xi.shape[1:])
    i, j = np.linspace(0, 1, ni)[:, None], np.linspace(0, 1, nj)
    along_eta = np.exp((1 - i) * factors["left"] + i * factors["right"])
    along_xi = np.exp((1 - j) * factors["bottom"][:, None] + j * factors["top"][:, None])
    of_xi = np.stack([along_xi[:, :-1], along_xi[:, :-1], along_xi[:, 1:], along_xi[:, 1:]])
    of_eta = np.stack([along_eta[:-1], along_eta[1:], along_eta[1:], along_eta[:-1]])
    return replace(cells, along_xi=cells.along_xi * of_xi, along_eta=cells.along_eta * of_eta)
