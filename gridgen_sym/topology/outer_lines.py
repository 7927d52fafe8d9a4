"""The outer boundary of a layout as lines of nodes, which pass from block to block and end at corners of the domain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .connection import SidePart
from .copies import Indices, first_copies
from .multiblock import MultiBlock

#: An edge of the outer boundary: block, side, and the number of its first node along the side.
Edge = tuple[int, str, int]


@dataclass(frozen=True, slots=True, eq=False)
class OuterLine:
    """Nodes of the outer boundary that follow each other, with the domain on the left.

    Attributes:
        group: what the edges were chosen as.
        edges: of the line.
        places: (3, n), block, i and j of its nodes; of a closed line the first one is the last, too.
        closed: whether it has no ends: no node of it must stay.
    """

    group: int
    edges: tuple[Edge, ...]
    places: Indices
    closed: bool


@dataclass(frozen=True, slots=True)
class _Walked:
    """An edge, walked with the domain on the left: its two nodes, by block, i and j and as numbers."""

    edge: Edge
    places: tuple[tuple[int, int, int], tuple[int, int, int]]
    nodes: tuple[int, int]


def outer_edges(layout: MultiBlock) -> list[Edge]:
    """Return the edges of sides that belong to no connection."""
    inside = {
        (part.block, part.side, k)
        for bond in layout.bonds
        for part in (bond.one, bond.other)
        for k in range(part.first, part.last)
    }
    edges = []
    for block, grid in enumerate(layout.blocks):
        for side in ("bottom", "right", "top", "left"):
            count = grid.shape[0 if side in ("bottom", "top") else 1]
            edges += [(block, side, k) for k in range(count - 1) if (block, side, k) not in inside]
    return edges


def outer_lines(layout: MultiBlock, groups: Mapping[Edge, int]) -> list[OuterLine]:
    """Return the longest lines of some edges of the outer boundary, in the order of these.

    A line ends at corners of the domain, that is, of a block whose both sides there are outer ones; where the next edge
    is of another group, or of none; where the outer boundary touches itself; and at nodes that are others' copies up
    to a motion.

    Args:
        layout: the blocks.
        groups: the edges, each with the number of its group; only edges of one group are in one line.
    """
    numbers = first_copies(layout.copies, [grid.shape for grid in layout.blocks])
    walked = [_walked(edge, layout, numbers) for edge in outer_edges(layout)]
    leaving: dict[int, list[_Walked]] = {}
    coming: dict[int, list[_Walked]] = {}
    for one in walked:
        leaving.setdefault(one.nodes[0], []).append(one)
        coming.setdefault(one.nodes[1], []).append(one)
    moved = _moved_nodes(layout, numbers)

    def after(one: _Walked) -> _Walked | None:
        """Return the edge that goes on a line; None where the line ends."""
        node = one.nodes[1]
        if node in moved or len(coming[node]) != 1 or len(leaving.get(node, ())) != 1:
            return None
        (other,) = leaving[node]
        corner = other.places[0] == one.places[1] and other.edge[1] != one.edge[1]
        return None if corner or groups.get(other.edge) != groups.get(one.edge) else other

    follows = {one.edge: after(one) for one in walked if one.edge in groups}
    begun = {other.edge for other in follows.values() if other is not None}
    lines, used = [], set()
    chosen = [one for one in walked if one.edge in groups]
    for one in sorted(chosen, key=lambda one: one.edge in begun):  # Those that begin lines first.
        if one.edge in used:
            continue
        line, at = [one], follows[one.edge]
        while at is not None and at is not one:
            line.append(at)
            at = follows[at.edge]
        used |= {each.edge for each in line}
        places = np.array([line[0].places[0], *(each.places[1] for each in line)], dtype=np.intp).T
        if at is one:
            places[:, -1] = places[:, 0]
        lines.append(OuterLine(groups[one.edge], tuple(each.edge for each in line), places, closed=at is one))
    return lines


def _walked(edge: Edge, layout: MultiBlock, numbers: Sequence[Indices]) -> _Walked:
    block, side, k = edge
    part = SidePart(block, side, k, k + 1)
    i, j = part.indices(layout.blocks[block].shape)
    order = (0, 1) if part.counterclockwise else (1, 0)
    one, other = ((block, int(i[at]), int(j[at])) for at in order)
    return _Walked(edge, (one, other), (int(numbers[block][one[1:]]), int(numbers[block][other[1:]])))


def _moved_nodes(layout: MultiBlock, numbers: Sequence[Indices]) -> set[int]:
    """Return the numbers of nodes whose copies lie elsewhere."""
    copies = layout.copies
    points: Array = np.array(
        [layout.blocks[b].planes[:, i, j] for b, i, j in zip(copies.block, copies.i, copies.j, strict=True)]
    ).reshape(-1, 2)
    first = np.repeat(points[copies.starts], copies.counts, axis=0)
    elsewhere = (points != first).any(axis=1)
    entries = zip(copies.block[elsewhere], copies.i[elsewhere], copies.j[elsewhere], strict=True)
    return {int(numbers[b][i, j]) for b, i, j in entries}
