"""The vectors of conjugate gradients over several blocks: all blocks in one array, with the margins of their levels."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from ...arrays import Array
from .levels import BlockLevel

_VECTORS = 4


class _Vectors(ctypes.Structure):
    """Vectors, as `block_gradients.c` declares them."""

    _fields_ = tuple(
        (name, ctypes.c_void_p)
        for name in ("x", "r", "p", "q", "sums", "right", "solution", "begin", "row_begin", "field_begin")
    )


class BlockVectors:
    """Solution x, residual r, direction p and its product q; r and q are sums over copies, x and p the same in all."""

    def __init__(self, level: BlockLevel, library: ctypes.CDLL) -> None:
        """Allocate for the finest level."""
        sizes = np.array([2 * mask.size for mask in level.fixed], dtype=np.int64)
        self._numbers, self._sums = (
            np.zeros((_VECTORS, level.memory.size)),
            np.zeros(int(level.memory.blocks[:, 0].sum())),
        )
        self._begin, memory = np.cumsum(sizes) - sizes, level.memory
        arrays: list[Any] = [*self._numbers, self._sums, memory.right, memory.solution, memory.begin, memory.row_begin]
        self._structure = _Vectors(*(array.ctypes.data for array in [*arrays, self._begin]))
        self._arguments = ctypes.byref(level.structure), ctypes.byref(self._structure)
        self._library = library

    def begin(self, right: Array) -> float:
        """Begin with a consistent right-hand side, as `Exchange` stores it; return r.r."""
        return float(self._library.begin_blocks(*self._arguments, right.ctypes.data))

    def step(self, length: float, scale: float) -> float:
        """Set x += length p, r -= length q, and the right-hand side of the next cycle, scale r; return r.r."""
        return float(self._library.step_blocks(*self._arguments, length, scale))

    def product(self) -> float:
        """Return z.r, z being the solution of the last cycle."""
        return float(self._library.product_of_blocks(*self._arguments))

    def multiply(self, beta: float) -> float:
        """Set p = z + beta p, the same in all copies, and q = A p; return p.q."""
        return float(self._library.multiply_blocks(*self._arguments, beta))

    def give(self, field: Array, factor: float, *, direction: bool) -> Array:
        """Write x, or the direction, times a factor as `Exchange` stores it."""
        self._library.give_blocks(*self._arguments, direction, factor, field.ctypes.data)
        return field
