"""Conjugate gradients preconditioned by a multigrid cycle over several blocks.

The levels of the blocks are coarsened alike, so that shared nodes stay shared. On a level every block relaxes its own
lines, then the shared nodes are relaxed with their summed blocks; on the coarsest level a sparse factorization solves.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...arrays import Array, Mask
from ...runtime import threads_for
from ...topology.copies import Bond, Copies
from ..linear.factorization import factorize
from ..linear.multigrid.library import load_library
from ..linear.solution import Solution
from .exchange import Exchange
from .levels import BlockLevel, plan_levels
from .sparse import LayoutMatrix
from .vectors import BlockVectors

_MOST_ITERATIONS = 200


class LayoutMultigrid:
    """Solves with the Hessians (19, ni, nj) of blocks, each of its own cells."""

    def __init__(self, exchange: Exchange, copies: Copies, fixed: Sequence[Mask], bonds: Sequence[Bond]) -> None:
        """Keep the layout; the levels are chosen for the first Hessian."""
        self.library = load_library("blocks")
        self._exchange, self._copies, self._fixed, self._bonds = exchange, copies, list(fixed), tuple(bonds)
        self._threads = threads_for(exchange.size // 2)
        self.levels: list[BlockLevel] = []
        self._vectors: BlockVectors | None = None
        self._coarsest: LayoutMatrix | None = None
        self._factors: Any = None
        self._size = 1.0

    def set_operator(self, planes: list[Array]) -> bool:
        """Take the Hessians of the blocks; return whether all levels are usable."""
        nodes = sum(block[0].size for block in planes)
        self._size = sum(float(np.abs(block[0]).sum()) for block in planes) / nodes
        if not 0 < self._size < np.inf:
            return False
        if not self.levels:
            self.levels = plan_levels(self.library, self._copies, self._fixed, self._bonds, planes, 1 / self._size)
            self._vectors = BlockVectors(self.levels[0], self._exchange, self._copies)
            self._coarsest = LayoutMatrix(self.levels[-1].copies, self.levels[-1].fixed, self.levels[-1].places())
        else:
            self.levels[0].take(planes, 1 / self._size)
            for fine, coarse in zip(self.levels[:-1], self.levels[1:], strict=True):
                coarse.coarsen_from(fine)
        return all(level.factor() for level in self.levels[:-1]) and self._factor_coarsest()

    def _factor_coarsest(self) -> bool:
        assert self._coarsest is not None
        none_free = self._coarsest.size == 0
        self._factors = None if none_free else factorize(self._coarsest.assemble(self.levels[-1].planes()))
        return none_free or self._factors is not None

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a consistent right-hand side, one array of all blocks, to a relative residual."""
        vectors = self._vectors
        assert vectors is not None
        vectors.begin(self._exchange.distributed(right))
        first = norm = vectors.step(0.0, self.library, self._threads)
        if not first > 0:
            return Solution(np.zeros_like(right), 0, 0.0, True)
        vectors.scale = 1 / float(np.sqrt(first / right.size))  # It keeps single precision in range.
        vectors.step(0.0, self.library, self._threads)
        done, previous, positive = 0, 1.0, True
        while done < _MOST_ITERATIONS and norm > tolerance**2 * first:
            self._cycle(0)
            product = vectors.product(self.library, self._threads)
            vectors.next_direction(product / previous if done else 0.0, self.library, self._threads)
            curvature = self._multiply(vectors)
            done += 1
            if not (curvature > 0 and product > 0):
                positive = False
                break
            norm, previous = vectors.step(product / curvature, self.library, self._threads), product
        found = vectors.field(vectors.x if positive else vectors.p)
        found /= self._size
        reduction = float(np.sqrt(norm / first))
        return Solution(found, done, reduction, positive and reduction < 1)

    def _multiply(self, vectors: BlockVectors) -> float:
        """Set q = A p; return p.q."""
        level = self.levels[0]
        return float(
            self.library.multiply_blocks(
                level.structures,
                len(level.blocks),
                self._threads,
                vectors.begin_of_blocks.ctypes.data,
                vectors.rows_of_blocks.ctypes.data,
                vectors.p.ctypes.data,
                vectors.q.ctypes.data,
                vectors.sums.ctypes.data,
            )
        )

    def _cycle(self, number: int) -> None:
        """Set the solution of a level to that of one V-cycle for its right-hand side, from zero."""
        level, library = self.levels[number], self.library
        if number == len(self.levels) - 1:
            self._solve_coarsest(level)
            return
        count, threads = len(level.blocks), level.threads
        level.clear()
        library.smooth_blocks(level.relaxed, count, threads, 1)
        library.relax_shared(level.structures, ctypes.byref(level.shared), 0)
        self._correct_crossing(level)
        library.residual_of_blocks(level.structures, count, threads)
        coarse = self.levels[number + 1]
        library.restrict_blocks(level.structures, coarse.structures, count, threads)
        self._cycle(number + 1)
        library.correct_blocks(coarse.structures, level.structures, count, threads)
        self._correct_crossing(level)
        library.relax_shared(level.structures, ctypes.byref(level.shared), 1)
        library.smooth_blocks_backwards(level.relaxed, count, threads)

    def _correct_crossing(self, level: BlockLevel) -> None:
        """Correct shared nodes together with the lines that cross there, where there are such."""
        if level.crossing.count:
            self.library.residual_of_blocks(level.structures, len(level.blocks), level.threads)
            shared, crossing = ctypes.byref(level.shared), ctypes.byref(level.crossing)
            self.library.correct_crossing(level.structures, shared, crossing)

    def _solve_coarsest(self, level: BlockLevel) -> None:
        assert self._coarsest is not None
        right, solution, _ = level.memory
        if self._factors is not None:
            self._coarsest.spread(self._factors.solve(self._coarsest.vector(right)), solution)
