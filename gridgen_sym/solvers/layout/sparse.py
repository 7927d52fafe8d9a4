"""The Hessian of several blocks as one sparse matrix over the different free nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...runtime import HESSIAN_PLANES
from ...topology.copies import Copies, Indices

#: The neighbors whose blocks the Hessian stores, the node itself first: their shifts, and the planes xx, xy, yx, yy.
_COUPLINGS = (
    ((0, 0), (0, 1, 1, 2)),
    ((1, 0), (3, 4, 5, 6)),
    ((0, 1), (7, 8, 9, 10)),
    ((1, 1), (11, 12, 13, 14)),
    ((1, -1), (15, 16, 17, 18)),
)


class LayoutMatrix:
    """Puts the Hessians of blocks together, and takes fields to vectors of unknowns and back.

    Unknown 2 k + c is component c of the k-th node, in the turn of its first copy.

    Attributes:
        size: the number of unknowns.
    """

    def __init__(
        self,
        copies: Copies,
        fixed: Sequence[Mask],
        places: Sequence[Indices] | None = None,
        entries: Sequence[Indices] | None = None,
    ) -> None:
        """Number the unknowns, and find where the entries of the matrix come from.

        Args:
            copies: the nodes with several copies.
            fixed: for each block the mask of nodes without unknowns.
            places: for each block where x and y of its nodes are in the fields' array, (2, ni, nj); by default block
                after block, each as planes.
            entries: for each block where the first plane of its Hessian begins in what is assembled, and the steps to
                the next plane and the next row; by default likewise.
        """
        numbers, count = node_numbers(copies, fixed)
        turns = node_turns(copies, fixed)
        self.size = 2 * count
        self._turned = bool((copies.turn[0] != 1).any())
        self._find_places(numbers, turns, places or _as_planes(fixed))
        self._find_entries(numbers, turns, entries or _planes_after_planes(fixed))

    def _find_places(self, numbers: list[Indices], turns: list[Array], places: Sequence[Indices]) -> None:
        free = [number >= 0 for number in numbers]
        self._node = np.concatenate([number[one] for number, one in zip(numbers, free, strict=True)])
        self._place = np.concatenate([place[:, one] for place, one in zip(places, free, strict=True)], axis=1)
        self._turn = np.concatenate([turn[:, one] for turn, one in zip(turns, free, strict=True)], axis=1)

    def _find_entries(self, numbers: list[Indices], turns: list[Array], entries: Sequence[Indices]) -> None:
        """Find for every coupling of free nodes the nodes, their turns, and where its block is in all planes."""
        parts: list[tuple[Any, ...]] = []
        alike: dict[tuple[int, ...], list[int]] = {}
        for block, number in enumerate(numbers):
            alike.setdefault(number.shape, []).append(block)
        for (ni, nj), blocks in alike.items():  # With many small blocks, calls cost more than arithmetic.
            number, turn = np.stack([numbers[k] for k in blocks]), np.stack([turns[k] for k in blocks], axis=1)
            begin, to_plane, to_row = np.array([entries[k] for k in blocks]).T[:, :, None, None]
            at = begin + to_row * np.arange(ni)[:, None] + np.arange(nj)
            to_plane = np.broadcast_to(to_plane, at.shape)
            for (di, dj), planes in _COUPLINGS:
                here = np.s_[:, : ni - di, max(0, -dj) : nj - max(0, dj)]
                there = np.s_[:, di:, max(0, dj) : nj + min(0, dj)]
                both = (number[here] >= 0) & (number[there] >= 0)
                source = to_plane[here][both] * np.array(planes)[:, None] + at[here][both]
                ends = turn[:, *here][:, both], turn[:, *there][:, both]
                beside = np.full(source.shape[1], bool(di or dj))
                parts.append((source, number[here][both], number[there][both], *ends, beside))
        joined = (np.concatenate(part, axis=-1) for part in zip(*parts, strict=True))
        self._source, first, second, one_turn, other_turn, beside = joined
        self._ends, self._beside = (one_turn, other_turn), beside
        entry = np.arange(4)[:, None]
        rows, columns = 2 * first + entry // 2, 2 * second + entry % 2
        self._find_structure(
            np.concatenate((rows.ravel(), columns[:, beside].ravel())),
            np.concatenate((columns.ravel(), rows[:, beside].ravel())),
        )

    def _find_structure(self, rows: Indices, columns: Indices) -> None:
        """Order the entries by columns and rows, and find those that are one."""
        from scipy import sparse

        keys = columns * self.size + rows
        self._order = np.argsort(keys, kind="stable")
        self._starts = np.flatnonzero(np.diff(keys[self._order], prepend=-1))
        found = self._order[self._starts]
        ends = np.searchsorted(columns[found], np.arange(self.size + 1))
        values = np.zeros(len(found))
        self._matrix = sparse.csc_matrix((values, rows[found], ends), shape=(self.size, self.size))

    def assemble(self, hessians: Sequence[Array] | npt.NDArray[np.floating[Any]]) -> Any:  # noqa: ANN401
        """Return the matrix (CSC) of the stored halves (19, ni, nj) of the blocks' own Hessians, or of one array.

        It is the same matrix with other values at each call.
        """
        joined = hessians if isinstance(hessians, np.ndarray) else np.concatenate([one.ravel() for one in hessians])
        blocks = joined[self._source].astype(np.float64)
        if self._turned:
            blocks = turned_blocks(blocks, *self._ends)
        values = np.concatenate((blocks.ravel(), blocks[:, self._beside].ravel()))[self._order]
        self._matrix.data = np.add.reduceat(values, self._starts) if len(values) else values
        return self._matrix

    def vector(self, field: npt.NDArray[np.floating[Any]]) -> Array:
        """Return the sums over copies of a distributed field, as a vector of unknowns."""
        (x, y), (c, s), count = field[self._place].astype(np.float64), self._turn, self.size // 2
        along = np.bincount(self._node, c * x + s * y, count), np.bincount(self._node, c * y - s * x, count)
        return np.array(along, dtype=np.float64).T.ravel()

    def spread(self, vector: Array, field: npt.NDArray[np.floating[Any]]) -> None:
        """Write a vector of unknowns into a consistent field; fixed nodes are left as they are."""
        (x, y), (c, s) = vector.reshape(-1, 2).T[:, self._node], self._turn
        field[self._place[0]], field[self._place[1]] = c * x - s * y, s * x + c * y


def node_numbers(copies: Copies, fixed: Sequence[Mask]) -> tuple[list[Indices], int]:
    """Number the free nodes of blocks; the copies of a node have one number, fixed nodes -1.

    Returns:
        For each block the numbers (ni, nj); and how many there are.
    """
    offsets = np.cumsum([0, *(mask.size for mask in fixed)])
    widths = np.array([mask.shape[1] for mask in fixed])
    place = offsets[copies.block] + copies.i * widths[copies.block] + copies.j
    free = np.concatenate([mask.ravel() == 0 for mask in fixed])
    numbers = np.full(len(free), -1, dtype=np.intp)
    node, here = copies.node, free[place]
    kept = np.unique(node[here])
    numbers[place[here]] = np.searchsorted(kept, node[here])
    free[place] = False
    numbers[free] = np.arange(len(kept), len(kept) + int(free.sum()))
    parts = [numbers[a:b].reshape(m.shape) for a, b, m in zip(offsets[:-1], offsets[1:], fixed, strict=True)]
    return parts, len(kept) + int(free.sum())


def node_turns(copies: Copies, fixed: Sequence[Mask]) -> list[Array]:
    """Return for each block the cosine and sine of its nodes' turns against their first copies, (2, ni, nj)."""
    turns = [np.stack((np.ones(mask.shape), np.zeros(mask.shape))) for mask in fixed]
    for block, turn in enumerate(turns):
        here = copies.block == block
        turn[:, copies.i[here], copies.j[here]] = copies.turn[:, here]
    return turns


def _as_planes(fixed: Sequence[Mask]) -> list[Indices]:
    """Return where the nodes of blocks are whose planes (2, ni, nj) stand one after the other."""
    begin = np.cumsum([0, *(2 * mask.size for mask in fixed)])
    return [a + np.arange(2 * mask.size).reshape(2, *mask.shape) for a, mask in zip(begin[:-1], fixed, strict=True)]


def _planes_after_planes(fixed: Sequence[Mask]) -> list[Indices]:
    """Return where the planes (19, ni, nj) of blocks begin, and the steps to the next plane and the next row."""
    sizes = np.array([mask.size for mask in fixed])
    begin = HESSIAN_PLANES * (np.cumsum(sizes) - sizes)
    return [np.array((a, mask.size, mask.shape[1])) for a, mask in zip(begin, fixed, strict=True)]


def turned_blocks(blocks: Array, first: Array, second: Array) -> Array:
    """Return R1ᵀ B R2 of blocks (4, n): xx, xy, yx, yy."""
    xx, xy, yx, yy = blocks
    c, s = first
    xx, xy, yx, yy = c * xx + s * yx, c * xy + s * yy, c * yx - s * xx, c * yy - s * xy
    c, s = second
    return np.stack((c * xx + s * xy, c * xy - s * xx, c * yx + s * yy, c * yy - s * yx))
