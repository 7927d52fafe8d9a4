"""The vectors of conjugate gradients over several blocks: all blocks in one array, with the margins of their levels."""

from __future__ import annotations

import ctypes

import numpy as np

from ...arrays import Array
from ...topology.copies import Copies
from ..linear.multigrid.hierarchy import MARGIN
from .exchange import Exchange
from .levels import BlockLevel


class BlockVectors:
    """Solution x, residual r, direction p and its product q; r and q are sums over copies, x and p the same in all.

    Attributes:
        x, r, p, q: the vectors.
        scale: from the residual to the right-hand side of a cycle.
        begin_of_blocks, rows_of_blocks: where a block's first node stands in a vector, and its first row in `sums`.
        sums: a number for each row.
    """

    def __init__(self, level: BlockLevel, exchange: Exchange, copies: Copies) -> None:
        """Allocate for the finest level."""
        self._level, self._exchange = level, exchange
        widths = np.array([block.right[0].size for block in level.blocks])
        rows = np.array([mask.shape[0] for mask in level.fixed])
        ends = np.cumsum(widths * (rows + sum(MARGIN)))
        self.size = int(ends[-1])
        self.begin_of_blocks = (ends - widths * (rows + MARGIN[1])).astype(np.int64)
        self.rows_of_blocks = np.concatenate(([0], np.cumsum(rows)[:-1])).astype(np.int64)
        self.x, self.r, self.p, self.q = (np.zeros(self.size) for _ in range(4))
        self.sums, self.scale = np.zeros(int(rows.sum())), 0.0
        begin, half = self.begin_of_blocks[copies.block], widths[copies.block] // 2
        first = begin + 2 * copies.i * half + copies.j
        self._places, self._copies = np.stack((first, first + half)), copies
        self._shared = Exchange(copies, exchange.shapes, places=self._places)

    def _views(self, vector: Array) -> list[Array]:
        """Return the blocks of a vector, (2, ni, nj) each, in its memory."""
        found = []
        for begin, block, mask in zip(self.begin_of_blocks, self._level.blocks, self._level.fixed, strict=True):
            ni, nj = mask.shape
            width = block.right[0].size
            rows = vector[begin : begin + ni * width].reshape(ni, 2, width // 2)
            found.append(rows.transpose(1, 0, 2)[:, :, :nj])
        return found

    def begin(self, right: Array) -> None:
        """Begin with a distributed right-hand side, as `Exchange` stores it."""
        for vector in (self.x, self.p, self.q):
            vector[:] = 0.0
        for mine, given in zip(self._views(self.r), self._exchange.views(right), strict=True):
            mine[...] = given
        self.scale = 0.0

    def field(self, vector: Array) -> Array:
        """Return a vector as `Exchange` stores it."""
        return self._exchange.join(self._views(vector))

    def step(self, length: float, library: ctypes.CDLL, threads: int) -> float:
        """Set x += length p, r -= length q, and the right-hand side of the next cycle; return r.r.

        The sum over the copies of a node goes to the first: parts that nearly cancel would lose digits in single
        precision.
        """
        pointers = (vector.ctypes.data for vector in (self.p, self.q, self.x, self.r))
        right = self._level.memory[0]
        square = float(library.step_vectors(self.size, threads, length, *pointers, right.ctypes.data, self.scale))
        apart, together = self.r[self._places], self._shared.sums(self.r)
        for vector, factor in ((self.r, 1.0), (right, self.scale)):
            vector[self._places] = 0.0
            vector[self._places[:, self._copies.starts]] = factor * together
        return max(square - float((apart * apart).sum()) + float((together * together).sum()), 0.0)

    def product(self, library: ctypes.CDLL, threads: int) -> float:
        """Return z.r, z being the solution of the last cycle."""
        return float(
            library.product_of_vectors(self.size, threads, self._level.memory[1].ctypes.data, self.r.ctypes.data)
        )

    def next_direction(self, beta: float, library: ctypes.CDLL, threads: int) -> None:
        """Set p = z + beta p, the same in all copies."""
        library.next_direction(self.size, threads, beta, self._level.memory[1].ctypes.data, self.p.ctypes.data)
        self._shared.copy_first(self.p)
