"""The Jacobian of the equations of several blocks as one sparse matrix over the different free nodes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from ....arrays import Array, Mask
from ....runtime import JACOBIAN_PLANES
from ....topology.copies import Copies, Indices
from ....topology.stencils import Stencils
from ...layout.sparse import node_numbers, node_turns

#: Where the neighbors of a node are whose derivatives the planes hold, four for each.
_NEIGHBORS = tuple(product((-1, 0, 1), repeat=2))


class LayoutJacobian:
    """Puts the planes of blocks and of stencils across connections together; unknowns as in `LayoutMatrix`."""

    def __init__(self, copies: Copies, fixed: Sequence[Mask], stencils: Stencils, groups: Sequence[Indices]) -> None:
        """Find where the entries of the matrix come from.

        Args:
            copies: the nodes with several copies.
            fixed: for each block the mask of nodes without unknowns.
            stencils: across connections.
            groups: which of them are evaluated together, in this order after the blocks.
        """
        numbers, count = node_numbers(copies, fixed)
        turns = node_turns(copies, fixed)
        self._size, self._begin = 2 * count, 0
        self._parts: list[tuple[Any, ...]] = []
        for number, turn in zip(numbers, turns, strict=True):
            self._add_block(number, turn)
        first = copies.starts[stencils.node]
        rows = np.array([numbers[b][i, j] for b, i, j in _places(copies, first)], dtype=np.intp)
        for chosen in groups:
            self._add_stencils(rows[chosen], stencils, chosen, numbers, turns)
        source, row, column, turn = (np.concatenate(part, axis=-1) for part in zip(*self._parts, strict=True))
        del self._parts
        entry = np.arange(4)[:, None]
        self._source, self._turn, self._turned = source, turn, bool((copies.turn[0] != 1).any())
        self._rows, self._columns = (2 * row + entry // 2).ravel(), (2 * column + entry % 2).ravel()

    def _add_block(self, number: Indices, turn: Array) -> None:
        """Add the entries of the nodes inside of a block."""
        ni, nj = number.shape
        flat = np.arange(number.size).reshape(ni, nj)
        here = np.s_[1:-1, 1:-1]
        for neighbor, (di, dj) in enumerate(_NEIGHBORS):
            there = np.s_[1 + di : ni - 1 + di, 1 + dj : nj - 1 + dj]
            both = (number[here] >= 0) & (number[there] >= 0)
            source = self._begin + np.arange(4 * neighbor, 4 * neighbor + 4)[:, None] * number.size + flat[here][both]
            self._parts.append((source, number[here][both], number[there][both], turn[:, *there][:, both]))
        self._begin += JACOBIAN_PLANES * number.size

    def _add_stencils(
        self,
        rows: Indices,
        stencils: Stencils,
        chosen: Indices,
        numbers: Sequence[Indices],
        turns: Sequence[Array],
    ) -> None:
        """Add the entries of nodes on connections."""
        count = len(chosen)
        for neighbor in range(len(_NEIGHBORS)):
            places = [one[0, neighbor, chosen] for one in (stencils.block, stencils.i, stencils.j)]
            columns, turn = np.empty(count, dtype=np.intp), np.empty((2, count))
            for block, (number, of_block) in enumerate(zip(numbers, turns, strict=True)):
                here = places[0] == block
                columns[here] = number[places[1][here], places[2][here]]
                turn[:, here] = of_block[:, places[1][here], places[2][here]]
            free = np.flatnonzero(columns >= 0)
            source = self._begin + np.arange(4 * neighbor, 4 * neighbor + 4)[:, None] * count + free
            self._parts.append((source, rows[free], columns[free], turn[:, free]))
        self._begin += JACOBIAN_PLANES * count

    def assemble(self, planes: Sequence[Array]) -> Any:  # noqa: ANN401 - scipy.sparse has no types
        """Return the matrix (CSR) of the planes (36, ni, nj) of blocks, and then those (36, n) of stencils."""
        from scipy import sparse

        values = np.concatenate([part.ravel() for part in planes])[self._source]
        if self._turned:
            (xx, xy, yx, yy), (c, s) = values, self._turn
            values = np.stack((c * xx + s * xy, c * xy - s * xx, c * yx + s * yy, c * yy - s * yx))
        return sparse.csr_matrix((values.ravel(), (self._rows, self._columns)), shape=(self._size, self._size))


def _places(copies: Copies, entries: Indices) -> list[tuple[int, int, int]]:
    parts = (one[entries].tolist() for one in (copies.block, copies.i, copies.j))
    return list(zip(*parts, strict=True))
