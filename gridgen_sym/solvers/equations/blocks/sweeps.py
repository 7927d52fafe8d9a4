"""Relaxation of the equations on several blocks: the nodes inside each, those on connections, and those left.

Nodes on connections are relaxed in colors: no two of one color are in each other's stencil. A node without a stencil
takes the Newton step of its own energy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....arrays import Array
from ....topology.copies import Copies, Indices
from ....topology.stencils import NODES, Stencils
from ...layout.problem import LayoutProblem
from ...layout.sparse import turned_blocks
from .node_values import NodeValues
from .patches import gather


class LayoutRelaxation:
    """Visits every free node of the equations on several blocks."""

    def __init__(self, problem: LayoutProblem, stencils: Stencils, values: NodeValues, coordinates: Array) -> None:
        """Color the nodes on connections.

        Args:
            problem: kernels on the blocks.
            stencils: of nodes on connections.
            values: what the density is given.
            coordinates: of all blocks, as the start has them.
        """
        self._problem, self._values = problem, values
        colors = _colors(stencils, problem.copies, problem.exchange.shapes)
        self._colors = [
            gather(problem, stencils, np.flatnonzero(colors == color), coordinates)
            for color in range(colors.max(initial=-1) + 1)
        ]
        copies = problem.copies
        here = np.isin(copies.node, stencils.others)
        starts = np.flatnonzero(np.diff(copies.node[here], prepend=-1))
        self._others = Copies(starts, copies.block[here], copies.i[here], copies.j[here], copies.turn[:, here])
        self._rest = problem.exchange.places[:, copies.starts[stencils.others]]

    def sweep(self, coordinates: Array, factor: float) -> None:
        """Visit all nodes once, in place.

        Args:
            coordinates: of all blocks.
            factor: of a step.
        """
        problem = self._problem
        views = problem.exchange.views(coordinates)
        for color in range(4):
            values = self._values.at(coordinates)[1]
            for block, place, given, fixed in zip(problem.blocks, views, values, problem.fixed, strict=True):
                block.kernels.euler_lagrange_relaxation(place, given, fixed, color, factor, block.steps)
        for patches in self._colors:
            planes, moves = self._values.at(coordinates)[0], np.zeros_like(coordinates)
            for patch in patches:
                moves[patch.centers] = patch.relaxation(problem.kernels, coordinates, planes, factor)
            self._move(coordinates, moves)
        if len(self._others.starts):
            moves = np.zeros_like(coordinates)
            moves[self._rest] = self._steps(coordinates)
            self._move(coordinates, moves)

    def _move(self, coordinates: Array, moves: Array) -> None:
        """Add moves of first copies, in place, to all copies."""
        self._problem.exchange.copy_first(moves)
        coordinates += moves

    def _steps(self, coordinates: Array) -> Array:
        """Return Newton's steps of the nodes without a stencil, each alone; none where their energy is not convex."""
        copies, hessians = self._others, self._problem.hessian(coordinates)
        x, y = self._problem.energy_gradient(coordinates)[2][self._rest]
        own = np.array([hessians[b][:3, i, j] for b, i, j in zip(copies.block, copies.i, copies.j, strict=True)]).T
        turned = turned_blocks(own[[0, 1, 1, 2]], copies.turn, copies.turn)
        xx, xy, _, yy = np.add.reduceat(turned, copies.starts, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            determinant = xx * yy - xy * xy
            step = np.stack((xy * y - yy * x, xy * x - xx * y)) / determinant
        return np.where((determinant > 0) & (xx > 0), step, 0.0)


def _colors(stencils: Stencils, copies: Copies, shapes: Sequence[tuple[int, int]]) -> Indices:
    """Return a color for each node that has a stencil."""
    number = [np.full(shape, -1, dtype=np.intp) for shape in shapes]
    order = np.full(len(copies.starts), -1, dtype=np.intp)
    order[stencils.node] = np.arange(len(stencils.node))
    for block, i, j, node in zip(copies.block, copies.i, copies.j, copies.node, strict=True):
        number[block][i, j] = order[node]
    places = (one[0] for one in (stencils.block, stencils.i, stencils.j))
    near = np.array([number[b][i, j] for b, i, j in zip(*(one.ravel() for one in places), strict=True)], dtype=np.intp)
    colors = np.full(len(stencils.node), -1, dtype=np.intp)
    for node, others in enumerate(near.reshape(NODES, -1).T):
        taken = {int(colors[other]) for other in others if other >= 0}
        colors[node] = next(color for color in range(NODES + 1) if color not in taken)
    return colors
