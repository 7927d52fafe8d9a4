"""The levels of several blocks: operators of each block's own cells, and the nodes that blocks share."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...runtime import HESSIAN_PLANES, threads_for
from ...topology.copies import Bond, Copies
from ...topology.lines import Coarsening, Lines, lines_of
from .memory import BlockMemory

#: Every block keeps at least one cell along each direction; with fewer different nodes a level is not coarsened.
_LEAST, _FEWEST_NODES = 1, 100
#: A direction whose couplings are weaker than this part of the other's is not halved.
_WEAK = 0.25
#: Numbers of a node's stencil: a 2x2 block with itself and with each of its eight neighbors.
_STENCIL = 36
#: Of a large block so many rows are a sample of all.
_ROWS = 64


class _Shared(ctypes.Structure):
    """Nodes with several copies, as `blocks.c` declares them."""

    _fields_ = (
        ("count", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("starts", "block", "i", "j", "turn", "inverse", "stencil")),
    )


class _Crossing(ctypes.Structure):
    """Shared nodes that move with the lines across a connection, as `crossing_lines.c` declares them."""

    _fields_ = (
        ("count", ctypes.c_int64),
        ("most", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("node", "inverse", "line", "along", "blocks")),
        ("weakest", ctypes.c_double),
    )


class LevelStructure(ctypes.Structure):
    """One level of all blocks, as `block_levels.c` declares it."""

    _fields_ = (
        *((name, ctypes.c_int64) for name in ("blocks", "threads", "size")),
        *((name, ctypes.c_void_p) for name in ("levels", "relaxed", "shared", "crossing", "solution")),
    )


class BlockLevel:
    """One level of all blocks.

    Attributes:
        copies, fixed, lines: of the layout on this level.
        memory: what compiled code works in.
        structure: the level as compiled code sees it.
        threads: that work on it.
    """

    def __init__(
        self,
        library: ctypes.CDLL,
        copies: Copies,
        fixed: Sequence[Mask],
        lines: Lines,
        coarsening: Coarsening | None = None,
        dtype: type[np.floating[Any]] = np.float32,
    ) -> None:
        """Allocate; `coarsening` has led here from the finer level, `dtype` is that of the library's numbers."""
        self._dtype = dtype
        self.copies, self.fixed, self.lines, self._library = copies, list(fixed), lines, library
        self.memory = BlockMemory(fixed, coarsening, dtype)
        self.threads = threads_for(sum(mask.size for mask in fixed))
        self._share()
        blocks, relaxed, solution = self.memory.blocks, self.memory.relaxed, self.memory.solution
        shared, crossing = ctypes.addressof(self._shared), ctypes.addressof(self.crossing)
        pointers = blocks.ctypes.data, relaxed.ctypes.data, shared, crossing, solution.ctypes.data
        self.structure = LevelStructure(len(fixed), self.threads, self.memory.size, *pointers)
        self._reference = ctypes.byref(self.structure)
        library.find_rows(self._reference)
        width = HESSIAN_PLANES * int(self.memory.strides.max())
        self._rows = np.zeros((self.threads, width), dtype=self._dtype)

    def _share(self) -> None:
        """Order the free shared nodes: those with two copies first, every second one, and last those with more."""
        copies, first = self.copies, self.copies.starts
        free = ~np.isin(copies.node, copies.node[self._is_fixed(copies)])[first]
        order = np.where(copies.counts > 2, 2, (copies.i[first] + copies.j[first]) % 2)
        nodes = np.argsort(order, kind="stable")
        nodes = nodes[free[nodes]]
        counts = copies.counts[nodes]
        ends = np.cumsum(counts)
        entries = np.arange(counts.sum()) + np.repeat(first[nodes] - (ends - counts), counts)
        numbers = [np.concatenate(([0], ends)).astype(np.int64)]
        numbers += [part[entries].astype(np.int64) for part in (copies.block, copies.i, copies.j)]
        turn = np.ascontiguousarray(copies.turn[:, entries].T)
        inverse = np.zeros((len(nodes), 3), dtype=self._dtype)
        stencil = np.zeros((len(entries), _STENCIL), dtype=self._dtype)
        arrays: list[npt.NDArray[Any]] = [*numbers, turn, inverse, stencil]
        self._shared = _Shared(len(nodes), *(array.ctypes.data for array in arrays))
        node, line = np.zeros(len(nodes), dtype=np.int64), np.zeros(len(entries), dtype=np.int64)
        self._along, of_lines = np.zeros((0, 4), dtype=self._dtype), np.zeros_like(inverse)
        crossing: list[npt.NDArray[Any]] = [
            node,
            of_lines,
            line,
            self._along,
            np.zeros(len(self.fixed), dtype=np.uint8),
        ]
        self.crossing = _Crossing(0, 0, *(array.ctypes.data for array in crossing))
        self._alive = [*arrays, *crossing]

    def _is_fixed(self, copies: Copies) -> npt.NDArray[np.bool_]:
        """Return which entries are fixed nodes."""
        sizes, widths = np.array([(mask.size, mask.shape[1]) for mask in self.fixed], dtype=np.intp).T
        begin = np.cumsum(sizes) - sizes
        every = np.concatenate([mask.ravel() for mask in self.fixed])
        return np.asarray(every[begin[copies.block] + copies.i * widths[copies.block] + copies.j] != 0)

    def take(self, planes: Sequence[Array], factor: float) -> None:
        """Take the finest operators: planes (19, ni, nj) times a factor."""
        addresses = np.array([block.__array_interface__["data"][0] for block in planes], dtype=np.uintp)
        self._library.take_blocks(self._reference, addresses.ctypes.data, factor)

    def coarsen_from(self, fine: BlockLevel) -> None:
        """Set Galerkin's operators, block by block: interpolation on a side needs the nodes of that side only."""
        self._library.coarsen_blocks(fine._reference, self._reference, fine._rows.ctypes.data, fine._rows.shape[1])

    def factor(self) -> bool:
        """Eliminate along lines, and invert the blocks of shared nodes; return whether all are usable."""
        while (unusable := self._library.factor_blocks(self._reference)) < 0:
            self._along = np.zeros((max(4 * len(self._along), 4096), 4), dtype=self._dtype)
            self.crossing.most, self.crossing.along = len(self._along), self._along.ctypes.data
        return bool(unusable == 0)

    @property
    def node_count(self) -> int:
        """The number of different nodes."""
        return sum(mask.size for mask in self.fixed) - len(self.copies.block) + len(self.copies.starts)

    def coarsening(self) -> Coarsening | None:
        """Return what leads to the next level; None if this is the coarsest."""
        possible = self.lines.groups(_LEAST, _LEAST)
        if self.node_count <= _FEWEST_NODES or not possible:
            return None
        sizes = np.empty((len(self.fixed), 2))
        self._library.coupling_sizes(self._reference, _ROWS, sizes.ctypes.data)
        sizes *= np.array([mask.size for mask in self.fixed])[:, None]
        groups = self.lines.group[self.lines.begin[:-1]].reshape(-1, 2)
        along = np.bincount(groups.ravel(), sizes.ravel())
        across = np.bincount(groups.ravel(), sizes[:, ::-1].ravel())
        strong = {group for group in possible if along[group] > _WEAK * across[group]}
        return self.lines.coarsening(strong or possible, _LEAST)


def plan_levels(
    library: ctypes.CDLL,
    copies: Copies,
    fixed: Sequence[Mask],
    bonds: Sequence[Bond],
    planes: Sequence[Array],
    factor: float,
    dtype: type[np.floating[Any]],
) -> list[BlockLevel]:
    """Choose and set up the levels for the Hessians of blocks, times a factor."""
    lines = lines_of(tuple(bonds), tuple(mask.shape for mask in fixed))
    levels = [BlockLevel(library, copies, fixed, lines, dtype=dtype)]
    levels[0].take(planes, factor)
    while (coarsening := levels[-1].coarsening()) is not None:
        fine = levels[-1]
        kept = zip(fine.fixed, coarsening.kept, strict=True)
        masks = [np.ascontiguousarray(mask[rows][:, columns]) for mask, (rows, columns) in kept]
        lines, copies = fine.lines.coarsened(coarsening), coarsening.copies(fine.copies)
        levels.append(BlockLevel(library, copies, masks, lines, coarsening, dtype))
        levels[-1].coarsen_from(fine)
    return levels
