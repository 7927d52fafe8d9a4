"""The local method on several blocks: sweeps over the inner nodes of each, then over shared and sliding nodes.

Shared nodes are those with several copies. They, and nodes that slide, move in colors: nodes of one color have no cell
in common, so that each step is the damped Newton step of the node alone. They are damped together.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...topology.copies import Copies, Indices
from ..local import sweep
from ..norms import shortest_edges
from .exchange import Exchange
from .problem import LayoutProblem
from .sparse import turned_blocks

#: No step is longer than this part of the shortest edge at the node.
_OF_EDGE = 0.4
#: How often a step is halved before it is not taken.
_HALVINGS = 12
#: Rounding of the energy, over the energy.
_ROUNDING = 1e2 * float(np.finfo(float).eps)


class LayoutSweeps:
    """Visits every free node of a problem on several blocks."""

    def __init__(self, problem: LayoutProblem) -> None:
        """Find the shared and sliding nodes that are free, and color them."""
        self._inner = [_with_sides(mask) for mask in problem.fixed]
        copies = problem.copies if problem.slide is None else problem.slide.shared()
        held = problem.held
        entries = zip(copies.block, copies.i, copies.j, strict=True)
        free = np.array([held[block][i, j] == 0 for block, i, j in entries], dtype=bool)
        starts = np.flatnonzero(np.diff(copies.node[free], prepend=-1))
        self._copies = Copies(starts, copies.block[free], copies.i[free], copies.j[free], copies.turn[:, free])
        self._exchange = Exchange(self._copies, problem.exchange.shapes)
        self._colors = _colors(self._copies, held)

    def visit(self, problem: LayoutProblem, coordinates: Array, *, floor: float, reach: float) -> float:
        """Visit all nodes once, in place; see `gridgen_sym.solvers.local.sweep`.

        Returns:
            The largest component of a step, taken or not.
        """
        longest = 0.0
        for block, place, fixed in zip(problem.blocks, problem.exchange.views(coordinates), self._inner, strict=True):
            longest = max(longest, sweep(block, place, fixed, floor=floor, reach=reach))
        for color in range(self._colors.max(initial=-1) + 1):
            longest = max(longest, self._relax(problem, coordinates, self._colors == color, floor))
        return longest

    def _relax(self, problem: LayoutProblem, coordinates: Array, chosen: npt.NDArray[np.bool_], floor: float) -> float:
        """Move the chosen ones of the shared and sliding nodes, in place; return the longest step, taken or not."""
        energy, smallest, gradient = problem.energy_gradient(coordinates)
        step = np.where(chosen, self._steps(problem, coordinates, gradient), 0.0)
        longest, least = float(np.abs(step).max(initial=0.0)), floor if smallest > floor else -np.inf
        # The sum over all cells hides what a step as small as its rounding changes.
        expected = 0.5 * float(np.abs((step * self._exchange.of_nodes(gradient)).sum(axis=0)).sum())
        noise = _ROUNDING * abs(energy) if expected < _ROUNDING * abs(energy) else 0.0
        for _ in range(_HALVINGS if longest > 0 else 0):
            moved = np.zeros_like(coordinates)
            self._exchange.spread(step, moved)
            moved += coordinates
            problem.retract(moved, trial=True)
            lower, there = problem.energy(moved)
            if lower <= energy + noise and there > least:
                coordinates[...] = moved
                problem.follow(coordinates)
                break
            step /= 2
        return longest

    def _steps(self, problem: LayoutProblem, coordinates: Array, gradient: Array) -> Array:
        """Return the Newton steps (2, nodes) of the nodes, each alone, downhill and not longer than edges allow."""
        x, y = self._exchange.of_nodes(gradient)
        xx, xy, yy = self._own_blocks(problem.hessian(coordinates))
        middle, apart = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
        low, high = middle - apart, middle + apart
        with np.errstate(divide="ignore", invalid="ignore"):
            determinant = xx * yy - xy * xy
            newton = np.stack((yy * x - xy * y, xx * y - xy * x)) / -determinant
            descent = np.stack((x, y)) / -np.maximum(np.abs(low), np.abs(high))
        step = np.where(low > 0, newton, descent)
        step = np.where(np.isfinite(step), step, 0.0)
        length = np.hypot(*step)
        return step * np.minimum(1.0, _OF_EDGE * self._edges(problem, coordinates) / np.where(length > 0, length, 1.0))

    def _own_blocks(self, hessians: Sequence[Array]) -> Array:
        """Return the blocks of nodes with themselves, xx, xy and yy, summed over copies in the turn of the first."""
        copies = self._copies
        own = np.empty((3, len(copies.block)))
        for block, planes in enumerate(hessians):
            here = copies.block == block
            own[:, here] = planes[:3, copies.i[here], copies.j[here]]
        xx, xy, yx, yy = turned_blocks(own[[0, 1, 1, 2]], copies.turn, copies.turn)
        summed: Array = np.add.reduceat(np.stack((xx, (xy + yx) / 2, yy)), copies.starts, axis=1)
        return summed

    def _edges(self, problem: LayoutProblem, coordinates: Array) -> Array:
        """Return the length of the shortest edge that meets at each node."""
        lengths = problem.exchange.join(
            [np.stack([shortest_edges(place)] * 2) for place in problem.exchange.views(coordinates)]
        )
        self._exchange.spread_least(lengths)
        return np.asarray(self._exchange.of_nodes(lengths)[0])


def _with_sides(fixed: Mask) -> Mask:
    """Return the mask of a block's nodes with its sides."""
    held = fixed.copy()
    held[[0, -1]], held[:, [0, -1]] = 1, 1
    return held


def _colors(copies: Copies, fixed: Sequence[Mask]) -> Indices:
    """Return for each node a color, so that nodes of one color have no cell in common."""
    near: list[set[int]] = [set() for _ in copies.starts]
    for block, mask in enumerate(fixed):
        here = copies.block == block
        number = np.full(mask.shape, -1, dtype=np.intp)
        number[copies.i[here], copies.j[here]] = copies.node[here]
        corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
        for one, other in combinations(corners, 2):
            both = (one >= 0) & (other >= 0) & (one != other)
            for a, b in zip(one[both].tolist(), other[both].tolist(), strict=True):
                near[a].add(b)
                near[b].add(a)
    colors = np.full(len(near), -1, dtype=np.intp)
    for node, others in enumerate(near):
        taken = {int(colors[other]) for other in others}
        colors[node] = next(color for color in range(len(others) + 1) if color not in taken)
    return colors
