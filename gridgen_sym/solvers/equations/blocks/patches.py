"""Kernels of equations at nodes on connections: their stencils are gathered from the blocks, three columns for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....functionals.metric import INVERSE_TARGET_NAMES
from ....runtime import KernelSet
from ....runtime.kernel_set import JACOBIAN_PLANES
from ....topology.copies import Indices
from ....topology.stencils import CENTER, NODES, Stencils
from ...layout.problem import LayoutProblem
from .target_frames import in_other_block, of_lengths


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Stencils with the same logical steps.

    Attributes:
        chosen: which of the stencils of the layout.
        centers: where x and y of their own nodes are among the coordinates of all blocks; (2, n).
        steps: h_xi and h_eta.
        places: where x and y of the nodes are among the coordinates of all blocks; (2, 9, n).
        nodes: where their values are in planes of all blocks, as nodes of two blocks; (2, 9, n).
        quarters: by how many quarters their blocks' directions are turned; (2, 9, n).
        turn: cosine and sine of the rotations to their places; (2, 2, 9, n).
        shift: what is added after they are rotated back; (2, 9, n).
    """

    chosen: Indices
    centers: Indices
    steps: tuple[float, float]
    places: Indices
    nodes: Indices
    quarters: Indices
    turn: Array
    shift: Array

    @classmethod
    def of(
        cls,
        stencils: Stencils,
        chosen: Indices,
        steps: tuple[float, float],
        places: Sequence[Indices],
        coordinates: Array,
        copies: Indices,
    ) -> Patches:
        """Gather some of the stencils.

        Args:
            stencils: of the layout.
            chosen: which of them.
            steps: of their logical coordinates.
            places: for each block where its coordinates are, (2, ni, nj).
            coordinates: of all blocks, as the start has them.
            copies: where x and y of the copies of nodes are; (2, entries).
        """
        block, i, j = (one[..., chosen] for one in (stencils.block, stencils.i, stencils.j))
        where = np.empty((2, *block.shape), dtype=np.intp)
        nodes = np.empty(block.shape, dtype=np.intp)
        begin = 0
        for number, of_block in enumerate(places):
            here = block == number
            where[:, here] = of_block[:, i[here], j[here]]
            nodes[here] = begin + i[here] * of_block.shape[2] + j[here]
            begin += of_block[0].size
        turn, through = stencils.turn[..., chosen], copies[:, stencils.through[0][:, chosen]]
        centers = where[:, 0, CENTER]
        shift = coordinates[centers][:, None] - _turned_back(coordinates[through], turn[:, 0])
        return cls(chosen, centers, steps, where[:, 0], nodes, stencils.quarters[..., chosen], turn, shift)

    def residual(self, kernels: KernelSet, coordinates: Array, planes: Array | None) -> Array:
        """Return the residual at the nodes, (2, n)."""
        found = kernels.euler_lagrange_residual(self._around(coordinates), self._values(kernels, planes), self.steps)
        return found[:, 1, 1::3]

    def jacobian(self, kernels: KernelSet, coordinates: Array, planes: Array | None) -> Array:
        """Return the derivatives (36, n) of the residual in the nodes of the stencils, in the blocks' own turns."""
        found = kernels.euler_lagrange_jacobian(self._around(coordinates), self._values(kernels, planes), self.steps)
        blocks = found[:, 1, 1::3].reshape(NODES, 2, 2, -1)
        (c, s), (first, second) = self.turn[:, 0, :, None], blocks.transpose(2, 0, 1, 3)
        return np.stack((c * first - s * second, s * first + c * second), axis=2).reshape(JACOBIAN_PLANES, -1)

    def relaxation(self, kernels: KernelSet, coordinates: Array, planes: Array | None, factor: float) -> Array:
        """Return by how much relaxation moves the nodes, (2, n); none may be in another one's stencil."""
        rows, values = self._around(coordinates), self._values(kernels, planes)
        before, fixed = rows[:, 1, 1::3].copy(), np.ones(rows.shape[1:], dtype=np.uint8)
        fixed[1, 1::3] = 0
        for color in (1, 3):  # Of the odd rows.
            kernels.euler_lagrange_relaxation(rows, values, fixed, color, factor, self.steps)
        return rows[:, 1, 1::3] - before

    def _around(self, coordinates: Array) -> Array:
        """Return the stencils' nodes as rows of a block, (2, 3, 3 n)."""
        return _as_rows(_turned_back(coordinates[self.places], self.turn[:, 0]) + self.shift)

    def _values(self, kernels: KernelSet, planes: Array | None) -> Array | None:
        """Return the values that a density is given at these nodes, in the directions of the first copy's block."""
        if planes is None:
            return None
        found = planes[:, self.nodes]
        if INVERSE_TARGET_NAMES[0] in kernels.planes:
            rows = [kernels.planes.index(name) for name in INVERSE_TARGET_NAMES]
            found[rows] = in_other_block(found[rows], self.quarters, self.turn, of_lengths=of_lengths(planes[rows]))
        return _as_rows(found.mean(axis=1))


def gather(problem: LayoutProblem, stencils: Stencils, chosen: Indices, coordinates: Array) -> list[Patches]:
    """Return some of the stencils of a layout, one `Patches` for each pair of logical steps.

    Args:
        problem: on the blocks.
        stencils: of the layout.
        chosen: which of them.
        coordinates: of all blocks, as the start has them.
    """
    exchange, copies = problem.exchange, problem.copies
    own = np.array([block.steps for block in problem.blocks])[copies.block[copies.starts[stencils.node[chosen]]]]
    different, group = np.unique(own, axis=0, return_inverse=True)
    places = [view.astype(np.intp) for view in exchange.views(np.arange(exchange.size, dtype=float))]
    return [
        Patches.of(stencils, chosen[group.ravel() == number], (pair[0], pair[1]), places, coordinates, exchange.places)
        for number, pair in enumerate(different.tolist())
    ]


def _turned_back(points: Array, turn: Array) -> Array:
    c, s = turn
    return np.stack((c * points[0] + s * points[1], c * points[1] - s * points[0]))


def _as_rows(around: Array) -> Array:
    """Return planes (count, 9, n) of stencils as those of a block with three rows, (count, 3, 3 n)."""
    count, _, nodes = around.shape
    return np.ascontiguousarray(around.reshape(count, 3, 3, nodes).transpose(0, 1, 3, 2).reshape(count, 3, 3 * nodes))
