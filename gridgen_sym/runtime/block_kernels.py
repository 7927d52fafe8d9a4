"""The kernels of a functional on several blocks at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..arrays import Array
from .block import Block
from .kernel_set import HESSIAN_PLANES, KernelSet
from .threads import threads_for
from .values import Values


class BlockKernels:
    """Energy, gradient and Hessian of several blocks, whose fields are one array: block after block, each (2, ni, nj).

    Where the back end can, one call runs a kernel on all blocks: with many small ones, calls cost more than arithmetic.
    Blocks are shared among threads, or the rows of each where there are fewer blocks than threads.
    """

    def __init__(
        self, kernels: KernelSet, shapes: Sequence[tuple[int, int]], steps: Sequence[tuple[float, float]]
    ) -> None:
        """Keep the kernels, the shapes (ni, nj) of the blocks and their logical steps."""
        self._kernels, self._shapes, self._steps = kernels, list(shapes), list(steps)
        ni, sizes = (np.array(numbers) for numbers in zip(*((n, n * m) for n, m in self._shapes), strict=True))
        threads = threads_for(int(sizes.sum()))
        self._threads = threads if len(shapes) >= threads else 1
        blocks = [
            Block(n, m, 0, n, m, n * m, 0, 1 if self._threads > 1 else threads_for(n * m), *step)
            for (n, m), step in zip(self._shapes, self._steps, strict=True)
        ]
        self._blocks = (Block * len(blocks))(*blocks)
        self._begin, self._row_begin = np.cumsum(sizes) - sizes, np.cumsum(ni - 1) - (ni - 1)
        self._rows = np.empty((2, int((ni - 1).sum())))

    def smallest_jacobians(self, coordinates: Array) -> Array:
        """Return the smallest Jacobian of the corners of each row of cells, block after block."""
        if self._kernels.planes or not self._on_blocks("energy", coordinates, None, self._row_addresses()):
            places = self._views(coordinates)
            return np.concatenate([self._kernels.smallest_jacobians(place) for place in places])
        return np.array(self._rows[1])

    def energy(self, coordinates: Array, values: Sequence[Values | None] | None) -> tuple[float, float]:
        """Return the energy and the smallest Jacobian; `values` has those of each block, None where there are none."""
        if not self._on_blocks("energy", coordinates, values, self._row_addresses()):
            found = [self._kernels.energy(*given) for given in self._each(coordinates, values)]
            return sum(energy for energy, _ in found), float(np.min([smallest for _, smallest in found]))
        return self._totals()

    def energy_gradient(
        self, coordinates: Array, values: Sequence[Values | None] | None, out: Array
    ) -> tuple[float, float]:
        """Return the energy and the smallest Jacobian, and write each block's gradient, not summed over copies."""
        results = np.concatenate((self._row_addresses(), self._addresses(out)[:, None]), axis=1)
        if not self._on_blocks("energy_gradient", coordinates, values, results):
            parts = zip(self._each(coordinates, values), self._views(out), strict=True)
            found = [self._kernels.energy_gradient(*given, out=part)[:2] for given, part in parts]
            return sum(energy for energy, _ in found), float(np.min([smallest for _, smallest in found]))
        return self._totals()

    def hessian(
        self,
        coordinates: Array,
        values: Sequence[Values | None] | None,
        *,
        semidefinite: bool,
        out: list[Array] | None,
    ) -> list[Array]:
        """Return for each block the stored half of the Hessian (19, ni, nj), written to `out` where that is given."""
        planes = out or [np.empty((HESSIAN_PLANES, *shape)) for shape in self._shapes]
        results = np.array([[_address(one)] for one in planes], dtype=np.uintp)
        if not self._on_blocks("semidefinite_hessian" if semidefinite else "hessian", coordinates, values, results):
            for given, one in zip(self._each(coordinates, values), planes, strict=True):
                self._kernels.hessian(*given, semidefinite=semidefinite, out=one)
        return planes

    def _on_blocks(self, name: str, coordinates: Array, values: Sequence[Values | None] | None, results: Any) -> bool:  # noqa: ANN401
        """Run a kernel on all blocks; return whether the back end can."""
        run = self._kernels.on_blocks(name)
        if run is None:
            return False
        if values is None and not self._kernels.planes:
            addresses = np.zeros(len(self._shapes), dtype=np.uintp)
        else:
            given = [None] * len(self._shapes) if values is None else values
            checked = [self._kernels.checked_values(one, shape) for one, shape in zip(given, self._shapes, strict=True)]
            addresses = np.array([_address(one.pointers) for one in checked], dtype=np.uintp)
        run(self._blocks, self._threads, self._addresses(coordinates), addresses, results)
        return True

    def _addresses(self, field: Array) -> Any:  # noqa: ANN401
        return (_address(field) + 2 * field.itemsize * self._begin).astype(np.uintp)

    def _row_addresses(self) -> Any:  # noqa: ANN401
        first = _address(self._rows) + self._rows.itemsize * self._row_begin
        return np.stack((first, first + self._rows.strides[0]), axis=1).astype(np.uintp)

    def _totals(self) -> tuple[float, float]:
        with np.errstate(over="ignore", invalid="ignore"):
            return float(self._rows[0].sum()), float(self._rows[1].min())

    def _views(self, field: Array) -> list[Array]:
        return [
            field[2 * begin : 2 * (begin + ni * nj)].reshape(2, ni, nj)
            for begin, (ni, nj) in zip(self._begin, self._shapes, strict=True)
        ]

    def _each(
        self, coordinates: Array, values: Sequence[Values | None] | None
    ) -> list[tuple[Array, Values | None, tuple[float, float]]]:
        given = [None] * len(self._shapes) if values is None else values
        return list(zip(self._views(coordinates), given, self._steps, strict=True))


def _address(array: Any) -> int:  # noqa: ANN401
    """Return the address of an array's first number."""
    return int(array.__array_interface__["data"][0])
