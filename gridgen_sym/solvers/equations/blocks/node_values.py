"""What a density is given at the nodes of several blocks: on connections, means over the corners in all blocks."""

from __future__ import annotations

import numpy as np

from ....arrays import Array
from ....functionals.metric import INVERSE_TARGET_NAMES
from ....runtime import Values
from ....topology.copies import Copies
from ....topology.stencils import Stencils
from ...layout.problem import LayoutProblem
from .target_frames import in_other_block, of_lengths


class NodeValues:
    """The values at nodes, which are evaluated again where those of the blocks are."""

    def __init__(self, problem: LayoutProblem, stencils: Stencils) -> None:
        """Find where the copies of nodes are in planes of all blocks, and how many corners meet at each."""
        self._problem, self._stencils = problem, stencils
        shapes, copies = problem.exchange.shapes, problem.copies
        self._ends = np.cumsum([ni * nj for ni, nj in shapes])
        size = np.array(shapes)[copies.block]
        self._places = (self._ends - _sizes(shapes))[copies.block] + copies.i * size[:, 1] + copies.j
        inside = (copies.i % (size[:, 0] - 1) > 0, copies.j % (size[:, 1] - 1) > 0)
        self._corners = (1.0 + inside[0]) * (1.0 + inside[1])
        self._of: list[Values | None] = []
        self._found: tuple[Array | None, list[Values | None]] = (None, [])

    def at(self, coordinates: Array) -> tuple[Array | None, list[Values | None]]:
        """Return the values as planes of all blocks, (planes, nodes), and for each block.

        None where a density is given nothing.
        """
        views = self._problem.exchange.views(coordinates)
        given = [block.values(place) for block, place in zip(self._problem.blocks, views, strict=True)]
        if len(self._of) != len(given) or any(a is not b for a, b in zip(self._of, given, strict=True)):
            self._of, self._found = given, self._evaluated(given)
        return self._found

    def _evaluated(self, given: list[Values | None]) -> tuple[Array | None, list[Values | None]]:
        known = [values for values in given if values is not None]
        if not known or not known[0].nodes:
            return None, given
        planes = np.concatenate([np.stack(values.nodes).reshape(len(values.nodes), -1) for values in known], axis=1)
        means = ~np.array([values.per_node for values in known]).all(axis=0)
        if means.any():
            planes[np.ix_(means, self._places)] = self._means(planes)[means]
        parts = np.split(planes, self._ends[:-1], axis=1)
        shapes = self._problem.exchange.shapes
        return planes, [Values.of(part.reshape(-1, *shape), shape) for part, shape in zip(parts, shapes, strict=True)]

    def _means(self, planes: Array) -> Array:
        """Return the values of copies (planes, entries) as means over the corners of all copies."""
        copies, names, parts = self._problem.copies, self._problem.kernels.planes, planes[:, self._places]
        rows = [names.index(name) for name in INVERSE_TARGET_NAMES] if INVERSE_TARGET_NAMES[0] in names else []
        if not rows:
            return _mean_over_copies(parts, self._corners, copies)
        quarters, turn, found = self._stencils.copy_quarters, copies.turn, parts.copy()
        lengths = of_lengths(planes[rows])
        found[rows] = in_other_block(parts[rows], quarters, turn, of_lengths=lengths)
        found = _mean_over_copies(found, self._corners, copies)
        back = in_other_block(found[rows], -quarters % 4, turn * [[1.0], [-1.0]], of_lengths=lengths)
        # Where three or five cells meet, directions have no names beyond a block.
        alone = np.isin(copies.node, self._stencils.others)
        back[:, alone] = parts[rows][:, alone]
        found[rows] = back
        return found


def _sizes(shapes: tuple[tuple[int, int], ...]) -> Array:
    """Return how many nodes blocks have."""
    return np.array([ni * nj for ni, nj in shapes])


def _mean_over_copies(parts: Array, weights: Array, copies: Copies) -> Array:
    """Return for every copy the weighted mean over the copies of its node."""
    if not len(copies.starts):
        return parts
    total = np.add.reduceat(parts * weights, copies.starts, axis=1) / np.add.reduceat(weights, copies.starts)
    return np.repeat(total, copies.counts, axis=1)
