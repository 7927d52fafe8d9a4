"""The lines of nodes that cross blocks: which of them are one, and which a coarser layout leaves out.

A line of a block has an index along one of its directions. Connections continue lines from block to block, so a line is
left out in all blocks or in none.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from .components import component_numbers
from .connection import SidePart
from .copies import Bond, Copies, Indices
from .directions import direction_groups


@dataclass(frozen=True, slots=True, eq=False)
class Coarsening:
    """The lines that a coarser layout keeps: the ends of blocks, and of two neighbors at least one.

    Attributes:
        begin: where the lines of each direction of each block begin in the other arrays, xi of block 0 first, and where
            the last ones end.
        stays: whether a line is kept.
        rank: its index among those that are.
    """

    begin: Indices
    stays: npt.NDArray[np.bool_]
    rank: Indices

    @property
    def kept(self) -> list[tuple[Indices, Indices]]:
        """For each block the indices of the rows and columns that are kept."""
        counts = np.add.reduceat(self.stays.astype(np.intp), self.begin[:-1])
        lines = np.flatnonzero(self.stays) - np.repeat(self.begin[:-1], counts)
        found = [lines[a:b] for a, b in pairwise([0, *np.cumsum(counts).tolist()])]
        return list(zip(found[::2], found[1::2], strict=True))

    @property
    def places(self) -> list[tuple[Array, Array]]:
        """For each block the places of all of its rows and columns among those that are kept: halfway between two."""
        every = self.rank.astype(np.float64) + np.where(self.stays, 0.0, -0.5)
        found = [every[a:b] for a, b in pairwise(self.begin.tolist())]
        return list(zip(found[::2], found[1::2], strict=True))

    def bonds(self, bonds: Sequence[Bond]) -> list[Bond]:
        """Return the connections of the coarser blocks, which begin and end at lines that are kept."""

        def coarse(part: SidePart) -> SidePart:
            begin = self.begin[2 * part.block + part.axis]
            return replace(part, first=int(self.rank[begin + part.first]), last=int(self.rank[begin + part.last]))

        return [Bond(coarse(bond.one), coarse(bond.other), bond.motion) for bond in bonds]

    def copies(self, copies: Copies) -> Copies:
        """Return the copies of the nodes on lines that are kept in both directions."""
        i, j = self.begin[2 * copies.block] + copies.i, self.begin[2 * copies.block + 1] + copies.j
        stay = self.stays[i] & self.stays[j]
        starts = np.flatnonzero(np.diff(copies.node[stay], prepend=-1))
        return Copies(starts, copies.block[stay], self.rank[i[stay]], self.rank[j[stay]], copies.turn[:, stay])


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """The lines of all blocks.

    Attributes:
        begin: as in `Coarsening`.
        number: of the line that each belongs to.
        held: for each of these numbers whether it must be kept: the ends of sides, and of connections.
        group: of its direction, as in `direction_groups`.
    """

    begin: Indices
    number: Indices
    held: npt.NDArray[np.bool_]
    group: Indices

    @classmethod
    def of(cls, bonds: Sequence[Bond], groups: Sequence[tuple[int, int]], shapes: Sequence[tuple[int, int]]) -> Lines:
        """Number the lines of blocks of these shapes (ni, nj)."""
        counts = np.array(shapes, dtype=np.intp).ravel()
        begin = np.concatenate(([0], np.cumsum(counts)))
        pairs = [(bond.one, bond.other) for bond in bonds]
        first, second = (
            np.array([begin[2 * part.block + part.axis] + part.first for part in parts], dtype=np.intp)
            for parts in ([one for one, _ in pairs], [other for _, other in pairs])
        )
        lengths = np.array([one.count for one, _ in pairs], dtype=np.intp)
        along = np.arange(lengths.sum()) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        turned = np.repeat(np.array([bond.reversed for bond in bonds], dtype=bool), lengths)
        back = np.where(turned, np.repeat(lengths - 1, lengths) - along, along)
        number = component_numbers(np.repeat(first, lengths) + along, np.repeat(second, lengths) + back, int(begin[-1]))
        held = np.zeros(begin[-1], dtype=bool)
        for ends in (begin[:-1], begin[1:] - 1, first, second, first + lengths - 1, second + lengths - 1):
            held[ends] = True
        any_held = np.bincount(number, held) > 0
        return cls(begin, number, any_held, np.repeat(np.array(groups, dtype=np.intp).ravel(), counts))

    def _free(self, least: int) -> npt.NDArray[np.bool_]:
        """Return which numbers may be left out where directions with no more cells than `least` stay as they are."""
        counts = np.diff(self.begin)
        free = ~self.held
        free[self.number[np.repeat(counts - 1 <= least, counts)]] = False
        return free

    def groups(self, least: int, most: int) -> set[int]:
        """Return the groups of directions in which lines can be left out.

        Args:
            least: directions of blocks with no more cells stay.
            most: groups in which no block has more cells stay.
        """
        large = set(self.group[self.begin[:-1][np.diff(self.begin) - 1 > most]].tolist())
        return large & set(self.group[self._free(least)[self.number]].tolist())

    def coarsening(self, groups: Collection[int], least: int) -> Coarsening:
        """Leave out about every second line of some groups; where numbers of cells are even, exactly every second."""
        free = self._free(least)
        chosen = np.isin(self.group, list(groups))
        # Neighbors of each line, in all blocks.
        pairs = np.stack((self.number[:-1], self.number[1:]))
        pairs = np.delete(pairs, self.begin[1:-1] - 1, axis=1)
        both = np.concatenate((pairs, pairs[::-1]), axis=1)
        order = np.argsort(both[0], kind="stable")
        neighbors, ends = both[1, order].tolist(), np.cumsum(np.bincount(both[0], minlength=len(self.held))).tolist()
        # One after the other along the longest rows first: what is left out holds its neighbors.
        longest = np.argsort(-np.repeat(np.diff(self.begin), np.diff(self.begin)), kind="stable")
        longest = longest[(chosen & free[self.number])[longest]]
        may, out = free.tolist(), np.zeros(len(free), dtype=bool)
        for line in dict.fromkeys(self.number[longest].tolist()):
            beside = neighbors[ends[line - 1] if line else 0 : ends[line]]
            if may[line] and line not in beside:
                out[line] = True
                for other in beside:
                    may[other] = False
        stays = ~out[self.number]
        total = np.concatenate(([0], np.cumsum(stays)))
        rank = total[:-1] - np.repeat(total[self.begin[:-1]], np.diff(self.begin))
        return Coarsening(self.begin, stays, rank)

    def coarsened(self, coarsening: Coarsening) -> Lines:
        """Return the lines that are kept."""
        total = np.concatenate(([0], np.cumsum(coarsening.stays)))
        kept = coarsening.stays
        return Lines(total[self.begin], self.number[kept], self.held, self.group[kept])


@lru_cache(maxsize=16)
def lines_of(bonds: tuple[Bond, ...], shapes: tuple[tuple[int, int], ...]) -> Lines:
    """Return the lines of blocks of these shapes; solvers ask for those of one layout several times."""
    return Lines.of(bonds, direction_groups(bonds, len(shapes)), shapes)
