"""Conjugate gradients preconditioned by a multigrid cycle over several blocks.

The levels of the blocks are coarsened alike, so that shared nodes stay shared. On a level every block relaxes its own
lines, then the shared nodes are relaxed with their summed blocks; on the coarsest level a sparse factorization solves.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ...arrays import Array, Mask
from ...topology.copies import Bond, Copies
from ..linear.factorization import factorize
from ..linear.multigrid.library import load_library
from ..linear.solution import Solution
from .exchange import Exchange
from .levels import BlockLevel, LevelStructure, plan_levels
from .sparse import LayoutMatrix
from .vectors import BlockVectors

_MOST_ITERATIONS = 200


class LayoutMultigrid:
    """Solves with the Hessians (19, ni, nj) of blocks, each of its own cells."""

    def __init__(
        self, exchange: Exchange, copies: Copies, fixed: Sequence[Mask], bonds: Sequence[Bond], *, precise: bool = False
    ) -> None:
        """Keep the layout; the levels are chosen for the first Hessian. `precise` ones have double precision."""
        self.library = load_library("blocks_in_double" if precise else "blocks")
        self._dtype: type[np.floating[Any]] = np.float64 if precise else np.float32
        self._exchange, self._copies, self._fixed, self._bonds = exchange, copies, list(fixed), tuple(bonds)
        self.levels: list[BlockLevel] = []
        self._structures: Any = None
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
            self._plan(planes)
        else:
            self.levels[0].take(planes, 1 / self._size)
            for fine, coarse in pairwise(self.levels):
                coarse.coarsen_from(fine)
        return all(level.factor() for level in self.levels[:-1]) and self._factor_coarsest()

    def _plan(self, planes: list[Array]) -> None:
        """Choose and set up the levels."""
        self.levels = plan_levels(
            self.library, self._copies, self._fixed, self._bonds, planes, 1 / self._size, self._dtype
        )
        self._structures = (LevelStructure * len(self.levels))(*(level.structure for level in self.levels))
        self._vectors = BlockVectors(self.levels[0], self.library)
        last = self.levels[-1]
        self._coarsest = LayoutMatrix(last.copies, last.fixed, last.memory.places(), last.memory.entries())

    def _factor_coarsest(self) -> bool:
        assert self._coarsest is not None
        none_free = self._coarsest.size == 0
        self._factors = None if none_free else factorize(self._coarsest.assemble(self.levels[-1].memory.operator))
        return none_free or self._factors is not None

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a consistent right-hand side, one array of all blocks, to a relative residual."""
        vectors = self._vectors
        assert vectors is not None
        first = norm = vectors.begin(right)
        if not first > 0:
            return Solution(np.zeros_like(right), 0, 0.0, True)
        scale = 1 / float(np.sqrt(first / right.size))  # It keeps single precision in range.
        vectors.step(0.0, scale)
        done, previous, positive = 0, 1.0, True
        while done < _MOST_ITERATIONS and norm > tolerance**2 * first:
            self._cycle()
            product = vectors.product()
            curvature = vectors.multiply(product / previous if done else 0.0)
            done += 1
            if not (curvature > 0 and product > 0):
                positive = False
                break
            norm, previous = vectors.step(product / curvature, scale), product
        found = vectors.give(np.empty_like(right), 1 / self._size, direction=not positive)
        reduction = float(np.sqrt(norm / first))
        return Solution(found, done, reduction, positive and reduction < 1)

    def _cycle(self) -> None:
        """Set the solution of the finest level to that of one V-cycle for its right-hand side, from zero."""
        assert self._coarsest is not None
        last = self.levels[-1].memory
        self.library.cycle_down(self._structures, len(self.levels))
        if self._factors is not None:
            self._coarsest.spread(self._factors.solve(self._coarsest.vector(last.right)), last.solution)
        self.library.cycle_up(self._structures, len(self.levels))
