"""The Hessian of several blocks as one sparse matrix over the different free nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...topology.copies import Copies
from .exchange import node_numbers

#: Neighbors whose blocks the Hessian stores, and the first of their planes.
_NEIGHBORS = (((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))


class LayoutMatrix:
    """Puts the Hessians of blocks together, and takes fields to vectors of unknowns and back.

    Unknown 2 k + c is component c of the k-th node, in the turn of its first copy.

    Attributes:
        size: the number of unknowns.
    """

    def __init__(self, copies: Copies, fixed: Sequence[Mask]) -> None:
        """Number the unknowns."""
        self._numbers, count = node_numbers(copies, fixed)
        self.size = 2 * count
        self._turns = []
        for block, mask in enumerate(fixed):
            turn = np.zeros((2, *mask.shape))
            turn[0] = 1.0
            here = copies.block == block
            turn[:, copies.i[here], copies.j[here]] = copies.turn[:, here]
            self._turns.append(turn)

    def assemble(self, hessians: Sequence[Array]) -> Any:  # noqa: ANN401 - scipy.sparse has no types
        """Return the matrix (CSC) of the stored halves (19, ni, nj) of the blocks' own Hessians."""
        from scipy import sparse

        blocks = zip(hessians, self._numbers, self._turns, strict=True)
        parts = [self._entries(planes, numbers, turn) for planes, numbers, turn in blocks]
        rows, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
        return sparse.csc_matrix((values, (rows, columns)), shape=(self.size, self.size))

    def vector(self, fields: Sequence[Array]) -> Array:
        """Return the sums over copies of distributed fields (2, ni, nj), as a vector of unknowns."""
        total = np.zeros(self.size)
        for field, numbers, (c, s) in zip(fields, self._numbers, self._turns, strict=True):
            free = numbers >= 0
            x, y, at = field[0][free], field[1][free], 2 * numbers[free]
            np.add.at(total, at, c[free] * x + s[free] * y)
            np.add.at(total, at + 1, c[free] * y - s[free] * x)
        return total

    def fields(self, vector: Array, into: Sequence[Array]) -> None:
        """Write a vector of unknowns as consistent fields (2, ni, nj), zero at fixed nodes."""
        for field, numbers, (c, s) in zip(into, self._numbers, self._turns, strict=True):
            free = numbers >= 0
            x, y = vector[2 * numbers[free]], vector[2 * numbers[free] + 1]
            field[...] = 0.0
            field[0][free] = c[free] * x - s[free] * y
            field[1][free] = s[free] * x + c[free] * y

    @staticmethod
    def _entries(planes: Array, numbers: npt.NDArray[np.int64], turn: Array) -> tuple[Array, Array, Array]:
        """Return rows, columns and values of a block."""
        ni, nj = numbers.shape
        found: list[tuple[Array, Array, Array]] = []

        def add(blocks: Array, here: Any, there: Any, *, both_ways: bool) -> None:  # noqa: ANN401
            first, second = numbers[here], numbers[there]
            free = (first >= 0) & (second >= 0)
            turned = _turned(blocks[:, free], turn[:, *here][:, free], turn[:, *there][:, free])
            for entry in range(4):
                rows, columns = 2 * first[free] + entry // 2, 2 * second[free] + entry % 2
                found.append((rows, columns, turned[entry]))
                if both_ways:
                    found.append((columns, rows, turned[entry]))

        every = np.s_[:, :]
        add(planes[[0, 1, 1, 2]], every, every, both_ways=False)
        for (di, dj), first in _NEIGHBORS:
            here = slice(0, ni - di), slice(max(0, -dj), nj - max(0, dj))
            there = slice(di, ni), slice(max(0, dj), nj + min(0, dj))
            add(planes[first : first + 4][:, *here], here, there, both_ways=True)
        rows, columns, values = (np.concatenate(part) for part in zip(*found, strict=True))
        return rows, columns, values


def _turned(blocks: Array, first: Array, second: Array) -> Array:
    """Return R1ᵀ B R2 of blocks (4, n): xx, xy, yx, yy."""
    if (first[0] == 1).all() and (second[0] == 1).all():
        return blocks
    xx, xy, yx, yy = blocks
    c, s = first
    xx, xy, yx, yy = c * xx + s * yx, c * xy + s * yy, c * yx - s * xx, c * yy - s * xy
    c, s = second
    return np.stack((c * xx + s * xy, c * xy - s * xx, c * yx + s * yy, c * yy - s * yx))
