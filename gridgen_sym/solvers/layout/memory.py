"""The memory of one level of several blocks: one array for all blocks of each kind of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Mask
from ...runtime import HESSIAN_PLANES
from ...topology.copies import Indices
from ...topology.lines import Coarsening
from ..linear.multigrid.hierarchy import MARGIN, stride_of
from ..linear.multigrid.library import Level

#: Numbers of a node in an operator, in the inverse pivots of lines along one direction, and in a vector.
_OPERATOR, _PIVOT, _VECTOR = HESSIAN_PLANES, 3, 2
_FIELDS = [name for name, _ in Level._fields_]  # type: ignore[misc]


class BlockMemory:
    """Operators, pivots and vectors, with margins: see `MARGIN`.

    Attributes:
        blocks, relaxed: the blocks as compiled code sees them, (blocks, fields of `Level`): with all rows, and with the
            inner ones only, whose lines are relaxed.
        right, solution: vectors of all blocks.
        size: of a vector.
        operator: the operators of all blocks.
        strides: the numbers from row to row of each block.
        begin: where the first node of each block is in a vector.
        begin_of_operators: and its first number in `operator`.
        row_begin: the number of its first row among those of all blocks.
    """

    def __init__(self, fixed: Sequence[Mask], coarsening: Coarsening | None, dtype: type[np.floating[Any]]) -> None:
        """Allocate for the nodes of masks, to which `coarsening` has led from a finer level; `dtype` of all numbers."""
        ni, nj = np.array([mask.shape for mask in fixed], dtype=np.int64).T
        self.strides = np.array([stride_of(int(count) + 1) for count in nj], dtype=np.int64)
        ends = np.cumsum((ni + sum(MARGIN)) * self.strides)
        nodes = ends - (ni + MARGIN[1]) * self.strides
        self.size = _VECTOR * int(ends[-1])
        self.begin, self.begin_of_operators = _VECTOR * nodes, _OPERATOR * nodes
        self.row_begin = np.concatenate(([0], np.cumsum(ni)[:-1])).astype(np.int64)
        # One row more: what is multiplied by the margin's zeros is read from there.
        self.operator, pivots_i, pivots_j, self.right, self.solution, work = (
            np.zeros(count * int(ends[-1] + self.strides[-1]), dtype=dtype)
            for count in (_OPERATOR, _PIVOT, _PIVOT, _VECTOR, _VECTOR, _VECTOR)
        )
        masks, begin_of_masks = _padded(fixed)
        self._alive: list[npt.NDArray[Any]] = [pivots_i, pivots_j, work, masks]
        self.blocks = np.zeros((len(fixed), len(_FIELDS)), dtype=np.int64)
        self._set(ni=ni, nj=nj, stride=self.strides, threads=np.ones_like(ni), fixed=masks.ctypes.data + begin_of_masks)
        for name, array, count in (
            ("operator", self.operator, _OPERATOR),
            ("pivots_i", pivots_i, _PIVOT),
            ("pivots_j", pivots_j, _PIVOT),
            ("right", self.right, _VECTOR),
            ("solution", self.solution, _VECTOR),
            ("work", work, _VECTOR),
        ):
            self._set(**{name: array.ctypes.data + array.itemsize * count * nodes})
        if coarsening is not None:
            lines, begin_of_lines = _irregular(coarsening)
            self._alive.append(lines)
            addresses = np.where(begin_of_lines < 0, 0, lines.ctypes.data + lines.itemsize * begin_of_lines)
            self._set(kept_i=addresses[::2], kept_j=addresses[1::2])
        self.relaxed = self.blocks.copy()
        for name, value in (("begin_i", 1), ("end_i", ni - 1), ("begin_j", 1), ("end_j", nj - 1)):
            self.relaxed[:, _FIELDS.index(name)] = value

    def _set(self, **values: Any) -> None:  # noqa: ANN401
        for name, value in values.items():
            self.blocks[:, _FIELDS.index(name)] = value

    def places(self) -> list[Indices]:
        """Return where x and y of the nodes of each block are in a vector, (2, ni, nj)."""
        found = []
        for begin, stride, block in zip(self.begin, self.strides, self.blocks, strict=True):
            node = begin + 2 * stride * np.arange(block[0])[:, None] + np.arange(block[1])
            found.append(np.stack((node, node + stride)))
        return found

    def entries(self) -> list[Indices]:
        """Return for each block where entry 0 of node (0, 0) is in `operator`, and the steps to the next entry, row."""
        return [
            np.array((begin, stride, _OPERATOR * stride))
            for begin, stride in zip(self.begin_of_operators, self.strides, strict=True)
        ]


def _padded(fixed: Sequence[Mask]) -> tuple[Mask, Indices]:
    """Return masks with a margin of fixed nodes one after the other, and where the first node of each is."""
    sizes = [(ni + 2) * (nj + 2) for ni, nj in (mask.shape for mask in fixed)]
    begin = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    joined = np.ones(int(begin[-1]), dtype=np.uint8)
    for first, end, mask in zip(begin[:-1], begin[1:], fixed, strict=True):
        ni, nj = mask.shape
        joined[first:end].reshape(ni + 2, nj + 2)[1:-1, 1:-1] = mask
    return joined, begin[:-1] + np.array([mask.shape[1] + 3 for mask in fixed])


def _irregular(coarsening: Coarsening) -> tuple[npt.NDArray[np.int64], Indices]:
    """Return the lines that are kept, direction after direction, and where those of each begin.

    That is -1 where they are all, or every second one and the last: compiled code knows these.
    """
    before, after = np.diff(coarsening.begin), np.add.reduceat(coarsening.stays.astype(np.intp), coarsening.begin[:-1])
    kept = np.flatnonzero(coarsening.stays)
    lines, rank = kept - np.repeat(coarsening.begin[:-1], after), coarsening.rank[kept]
    count, fine = np.repeat(after, after), np.repeat(before, after)
    regular = np.where(count == fine, rank, np.where(rank < count - 1, 2 * rank, fine - 1))
    begin = np.concatenate(([0], np.cumsum(after)[:-1]))
    return lines.astype(np.int64), np.where(np.logical_or.reduceat(lines != regular, begin), begin, -1)
