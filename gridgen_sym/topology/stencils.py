"""The nine nodes of central differences at nodes on connections, seen from one of the blocks that meet there.

Round a node where four cells meet, logical coordinates continue from block to block: their directions turn by quarters.
Where three, five or more cells meet there are none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Mask
from .copies import Bond, Copies, Indices

#: The directions +xi, +eta, -xi and -eta, and the side on which an edge along them lies with no cell on its left.
_STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))
_SIDES = ("top", "left", "bottom", "right")
_OUTWARDS = {"right": 0, "top": 1, "left": 2, "bottom": 3}
#: A node of a stencil: its block, i and j, the quarters, and the entry of the stencil's center in that block.
_Seen = tuple[int, int, int, int, int]
#: Of a stencil: its nodes, row by row along xi, and the node itself.
NODES, CENTER = 9, 4


class Corner(NamedTuple):
    """The corner of a cell at a node.

    Attributes:
        block, i, j: the copy of the node in the cell's block.
        quadrant: of the cell there: 0 between +xi and +eta, and on counter-clockwise.
        quarters: by how many quarters the block's directions are turned against those of the first corner's block.
    """

    block: int
    i: int
    j: int
    quadrant: int
    quarters: int


class _Edge(NamedTuple):
    """An edge of a side: the block, the side, its number, and whether nodes are counted in the other direction."""

    block: int
    side: str
    number: int
    reversed: bool


@dataclass(frozen=True, slots=True, eq=False)
class Stencils:
    """The stencils of the connected nodes that have one.

    Attributes:
        node: the numbers of these nodes among those with several copies; (n,).
        block, i, j: the nodes of the stencils, in the directions of the first copy's block; (2, 9, n): nodes on a
            connection as nodes of both of its blocks, which need not be given the same where three or five cells meet.
        quarters: by how many quarters the directions of their blocks are turned against these; (2, 9, n).
        turn: cosine and sine of the rotation from the place of the first copy's block to theirs; (2, 2, 9, n).
        through: the copy of the node in the same block as each of them: its entry in `Copies`; (2, 9, n).
        copy_quarters: for each entry of `Copies` the quarters of its block against that of the first copy.
        others: the numbers of the free nodes that have no stencil.
    """

    node: Indices
    block: Indices
    i: Indices
    j: Indices
    quarters: Indices
    turn: Array
    through: Indices
    copy_quarters: Indices
    others: Indices


def shared_stencils(
    copies: Copies,
    bonds: Sequence[Bond],
    shapes: Sequence[tuple[int, int]],
    fixed: Sequence[Mask],
    usable: Callable[[Sequence[Corner]], bool],
) -> Stencils:
    """Find the stencils of free nodes on connections.

    Args:
        copies: the nodes with several copies.
        bonds: what is connected.
        shapes: (ni, nj) of the blocks.
        fixed: for each block the mask of nodes that do not move.
        usable: whether a node has a stencil at whose four corners blocks meet as said.
    """
    across = _across(bonds)
    entry = {key: number for number, key in enumerate(zip(*_listed(copies.block, copies.i, copies.j), strict=True))}
    found: list[list[list[_Seen]]] = []
    nodes, others = [], []
    for node, start in enumerate(copies.starts.tolist()):
        block, i, j = int(copies.block[start]), int(copies.i[start]), int(copies.j[start])
        if fixed[block][i, j]:
            continue
        corners = _round(block, i, j, shapes, across)
        if len(corners) != len(_STEPS) or not usable(corners):
            others.append(node)
            continue
        nodes.append(node)
        found.append(_stencil(corners, entry))
    table = np.array(found, dtype=np.intp).reshape(len(nodes), 2, NODES, 5).transpose(3, 1, 2, 0)
    listed = np.array(nodes, dtype=np.intp)
    through = table[4]
    turn, rest = copies.turn[:, through], np.array(others, dtype=np.intp)
    quarters = _copy_quarters(copies, bonds, shapes, entry)
    return Stencils(listed, table[0], table[1], table[2], table[3], turn, through, quarters, rest)


def _copy_quarters(
    copies: Copies, bonds: Sequence[Bond], shapes: Sequence[tuple[int, int]], entry: dict[tuple[int, int, int], int]
) -> Indices:
    """Return for each entry by how many quarters its block's directions are turned against those of the first copy's.

    Round nodes where other than four cells meet, another way would give other quarters.
    """
    found = np.full(len(copies.block), -1, dtype=np.intp)
    found[copies.starts] = 0
    pairs = []
    for bond in bonds:
        ends = []
        for part, (i, j) in zip((bond.one, bond.other), bond.indices(shapes), strict=True):
            ends.append(np.array([entry[part.block, a, b] for a, b in zip(*_listed(i, j), strict=True)]))
        # Outwards of one side is inwards of the other.
        quarters = (_OUTWARDS[bond.one.side] - _OUTWARDS[bond.other.side] - 2) % 4
        pairs += [(ends[0], ends[1], quarters), (ends[1], ends[0], -quarters % 4)]
    while (found < 0).any():
        for known, other, quarters in pairs:
            new = (found[known] >= 0) & (found[other] < 0)
            found[other[new]] = (found[known[new]] + quarters) % 4
    return found


def _listed(*arrays: Indices) -> list[list[int]]:
    return [one.tolist() for one in arrays]


def _across(bonds: Sequence[Bond]) -> dict[tuple[int, str, int], _Edge]:
    """Return for each connected edge of a side the same edge on the other side of the connection."""
    found = {}
    for bond in bonds:
        count = bond.one.count - 1
        for k in range(count):
            there = count - 1 - k if bond.reversed else k
            one, other = bond.one.first + k, bond.other.first + there
            found[bond.one.block, bond.one.side, one] = _Edge(bond.other.block, bond.other.side, other, bond.reversed)
            found[bond.other.block, bond.other.side, other] = _Edge(bond.one.block, bond.one.side, one, bond.reversed)
    return found


def _has_cell(shape: tuple[int, int], i: int, j: int, quadrant: int) -> bool:
    """Whether a block has a cell in a quadrant of its node."""
    (a, b), (c, d) = _STEPS[quadrant], _STEPS[(quadrant + 1) % 4]
    return 0 <= i + a + c < shape[0] and 0 <= j + b + d < shape[1]


def _round(
    block: int, i: int, j: int, shapes: Sequence[tuple[int, int]], across: dict[tuple[int, str, int], _Edge]
) -> list[Corner]:
    """Return the corners of cells round a free node, counter-clockwise; no more than five of them."""
    first = next(quadrant for quadrant in range(4) if _has_cell(shapes[block], i, j, quadrant))
    start, place, quadrant = (block, i, j, first), (block, i, j), first
    corners: list[Corner] = []
    while len(corners) <= len(_STEPS):
        corners.append(Corner(*place, quadrant, (first + len(corners) - quadrant) % 4))
        quadrant = (quadrant + 1) % 4
        if not _has_cell(shapes[place[0]], place[1], place[2], quadrant):
            place, quadrant = _crossed(place, quadrant, shapes, across)
        if (*place, quadrant) == start:
            break
    return corners


def _crossed(
    place: tuple[int, int, int],
    direction: int,
    shapes: Sequence[tuple[int, int]],
    across: dict[tuple[int, str, int], _Edge],
) -> tuple[tuple[int, int, int], int]:
    """Return the copy beyond the edge along a direction, and the quadrant there."""
    block, i, j = place
    along = (i, j)[direction % 2]
    begins = direction < 2
    edge = across[block, _SIDES[direction], along if begins else along - 1]
    begins ^= edge.reversed
    node = edge.number if begins else edge.number + 1
    ni, nj = shapes[edge.block]
    if edge.side in ("bottom", "top"):
        return (edge.block, node, 0 if edge.side == "bottom" else nj - 1), 0 if begins else 2
    return (edge.block, 0 if edge.side == "left" else ni - 1, node), 1 if begins else 3


def _stencil(corners: Sequence[Corner], entry: dict[tuple[int, int, int], int]) -> list[list[_Seen]]:
    """Return for each node of a stencil its block, i and j, the quarters, and the entry of the copy in that block.

    They are nodes of the cells that follow counter-clockwise in the first list, and of those before in the second.
    """
    center = (*corners[0][:3], 0, entry[corners[0][:3]])
    after, before = [center] * NODES, [center] * NODES
    for block, i, j, quadrant, quarters in corners:
        here = entry[block, i, j]
        (a, b), (c, d) = _STEPS[quadrant], _STEPS[(quadrant + 1) % 4]
        (p, q), (r, s) = (_STEPS[(quadrant + quarters + k) % 4] for k in (0, 1))
        after[CENTER + 3 * p + q] = (block, i + a, j + b, quarters, here)
        before[CENTER + 3 * r + s] = (block, i + c, j + d, quarters, here)
        diagonal = CENTER + 3 * (p + r) + q + s
        after[diagonal] = before[diagonal] = (block, i + a + c, j + b + d, quarters, here)
    return [after, before]
