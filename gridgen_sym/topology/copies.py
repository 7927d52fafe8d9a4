"""Which nodes of the blocks are copies of one node, and how the copies lie to each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from .connection import Motion, SidePart

Indices = npt.NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Bond:
    """Two parts whose nodes are the same, in the order of `one`.

    Attributes:
        one, other: the parts.
        motion: takes the nodes of `one` to those of `other`.
    """

    one: SidePart
    other: SidePart
    motion: Motion

    @property
    def reversed(self) -> bool:
        """Whether the nodes of the parts are counted in opposite directions: where both blocks have J > 0."""
        return self.one.counterclockwise == self.other.counterclockwise

    def indices(self, shapes: Sequence[tuple[int, int]]) -> tuple[tuple[Indices, Indices], tuple[Indices, Indices]]:
        """Return the indices (i, j) of the nodes of both parts, node by node."""
        i, j = self.other.indices(shapes[self.other.block])
        return self.one.indices(shapes[self.one.block]), (i[::-1], j[::-1]) if self.reversed else (i, j)


@dataclass(frozen=True, slots=True, eq=False)
class Copies:
    """The nodes that have several copies: entries, one for each copy, those of one node together.

    Attributes:
        starts: the first entry of every node; (nodes,).
        block, i, j: where each copy is; (entries,).
        turn: the cosine and the sine of the rotation from the first copy to each; (2, entries).
    """

    starts: Indices
    block: Indices
    i: Indices
    j: Indices
    turn: Array

    @property
    def counts(self) -> Indices:
        """The number of copies of every node."""
        return np.diff(np.append(self.starts, len(self.block)))

    @property
    def node(self) -> Indices:
        """The number of the node that each entry is a copy of."""
        return np.repeat(np.arange(len(self.starts)), self.counts)


def first_copies(copies: Copies, shapes: Sequence[tuple[int, int]]) -> list[Indices]:
    """Return for each block the number (ni, nj) of the first copy of every node, among the nodes of all blocks."""
    offsets = np.cumsum([0, *(ni * nj for ni, nj in shapes)])
    flat = np.arange(offsets[-1], dtype=np.intp)
    widths = np.array([nj for _, nj in shapes])
    place = offsets[copies.block] + copies.i * widths[copies.block] + copies.j
    flat[place] = np.repeat(place[copies.starts], copies.counts)
    return [flat[a:b].reshape(shape) for a, b, shape in zip(offsets[:-1], offsets[1:], shapes, strict=True)]
