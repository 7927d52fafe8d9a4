"""Nodes that slide along the outer boundary of several blocks: derivatives in their curves, and changes with these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..solvers.layout.exchange import Exchange
from ..solvers.layout.slide import LayoutSlide
from ..topology import MultiBlock
from .slides import SideDerivatives


class LineData:
    """The lines of sliding nodes of a layout, each with its curve.

    Attributes:
        sides: for every line the derivatives in its curve.
    """

    def __init__(
        self, slide: LayoutSlide, given: object, start: MultiBlock, exchange: Exchange, gradient: Array
    ) -> None:
        """Take the lines.

        Args:
            slide: at the minimum.
            given: of the user.
            start: whose nodes are those of curves that were not given.
            exchange: of all blocks.
            gradient: at the minimum, in all nodes of all blocks, distributed.
        """
        self._slide, self._exchange = slide, exchange
        curves = {_name(key): curve for key, curve in given.items()} if isinstance(given, Mapping) else {}
        at_nodes, self.sides = self._summed(gradient), []
        for line, side in zip(slide.lines, slide.slide.sides, strict=True):
            if side.curve.closed:
                raise GridgenError(
                    f"the nodes of {line.name} slide along a closed curve, in which there are no derivatives yet: "
                    "hold one of them, as by a sharp turn, or hold the boundary"
                )
            points = np.array([start.blocks[b].planes[:, i, j] for b, i, j in line.places.T.tolist()])
            curve = None if line.own else curves[line.name]
            self.sides.append(SideDerivatives(side, curve, points, at_nodes))

    def _summed(self, field: Array) -> Array:
        """Return the sums over copies of a distributed field at the nodes that slide, (2, nodes of all lines)."""
        slide = self._slide
        found = np.zeros((2, *slide.slide.shape))
        found[:, *slide.slide.nodes] = slide.sums(field)
        return found

    # ---- derivatives ----

    def in_boundary(self, nodes: Array, field: Array) -> list[Array]:
        """Return derivatives in the nodes of the start through which curves go, (ni, nj, 2) for each block.

        Args:
            nodes: the derivatives in the nodes of all blocks, distributed.
            field: the solution of the adjoint system.
        """
        found = [np.zeros((*shape, 2)) for shape in self._exchange.shapes]
        for line, derivative in zip(self._slide.lines, self._derivatives(nodes, field, own=True), strict=True):
            if derivative is not None:
                for (b, i, j), one in zip(line.places.T.tolist(), derivative, strict=True):
                    found[b][i, j] += one
        return found

    def in_slide(self, nodes: Array, field: Array) -> dict[str, Any]:
        """Return derivatives in the curves that were given, by the name of their boundary."""
        names = [line.name for line in self._slide.lines]
        derivatives = self._derivatives(nodes, field, own=False)
        return {name: one for name, one in zip(names, derivatives, strict=True) if one is not None}

    def _derivatives(self, nodes: Array, field: Array, *, own: bool) -> list[Any]:
        at_nodes, there = self._summed(nodes), self._slide.first_copies(field)
        return [side.derivative(at_nodes, there) if side.own is own else None for side in self.sides]

    # ---- changes ----

    def change(self, boundary: Sequence[Array] | None, given: Mapping[str, Any]) -> tuple[Array, Array]:
        """Return how nodes move with their curves, a consistent field; and what their equations change by, distributed.

        Args:
            boundary: of every block, planes (2, ni, nj) of the changes of the nodes of the start.
            given: changes of curves that were given, by the name of their boundary.
        """
        slide = self._slide
        moved, residual = np.zeros((2, *slide.slide.shape)), np.zeros((2, *slide.slide.shape))
        known = {line.name for line, side in zip(slide.lines, self.sides, strict=True) if not side.own}
        for name in given:
            if name not in known:
                raise GridgenError(f"no curve was given of a sliding boundary {quoted(name)}")
        for line, side in zip(slide.lines, self.sides, strict=True):
            change = given.get(line.name)
            if side.own and boundary is not None:
                change = np.array([boundary[b][:, i, j] for b, i, j in line.places.T.tolist()])
            if change is not None:
                nodes, rest = side.change(change)
                moved[:, *side.side.index] += nodes
                residual[:, *side.side.index] += rest
        fields = []
        for vectors in (moved, residual):
            field = np.zeros(self._exchange.size)
            slide.spread(vectors[:, *slide.slide.nodes], field)
            fields.append(field)
        return fields[0], slide.distributed(fields[1])


def _name(key: Any) -> str:  # noqa: ANN401
    """Return what a line along a boundary, or along a side of a block, is called."""
    return key if isinstance(key, str) else f"{key[1]} of block {key[0]}"
