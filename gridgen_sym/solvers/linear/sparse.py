"""From planes of stencil blocks to sparse matrices over the free nodes.

The unknowns are numbered node by node, in the order of the array (eta runs fastest), x before y: component c of
the k-th free node is unknown 2 k + c.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask

#: Neighbors whose blocks the Hessian stores, and the first of their planes.
_HESSIAN_NEIGHBORS = (((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))


def number_free_nodes(fixed: Mask) -> npt.NDArray[np.int64]:
    """Return the number of every free node, and -1 at fixed ones; (ni, nj)."""
    numbers = np.full(fixed.shape, -1, dtype=np.int64)
    free = fixed == 0
    numbers[free] = np.arange(int(free.sum()))
    return numbers


def assemble_hessian(planes: Array, fixed: Mask) -> Any:  # noqa: ANN401 - scipy.sparse has no types
    """Return the symmetric Hessian over the free nodes (CSC) from its stored half (19, ni, nj)."""
    numbers = number_free_nodes(fixed)
    entries = _Entries(numbers)
    for plane, row, column in ((0, 0, 0), (1, 0, 1), (1, 1, 0), (2, 1, 1)):
        entries.add(planes[plane], (0, 0), row, column)
    for (di, dj), first in _HESSIAN_NEIGHBORS:
        for entry in range(4):
            row, column = divmod(entry, 2)
            entries.add(planes[first + entry], (di, dj), row, column, symmetric=True)
    return entries.matrix()


def assemble_jacobian(planes: Array, fixed: Mask) -> Any:  # noqa: ANN401
    """Return the Jacobian of the Euler-Lagrange residual over the free nodes (CSC) from its planes (36, ni, nj)."""
    entries = _Entries(number_free_nodes(fixed))
    for neighbor in range(9):
        di, dj = divmod(neighbor, 3)
        for entry in range(4):
            row, column = divmod(entry, 2)
            entries.add(planes[4 * neighbor + entry], (di - 1, dj - 1), row, column)
    return entries.matrix()


class _Entries:
    """Collects (row, column, value) of couplings between a node and a shifted neighbor, both free."""

    def __init__(self, numbers: npt.NDArray[np.int64]) -> None:
        self._numbers = numbers
        self._parts: list[tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Array]] = []

    def add(self, plane: Array, shift: tuple[int, int], row: int, column: int, *, symmetric: bool = False) -> None:
        """Add the plane's values as entries (row of the node, column of the node shifted by `shift`)."""
        ni, nj = plane.shape
        di, dj = shift
        here = slice(max(0, -di), ni - max(0, di)), slice(max(0, -dj), nj - max(0, dj))
        there = slice(max(0, di), ni + min(0, di)), slice(max(0, dj), nj + min(0, dj))
        first, second = self._numbers[here], self._numbers[there]
        both = (first >= 0) & (second >= 0)
        rows, columns, values = 2 * first[both] + row, 2 * second[both] + column, plane[here][both]
        self._parts.append((rows, columns, values))
        if symmetric:
            self._parts.append((columns, rows, values))

    def matrix(self) -> Any:  # noqa: ANN401
        """Return everything as one CSC matrix."""
        from scipy import sparse

        size = 2 * int(self._numbers.max() + 1)
        rows, columns, values = (np.concatenate(parts) for parts in zip(*self._parts, strict=True))
        return sparse.csc_matrix((values, (rows, columns)), shape=(size, size))


def to_vector(field: Array, fixed: Mask) -> Array:
    """Return the components of a field (2, ni, nj) at the free nodes as a vector of unknowns."""
    return np.ascontiguousarray(field[:, fixed == 0].T).ravel()


def to_field(vector: Array, fixed: Mask) -> Array:
    """Return a vector of unknowns as a field (2, ni, nj), zero at the fixed nodes."""
    field = np.zeros((2, *fixed.shape))
    field[:, fixed == 0] = vector.reshape(-1, 2).T
    return field
