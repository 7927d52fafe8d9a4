"""Fields on several blocks, one after the other in one array, and sums over the copies of nodes.

A field is *consistent* where all copies of a node have the same vector, each in its own turn; a coordinate, a step, a
corrected position are so. It is *distributed* where the vector of a node is the sum over its copies; what each block
computes from its own cells, a gradient or a product with its own Hessian, is so at first. The inner product of a
distributed field and a consistent one needs no weights.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...topology.copies import Copies


class Exchange:
    """The places of blocks in one array, and of the copies of nodes.

    Attributes:
        shapes: (ni, nj) of the blocks.
        size: of the array: two numbers for each copy of a node.
    """

    __slots__ = ("_again", "_begin", "_copies", "_places", "_turn", "_turns", "shapes", "size")

    def __init__(
        self, copies: Copies, shapes: Sequence[tuple[int, int]], places: npt.NDArray[np.intp] | None = None
    ) -> None:
        """Number the blocks' nodes: block after block, each as planes (2, ni, nj).

        Args:
            copies: the nodes with several copies.
            shapes: (ni, nj) of the blocks.
            places: (2, entries), where x and y of every copy are in fields that are stored otherwise; then only what
                concerns copies can be used.
        """
        self._copies = copies
        self.shapes = tuple(shapes)
        self._begin = np.cumsum([0, *(2 * ni * nj for ni, nj in shapes)])
        self.size = int(self._begin[-1])
        self._places = place_numbers(shapes, copies.block, copies.i, copies.j) if places is None else places
        self._again = np.delete(self._places, copies.starts, axis=1)
        self._turn, self._turns = copies.turn, bool((copies.turn[0] != 1).any())

    @property
    def places(self) -> npt.NDArray[np.intp]:
        """Where x and y of every copy are in a field, (2, entries)."""
        return self._places

    @property
    def turned(self) -> bool:
        """Whether copies of a node are turned to each other."""
        return self._turns

    def views(self, field: Array) -> list[Array]:
        """Return the blocks of a field, (2, ni, nj) each, in its memory."""
        return [
            field[begin:end].reshape(2, *shape)
            for begin, end, shape in zip(self._begin[:-1], self._begin[1:], self.shapes, strict=True)
        ]

    def join(self, blocks: Sequence[Array]) -> Array:
        """Return one array of blocks (2, ni, nj)."""
        return np.concatenate([np.ravel(block) for block in blocks])

    def sums(self, field: Array) -> Array:
        """Return the sums over the copies of every node, (2, nodes), in the turn of the first copy."""
        parts = self._turned(field[self._places], back=True)
        return np.add.reduceat(parts, self._copies.starts, axis=1) if parts.size else parts

    def spread(self, vectors: Array, field: Array) -> None:
        """Give every copy the vector of its node (2, nodes), in place."""
        field[self._places] = self._turned(np.repeat(vectors, self._copies.counts, axis=1), back=False)

    def make_consistent(self, field: Array) -> Array:
        """Sum a distributed field over copies, in place, and return it."""
        self.spread(self.sums(field), field)
        return field

    def of_first_copies(self, field: Array) -> Array:
        """Return a field in which every copy has the vector of the first one."""
        same = field.copy()
        self.copy_first(same)
        return same

    def spread_least(self, field: Array) -> None:
        """Give every copy the least numbers that any copy of its node has, in place."""
        parts = field[self._places]
        if parts.size:
            least = np.minimum.reduceat(parts, self._copies.starts, axis=1)
            field[self._places] = np.repeat(least, self._copies.counts, axis=1)

    def copy_first(self, field: Array) -> None:
        """Give every copy the vector of the first one, in place."""
        self.spread(self.of_nodes(field), field)

    def of_nodes(self, field: Array) -> Array:
        """Return the vectors of the first copies, (2, nodes)."""
        return field[self._places[:, self._copies.starts]]

    def distributed(self, field: Array) -> Array:
        """Return a consistent field as a distributed one: what the first copy has, and zero at the others."""
        parts = field.copy()
        parts[self._again] = 0.0
        return parts

    def inner(self, first: Array, second: Array) -> float:
        """Return the inner product of two consistent fields, in which every node counts once."""
        with np.errstate(over="ignore", invalid="ignore"):
            every = float(np.einsum("n,n->", first, second))
            return every - float(np.einsum("cn,cn->", first[self._again], second[self._again]))

    def _turned(self, vectors: Array, *, back: bool) -> Array:
        if not self._turns:
            return vectors
        c, s = self._turn[0], -self._turn[1] if back else self._turn[1]
        return np.stack((c * vectors[0] - s * vectors[1], s * vectors[0] + c * vectors[1]))


def place_numbers(
    shapes: Sequence[tuple[int, int]], block: npt.NDArray[np.intp], i: npt.NDArray[np.intp], j: npt.NDArray[np.intp]
) -> npt.NDArray[np.intp]:
    """Return where x and y of nodes are in a field on blocks of shapes (ni, nj), as `Exchange` stores it; (2, n)."""
    counts, widths = np.array(shapes).prod(axis=1), np.array(shapes)[:, 1]
    first = np.cumsum([0, *2 * counts])[block] + i * widths[block] + j
    return np.stack((first, first + counts[block]))
