"""The levels of several blocks: operators of each block's own cells, and the nodes that blocks share."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...runtime import threads_for
from ...topology.copies import Bond, Copies, Indices
from ...topology.directions import direction_groups, halvable_groups, halved_bonds
from ..linear.multigrid.hierarchy import MARGIN, allocate, coupling_sizes
from ..linear.multigrid.library import Level

#: Every block keeps at least one cell along each direction; with fewer different nodes a level is not coarsened.
_LEAST, _FEWEST_NODES = 1, 400
#: A direction whose couplings are weaker than this part of the other's is not halved.
_WEAK = 0.25


class _Shared(ctypes.Structure):
    """Nodes with several copies, as `blocks.c` declares them."""

    _fields_ = (
        ("count", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("starts", "block", "i", "j", "turn", "inverse")),
    )


class _Crossing(ctypes.Structure):
    """Shared nodes that move with the lines across a connection, as `crossing_lines.c` declares them."""

    _fields_ = (
        ("count", ctypes.c_int64),
        ("most", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("node", "inverse", "line", "along")),
    )


class BlockLevel:
    """One level of all blocks.

    Attributes:
        library: the compiled part.
        copies, fixed, bonds, groups: of the layout on this level.
        blocks: the memory of each block.
        structures, relaxed: the blocks as compiled code sees them, with all rows that have unknowns, and with the inner
            ones only, whose lines are relaxed.
        shared: the shared nodes as compiled code sees them.
        crossing: those of them that move with the lines across a connection.
        threads: that work on it.
        memory: the right-hand sides, solutions and residuals of all blocks, with their margins, in one array each.
    """

    def __init__(
        self,
        library: ctypes.CDLL,
        copies: Copies,
        fixed: Sequence[Mask],
        bonds: Sequence[Bond],
        groups: Sequence[tuple[int, int]],
    ) -> None:
        """Allocate; `groups` are the groups of the blocks' directions, the same on all levels."""
        self.groups = groups
        self.library, self.copies, self.fixed, self.bonds = library, copies, list(fixed), list(bonds)
        self.blocks, self.memory = allocate(self.fixed)
        found = [block.level() for block in self.blocks]
        self.structures = (Level * len(found))(*found)
        self.relaxed = (Level * len(found))(*found)
        for level in self.relaxed:
            level.begin_i, level.end_i, level.begin_j, level.end_j = 1, level.ni - 1, 1, level.nj - 1
        self.threads = threads_for(sum(mask.size for mask in self.fixed))
        self._share()

    def _share(self) -> None:
        """Order the free shared nodes: those with two copies first, every second one, and last those with more."""
        copies = self.copies
        first = copies.starts
        at = zip(copies.block[first], copies.i[first], copies.j[first], strict=True)
        free = np.array([self.fixed[block][i, j] == 0 for block, i, j in at], dtype=bool)
        order = np.where(copies.counts > 2, 2, (copies.i[first] + copies.j[first]) % 2)
        nodes = np.argsort(order, kind="stable")
        nodes = nodes[free[nodes]]
        counts = copies.counts[nodes]
        ends = np.cumsum(counts)
        entries = np.arange(counts.sum()) + np.repeat(first[nodes] - (ends - counts), counts)
        self._numbers = [np.concatenate(([0], ends)).astype(np.int64)]
        self._numbers += [part[entries].astype(np.int64) for part in (copies.block, copies.i, copies.j)]
        self._turn = np.ascontiguousarray(copies.turn[:, entries].T, dtype=np.float32)
        self._inverse = np.zeros((len(nodes), 3), dtype=np.float32)
        arrays: list[npt.NDArray[Any]] = [*self._numbers, self._turn, self._inverse]
        pointers = (array.ctypes.data for array in arrays)
        self.shared = _Shared(len(nodes), *pointers)

        self._along = np.zeros((0, 4), dtype=np.float32)
        self._crossing_numbers = np.zeros(len(nodes), np.int64), np.zeros(len(entries), np.int64)
        self._crossing_inverse = np.zeros((len(nodes), 3), np.float32)
        self.crossing = _Crossing()

    def find_crossing(self) -> None:
        """Find the shared nodes where cells are thin across a connection."""
        while True:
            node, line = self._crossing_numbers
            arrays: list[npt.NDArray[Any]] = [node, self._crossing_inverse, line, self._along]
            self.crossing = _Crossing(0, len(self._along), *(array.ctypes.data for array in arrays))
            arguments = self.structures, ctypes.byref(self.shared), ctypes.byref(self.crossing)
            if self.library.find_crossing(*arguments) >= 0:
                return
            self._along = np.zeros((max(4 * len(self._along), 4096), 4), dtype=np.float32)

    def take(self, planes: Sequence[Array], factor: float) -> None:
        """Take the finest operators: planes (19, ni, nj) times a factor."""
        for level, block in zip(self.structures, planes, strict=True):
            self.library.take_planes(ctypes.byref(level), block.ctypes.data, factor)

    def coarsen_from(self, fine: BlockLevel) -> None:
        """Set Galerkin's operators, block by block: interpolation on a side needs the nodes of that side only."""
        for above, level, block in zip(fine.structures, self.structures, fine.blocks, strict=True):
            rows = np.zeros(above.threads * block.operator[0].size, dtype=np.float32)
            self.library.coarsen(ctypes.byref(above), ctypes.byref(level), rows.ctypes.data)

    def factor(self) -> bool:
        """Eliminate along lines, and invert the blocks of shared nodes; return whether all are usable."""
        unusable = sum(self.library.factor(ctypes.byref(level)) for level in self.relaxed)
        sums = np.empty((len(self._inverse), 3))
        self.library.sum_shared(self.structures, ctypes.byref(self.shared), sums.ctypes.data)
        xx, xy, yy = sums.T
        determinant = xx * yy - xy * xy
        if unusable or not ((xx > 0) & (determinant > 1e-7 * xx * yy)).all():
            return False
        self._inverse[:] = (np.stack((yy, -xy, xx)) / determinant).T
        self.find_crossing()
        return True

    def clear(self) -> None:
        """Make the solution zero."""
        self.memory[1][:] = 0.0

    def planes(self) -> list[Array]:
        """Return the operators (19, ni, nj) in double precision."""
        return [
            np.ascontiguousarray(block.operator.transpose(1, 0, 2)[:, :, : mask.shape[1]], dtype=np.float64)
            for block, mask in zip(self.blocks, self.fixed, strict=True)
        ]

    def places(self) -> list[Indices]:
        """Return where x and y of the nodes of each block are in `memory`, (2, ni, nj)."""
        found, end = [], 0
        for block, mask in zip(self.blocks, self.fixed, strict=True):
            (ni, nj), width = mask.shape, block.right[0].size
            begin, end = end + MARGIN[0] * width, end + block.vector_size
            node = begin + width * np.arange(ni)[:, None] + np.arange(nj)
            found.append(np.stack((node, node + width // 2)))
        return found

    def halved(self) -> list[tuple[bool, bool]] | None:
        """Return for each block which directions the next level halves; None if this is the coarsest."""
        nodes = sum(mask.size for mask in self.fixed)
        shapes = [mask.shape for mask in self.fixed]
        possible = halvable_groups(self.bonds, self.groups, shapes, _LEAST, _LEAST)
        if nodes - len(self.copies.block) + len(self.copies.starts) <= _FEWEST_NODES or not possible:
            return None
        along: dict[int, float] = dict.fromkeys(possible, 0.0)
        across = dict(along)
        for block, of_block in zip(self.blocks, self.groups, strict=True):
            sizes = coupling_sizes(block)
            for axis, group in enumerate(of_block):
                if group in possible:
                    along[group] += sizes[axis] * block.fixed.size
                    across[group] += sizes[1 - axis] * block.fixed.size
        strong = {group for group in possible if along[group] > _WEAK * across[group]} or possible
        return [(xi in strong, eta in strong) for xi, eta in self.groups]


def plan_levels(
    library: ctypes.CDLL,
    copies: Copies,
    fixed: Sequence[Mask],
    bonds: Sequence[Bond],
    planes: Sequence[Array],
    factor: float,
) -> list[BlockLevel]:
    """Choose and set up the levels for the Hessians of blocks, times a factor."""
    groups = direction_groups(bonds, len(fixed))
    levels = [BlockLevel(library, copies, fixed, bonds, groups)]
    levels[0].take(planes, factor)
    while (halved := levels[-1].halved()) is not None:
        fine = levels[-1]
        masks = [
            np.ascontiguousarray(mask[:: 1 + rows, :: 1 + columns])
            for mask, (rows, columns) in zip(fine.fixed, halved, strict=True)
        ]
        copies, bonds = fine.copies.coarsened(halved), halved_bonds(fine.bonds, halved)
        levels.append(BlockLevel(library, copies, masks, bonds, groups))
        levels[-1].coarsen_from(fine)
    return levels
