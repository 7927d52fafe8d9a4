"""Nodes that slide along the outer boundary of several blocks: one line of nodes may pass through many of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...boundary.slide_curve import SlideCurve
from ...topology.connection import SidePart
from ...topology.copies import Copies, Indices
from ...topology.lines import Coarsening
from ...topology.merging import Merged
from ...topology.outer_lines import Edge
from ..sliding.hessian import Couplings
from ..sliding.side import SlidingSide
from ..sliding.slide import Slide
from ..sliding.springs import NEXT, add_couplings, add_spring_gradient, spring_energy
from .exchange import Exchange, place_numbers


@dataclass(frozen=True, slots=True, eq=False)
class SlidingLine:
    """Nodes of the outer boundary that follow each other along a curve.

    Attributes:
        name: for messages.
        places: (3, n), block, i and j of each; of a closed line the first one is the last, too.
        curve: in the direction of the nodes.
        at: (n,), their parameters, increasing.
        own: whether the curve is that of the nodes themselves.
        edges: that join the nodes, which springs of the curve need.
    """

    name: str
    places: Indices
    curve: SlideCurve
    at: Array
    own: bool = False
    edges: tuple[Edge, ...] = ()


class LayoutSlide:
    """The sliding nodes of several blocks.

    Attributes:
        lines: as they were given.
        slide: their nodes as those of no grid, line after line: a closed line has its first node once.
        copies: all copies of the nodes that slide; they are at one place.
    """

    def __init__(self, lines: Sequence[SlidingLine], copies: Copies, shapes: Sequence[tuple[int, int]]) -> None:
        """Take lines of a layout with these copies and shapes (ni, nj) of blocks."""
        self.lines, self._all, self.shapes = tuple(lines), copies, tuple(shapes)
        sides, begin = [], 0
        for line in self.lines:
            count = len(line.at) - line.curve.closed
            numbers = begin + np.arange(len(line.at), dtype=np.intp) % count
            sides.append(SlidingSide(line.name, (numbers,), line.curve, line.at))
            begin += count
        self.slide = Slide(sides, (begin,))
        none = np.empty((3, 0), dtype=np.intp)
        places = np.concatenate(
            [none, *(line.places[:, : len(line.at) - line.curve.closed] for line in self.lines)], axis=1
        )
        self._places = place_numbers(self.shapes, *places)
        self.copies = _copies_of(places[:, self.slide.nodes[0]], copies, self.shapes)
        self._exchange = Exchange(self.copies, self.shapes)
        self._couplings: list[tuple[Couplings, Indices, npt.NDArray[np.bool_]]] | None = None

    def masks(self, fixed: Sequence[Mask]) -> list[Mask]:
        """Return for each block the mask of nodes without any unknown: the fixed ones that do not slide."""
        free = [mask.copy() for mask in fixed]
        for block, i, j in zip(self.copies.block, self.copies.i, self.copies.j, strict=True):
            free[block][i, j] = 0
        return free

    def shared(self) -> Copies:
        """Return the nodes with several copies, and those that slide and have one: solvers relax these one by one."""
        alone = self.copies.starts[self.copies.counts == 1]
        every, own, begin = self._all, self.copies, len(self._all.block)
        return Copies(
            starts=np.concatenate((every.starts, begin + np.arange(len(alone), dtype=np.intp))),
            block=np.concatenate((every.block, own.block[alone])),
            i=np.concatenate((every.i, own.i[alone])),
            j=np.concatenate((every.j, own.j[alone])),
            turn=np.concatenate((every.turn, own.turn[:, alone]), axis=1),
        )

    def follow(self, coordinates: Array) -> None:
        """Take the sliding nodes from where they are in coordinates of all blocks, on their curves."""
        self.slide.follow(coordinates[self._places])

    def retract(self, coordinates: Array, *, trial: bool = False) -> None:
        """Put the sliding nodes of coordinates back on their curves, in place; see `Slide.retract`."""
        places = coordinates[self._places]
        self.slide.retract(places, trial=trial)
        self._exchange.spread(places[:, *self.slide.nodes], coordinates)

    def spring_energy(self, coordinates: Array) -> float:
        """Return the energy of the springs along the lines; zero without any."""
        return spring_energy(self.slide, coordinates[self._places])

    def tangential(self, gradient: Array, coordinates: Array) -> Array:
        """Return the tangential part (2, nodes) of a consistent gradient at the sliding nodes, with that of springs."""
        there = gradient[self._places]
        add_spring_gradient(self.slide, coordinates[self._places], there)
        return self.slide.tangential(there)

    def spread(self, vectors: Array, field: Array) -> None:
        """Give all copies of the sliding nodes their vectors (2, number of nodes), in place."""
        self._exchange.spread(vectors, field)

    def constrain(self, hessians: Sequence[Array], coordinates: Array, gradient: Array, *, semidefinite: bool) -> None:
        """Make the Hessians (19, ni, nj) of all blocks those of the tangential unknowns, in place, with springs.

        Args:
            hessians: each of a block's own cells.
            coordinates: of all blocks.
            gradient: distributed, not projected; that at the sliding nodes counts.
            semidefinite: see `Slide.constrain`.
        """
        summed = np.zeros((2, *self.slide.shape))
        summed[:, *self.slide.nodes] = self._exchange.sums(gradient)
        add_spring_gradient(self.slide, coordinates[self._places], summed)
        self._add_springs(hessians)
        curvature = self.slide.curvature(summed, semidefinite=semidefinite)
        if self._couplings is None:
            self._couplings = self._find_couplings()
        for planes, (couplings, nodes, first) in zip(hessians, self._couplings, strict=True):
            couplings.constrain(planes, self.slide.tangents[:, nodes], np.where(first, curvature[nodes], 0.0))

    def curvature(self, gradient: Array) -> Array:
        """Return what bends of curves add, given a distributed gradient, without springs; see `Slide.curvature`."""
        summed = np.zeros((2, *self.slide.shape))
        summed[:, *self.slide.nodes] = self.sums(gradient)
        return self.slide.curvature(summed, semidefinite=False)

    def sums(self, field: Array) -> Array:
        """Return the sums over copies of a distributed field at the sliding nodes, (2, number of nodes)."""
        return self._exchange.sums(field)

    def first_copies(self, field: Array) -> Array:
        """Return a consistent field at the nodes of all lines, (2, number of these)."""
        return np.asarray(field[self._places])

    def distributed(self, field: Array) -> Array:
        """Return a field that is consistent at the sliding nodes as a distributed one."""
        return self._exchange.distributed(field)

    def _add_springs(self, hessians: Sequence[Array]) -> None:
        """Add the Hessians of the springs, each to the block that its edge is on."""
        for line, side in zip(self.lines, self.slide.sides, strict=True):
            weights = side.springs
            if weights is None:
                continue
            for (block, name, k), weight in zip(line.edges, weights.tolist(), strict=True):
                part = SidePart(block, name, k, k + 1)
                i, j = part.indices(self.shapes[block])
                low, high = (i[0], j[0]), (i[1], j[1])
                add_couplings(hessians[block], low, high, weight, NEXT[part.axis == 0])

    def _find_couplings(self) -> list[tuple[Couplings, Indices, npt.NDArray[np.bool_]]]:
        """Return for each block its couplings, the numbers of its sliding nodes, and which are their first copies."""
        found, first = [], np.zeros(len(self.copies.block), dtype=bool)
        first[self.copies.starts] = True
        for block, shape in enumerate(self.shapes):
            here = self.copies.block == block
            couplings = Couplings((self.copies.i[here], self.copies.j[here]), shape)
            found.append((couplings, self.copies.node[here], first[here]))
        return found

    def caution(self, coordinates: Array) -> str:
        """Return a remark on edges that cut off bends of their curves; see `Slide.caution`."""
        return self.slide.caution(coordinates[self._places])

    def coarsened(self, coarsening: Coarsening) -> LayoutSlide:
        """Return the sliding nodes of a coarser layout, those on the lines that it keeps."""
        lines = []
        for line, side in zip(self.lines, self.slide.sides, strict=True):
            block, i, j = (
                line.places[0],
                *(coarsening.begin[2 * line.places[0] + k] + line.places[1 + k] for k in (0, 1)),
            )
            kept = coarsening.stays[i] & coarsening.stays[j]
            kept[-1] &= not side.curve.closed
            places, at = np.stack((block, coarsening.rank[i], coarsening.rank[j]))[:, kept], side.at[kept]
            if side.curve.closed:
                places, at = np.concatenate((places, places[:, :1]), axis=1), np.append(at, at[:1] + 1.0)
            if len(at) > 2:
                lines.append(replace(line, places=places, at=at))
        shapes = [(len(rows), len(columns)) for rows, columns in coarsening.kept]
        return LayoutSlide(lines, coarsening.copies(self._all), shapes)

    def merged(self, merged: Merged) -> LayoutSlide:
        """Return the same nodes in merged blocks."""
        lines = [replace(line, places=merged.moved(line.places)) for line in self.lines]
        return LayoutSlide(lines, merged.layout.copies, [grid.shape for grid in merged.layout.blocks])


def _copies_of(places: Indices, copies: Copies, shapes: Sequence[tuple[int, int]]) -> Copies:
    """Return all copies of nodes at places (3, n), in their order; such with one copy have that."""
    count = len(copies.block)
    offsets = np.cumsum([0, *(ni * nj for ni, nj in shapes)])
    widths = np.array([nj for _, nj in shapes])

    def flat(block: Indices, i: Indices, j: Indices) -> Indices:
        return np.asarray(offsets[block] + i * widths[block] + j)

    node = np.full(offsets[-1], -1, dtype=np.intp)
    node[flat(copies.block, copies.i, copies.j)] = copies.node
    own = node[flat(*places)]
    several = own >= 0
    counts, first = np.ones(len(own), dtype=np.intp), count + np.arange(len(own), dtype=np.intp)
    counts[several], first[several] = copies.counts[own[several]], copies.starts[own[several]]
    starts = np.cumsum(counts) - counts
    entries = np.repeat(first - starts, counts) + np.arange(counts.sum(), dtype=np.intp)
    block, i, j = (
        np.concatenate(pair)[entries] for pair in zip((copies.block, copies.i, copies.j), places, strict=True)
    )
    turn = np.stack((np.ones(len(block)), np.zeros(len(block))))
    return Copies(starts, block, i, j, turn)
