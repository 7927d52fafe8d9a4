"""Blocks that are connected along whole sides, as fewer and larger ones: solvers cost less on these."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.sides import Sides
from ..grids import Grid
from .connection import IDENTITY, Connection, Motion, SidePart
from .copies import Bond
from .multiblock import MultiBlock

#: Of more blocks that are put together not all are named.
_MOST_NAMED = 8
#: A whole side of a block.
Side = tuple[int, str]
_NAMES = Sides._fields


@dataclass(slots=True)
class _Cluster:
    """Blocks put together.

    Attributes:
        cells: (ni - 1, nj - 1), the numbers of its cells among those of all blocks.
        sides: the whole sides of blocks that its four sides consist of, counter-clockwise.
    """

    cells: npt.NDArray[np.intp]
    sides: list[list[Side]]

    def turned(self, quarters: int) -> _Cluster:
        """Return it turned counter-clockwise."""
        cells = self.cells
        for _ in range(quarters):
            cells = cells.T[::-1]
        return _Cluster(cells, [self.sides[(side - quarters) % 4] for side in range(4)])

    def joined(self, side: int, other: _Cluster) -> _Cluster:
        """Return it with another cluster at one of its sides."""
        pair = [self.cells, other.cells] if side in (1, 2) else [other.cells, self.cells]
        sides: list[list[Side]] = [[], [], [], []]
        sides[side], sides[side - 2] = other.sides[side], self.sides[side - 2]
        sides[side - 1] = self.sides[side - 1] + other.sides[side - 1]
        sides[(side + 1) % 4] = other.sides[(side + 1) % 4] + self.sides[(side + 1) % 4]
        return _Cluster(np.concatenate(pair, axis=0 if side in (1, 3) else 1), sides)


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a block is: node (a, b) of it is node origin + a xi + b eta of a merged block."""

    block: int
    origin: tuple[int, int]
    xi: tuple[int, int]
    eta: tuple[int, int]

    def node(self, a: int, b: int) -> tuple[int, int]:
        """Return the indices of a node in the merged block."""
        return (
            self.origin[0] + a * self.xi[0] + b * self.eta[0],
            self.origin[1] + a * self.xi[1] + b * self.eta[1],
        )

    def view(self, merged: Array, shape: tuple[int, int]) -> Array:
        """Return the nodes of the block, (2, ni, nj), in the memory of the planes of its merged block."""
        (i, j), turned = self.origin, self.xi[0] == 0
        along_i, along_j = (self.eta[0], self.xi[1]) if turned else (self.xi[0], self.eta[1])
        counts = shape[::-1] if turned else shape
        view = merged[:, _from(i, along_i, counts[0]), _from(j, along_j, counts[1])]
        return view.transpose(0, 2, 1) if turned else view


def _from(first: int, step: int, count: int) -> slice:
    """Return the slice of `count` indices from the first one, by steps of 1 or -1."""
    end = first + step * count
    return slice(first, end if end >= 0 else None, step)


@dataclass(frozen=True, slots=True)
class Merged:
    """A layout of fewer blocks.

    Attributes:
        layout: the merged blocks.
        shapes: of the blocks before.
        places: where each of these is.
    """

    layout: MultiBlock
    shapes: tuple[tuple[int, int], ...]
    places: tuple[_Place, ...]

    def join(self, planes: Sequence[Array]) -> MultiBlock:
        """Return the merged layout with other coordinates: (2, ni, nj) of each of the blocks before."""
        merged = [np.array(grid.planes) for grid in self.layout.blocks]
        for place, shape, own in zip(self.places, self.shapes, planes, strict=True):
            place.view(merged[place.block], shape)[...] = own
        return self.layout.moved(merged)

    def moved(self, nodes: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
        """Return where nodes are in the merged blocks, from where they are in the blocks before: block, i, j (3, n)."""
        parts = [(*(self.places[b].node(i, j)), self.places[b].block) for b, i, j in nodes.T.tolist()]
        return np.array(parts, dtype=np.intp).reshape(-1, 3).T[[2, 0, 1]]

    def split(self, planes: Sequence[Array]) -> list[Array]:
        """Return the coordinates of the blocks before, from those of the merged ones."""
        return [place.view(planes[place.block], shape) for place, shape in zip(self.places, self.shapes, strict=True)]


def merge(layout: MultiBlock) -> Merged:
    """Put blocks together that are connected along whole sides, as long as that gives blocks."""
    shapes = tuple(grid.shape for grid in layout.blocks)
    clusters, inside = _clusters(layout, shapes)
    places = _places(clusters, shapes)
    merged = [np.empty((2, cluster.cells.shape[0] + 1, cluster.cells.shape[1] + 1)) for cluster in clusters]
    for place, grid in zip(places, layout.blocks, strict=True):
        place.view(merged[place.block], grid.shape)[...] = grid.planes
    names = [
        joined_names(layout, [k for k, place in enumerate(places) if place.block == m]) for m in range(len(merged))
    ]
    grids = {name: Grid.from_planes(*planes) for name, planes in zip(names, merged, strict=True)}
    bonds = []
    for bond in layout.bonds:
        if (bond.one.block, bond.one.side) not in inside:
            one, other = (_moved_part(part, places, shapes, clusters) for part in (bond.one, bond.other))
            bonds.append(Bond(one, other, bond.motion))
    return Merged(MultiBlock(grids, [_connection(bond) for bond in _joined(bonds)]), shapes, places)


def joined_names(layout: MultiBlock, blocks: Sequence[int]) -> str:
    """Return a name for some of the blocks together; of many the first and the last are named."""
    names = [layout.names[block] for block in blocks]
    return " + ".join(names if len(names) <= _MOST_NAMED else [names[0], "...", names[-1]])


def _clusters(layout: MultiBlock, shapes: Sequence[tuple[int, int]]) -> tuple[list[_Cluster], set[Side]]:
    """Return the merged blocks, and the sides of blocks that are inside of them."""
    begin = np.cumsum([0, *((ni - 1) * (nj - 1) for ni, nj in shapes)])
    clusters = {
        block: _Cluster(
            begin[block] + np.arange((ni - 1) * (nj - 1)).reshape(ni - 1, nj - 1), [[(block, side)] for side in _NAMES]
        )
        for block, (ni, nj) in enumerate(shapes)
    }
    partners, home = _whole_sides(layout, shapes), {block: block for block in clusters}
    members = {block: [block] for block in clusters}
    inside: set[Side] = set()
    waiting = list(clusters)
    while waiting:
        number = waiting.pop()
        if number not in clusters:
            continue
        for side in range(4):
            own = clusters[number].sides[side]
            facing = partners.get(own[0])
            if facing is None or home[facing[0]] == number:
                continue
            other = home[facing[0]]
            at = next((k for k in range(4) if clusters[other].sides[k][-1] == facing), None)
            if at is None or [partners.get(one) for one in own] != clusters[other].sides[at][::-1]:
                continue
            inside |= {*clusters[number].sides[side], *clusters[other].sides[at]}
            found = clusters.pop(other).turned((side + 2 - at) % 4)
            home |= dict.fromkeys(members[other], number)
            members[number] += members.pop(other)
            clusters[number] = clusters[number].joined(side, found)
            waiting.append(number)
            break
    return list(clusters.values()), inside


def _whole_sides(layout: MultiBlock, shapes: Sequence[tuple[int, int]]) -> dict[Side, Side]:
    """Return the partners of sides that are connected as a whole, to another block and at their place."""
    found = {}
    for bond in layout.bonds:
        parts = bond.one, bond.other
        if bond.one.block == bond.other.block or bond.motion != IDENTITY:
            continue
        if all(part.first == 0 and part.last == shapes[part.block][part.axis] - 1 for part in parts):
            one, other = ((part.block, part.side) for part in parts)
            found[one], found[other] = other, one
    return found


def _places(clusters: Sequence[_Cluster], shapes: Sequence[tuple[int, int]]) -> tuple[_Place, ...]:
    """Find every block in the merged ones, by its first cells."""
    count = sum(cluster.cells.size for cluster in clusters)
    where = np.empty((3, count), dtype=np.intp)
    for number, cluster in enumerate(clusters):
        i, j = np.indices(cluster.cells.shape)
        where[:, cluster.cells] = np.stack((np.full_like(i, number), i, j))
    places, begin = [], 0
    for ni, nj in shapes:
        first, along_xi, along_eta = (where[1:, begin + step] for step in (0, nj - 1, 1))
        xi, eta = along_xi - first, along_eta - first
        origin = first + ((xi + eta) < 0)
        pair = [(int(one[0]), int(one[1])) for one in (origin, xi, eta)]
        places.append(_Place(int(where[0, begin]), *pair))
        begin += (ni - 1) * (nj - 1)
    return tuple(places)


def _moved_part(
    part: SidePart, places: Sequence[_Place], shapes: Sequence[tuple[int, int]], clusters: Sequence[_Cluster]
) -> SidePart:
    """Return a part of a side as that of a merged block."""
    place, (i, j) = places[part.block], part.indices(shapes[part.block])
    ends = place.node(int(i[0]), int(j[0])), place.node(int(i[-1]), int(j[-1]))
    axis = 0 if ends[0][1] == ends[1][1] else 1
    far = (1, 0)[axis]
    low = ("bottom", "left")[axis]
    side = low if ends[0][far] == 0 else {"bottom": "top", "left": "right"}[low]
    if ends[0][far] not in (0, clusters[place.block].cells.shape[far]):
        raise AssertionError("a part of a side that is connected lies inside of a merged block")
    first, last = sorted((ends[0][axis], ends[1][axis]))
    return SidePart(place.block, side, first, last)


def _joined(bonds: Sequence[Bond]) -> list[Bond]:
    """Return bonds of which those that continue each other are one."""
    found: list[Bond] = []
    for bond in sorted(bonds, key=lambda bond: bond.one):
        last = found[-1] if found else None
        if last is not None and _continues(last, bond):
            first, end = min(last.other.first, bond.other.first), max(last.other.last, bond.other.last)
            found[-1] = Bond(
                replace(last.one, last=bond.one.last), replace(last.other, first=first, last=end), last.motion
            )
        else:
            found.append(bond)
    return found


def _continues(last: Bond, bond: Bond) -> bool:
    """Whether a bond begins where another ends, on both sides."""
    same = (last.one.block, last.one.side, last.other.block, last.other.side, last.motion) == (
        bond.one.block,
        bond.one.side,
        bond.other.block,
        bond.other.side,
        bond.motion,
    )
    ends = (bond.other.last, last.other.first) if bond.reversed else (last.other.last, bond.other.first)
    return same and last.one.last == bond.one.first and ends[0] == ends[1]


def _connection(bond: Bond) -> Connection:
    one, other = ((part.block, part.side, (part.first, part.last)) for part in (bond.one, bond.other))
    made = Connection(one, other)
    made.motion = Motion(bond.motion.angle, bond.motion.shift)
    return made
