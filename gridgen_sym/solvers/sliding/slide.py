"""The boundary nodes that slide: where they are on their curves, and what of a gradient they feel.

A node on a curve c(t) has one unknown. Systems keep two components per node: what is normal to the curve is taken out
of the gradient, and in the Hessian it is a diagonal entry of its own (see `hessian.py`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from .hessian import Couplings, along_curves
from .joined_cubics import JoinedCubics
from .prolongation import finer_parameters
from .side import ALONG_XI, Index, Place, SlidingSide, side_index

#: An edge cuts off a bend where its middle is this part of its length away from the curve, as of an arc of 87 degrees.
_CUT = 0.2


class Slide:
    """The sliding nodes of a grid.

    Attributes:
        sides: that slide.
        shape: (ni, nj) of the grid; or (n,), of nodes that are in no grid.
        nodes: the indices of all sliding nodes.
        points: (2, number of nodes), where they are.
        tangents: likewise, of length 1.
    """

    __slots__ = (
        "_bends",
        "_couplings",
        "_cubics",
        "_slopes",
        "_tried",
        "nodes",
        "points",
        "shape",
        "sides",
        "tangents",
    )

    def __init__(self, sides: list[SlidingSide], shape: tuple[int, ...]) -> None:
        """Take the sides of a grid."""
        self.sides, self.shape = sides, shape
        parts, none = [side.nodes for side in sides], np.empty(0, dtype=np.intp)
        self.nodes: Index = tuple(np.concatenate([none, *(part[axis] for part in parts)]) for axis in range(len(shape)))
        self._couplings: Couplings | None = None
        self._cubics = JoinedCubics.of(sides)
        # The last trial: where it left the nodes, and their places on the curves.
        self._tried: tuple[Array | None, list[Place]] = None, []
        self._set_tangents()

    def mask(self, fixed: Mask) -> Mask:
        """Return the mask of nodes without any unknown: the fixed ones that do not slide."""
        free = fixed.copy()
        free[self.nodes] = 0
        return free

    def on(self, shape: tuple[int, int]) -> Slide:
        """Return the sliding nodes of a grid with other numbers of nodes, spaced like these."""
        return Slide([side.resampled(side_index(side.name, shape)) for side in self.sides], shape)

    def part(self, window: tuple[slice, slice]) -> Slide | None:
        """Return the sliding nodes of a rectangle of nodes, whose ends on the sides stay; None if there are none."""
        (first, end), (low, high) = ((along.start, along.stop) for along in window)
        ni, nj = self.shape
        reached = {"bottom": low == 0, "top": high == nj, "left": first == 0, "right": end == ni}
        shape = end - first, high - low
        along = {"bottom": window[0], "top": window[0], "left": window[1], "right": window[1]}
        sides = [side.part(along[side.name], shape) for side in self.sides if reached[side.name]]
        return Slide(sides, shape) if sides else None

    def follow(self, coordinates: Array) -> None:
        """Take the sliding nodes from where they are in coordinates (2, ni, nj), which are on their curves."""
        if np.array_equal(coordinates[:, *self.nodes], self.points):
            return
        for side in self.sides:
            side.follow(coordinates)
        self._set_tangents()

    def space_as(self, coarse: Slide, coordinates: Array) -> None:
        """Space the sliding nodes of coordinates (2, ni, nj) as on a coarser grid of the same sides, in place."""
        for side, other in zip(self.sides, coarse.sides, strict=True):
            side.take(side.place(finer_parameters(side, other)))
        self._set_tangents()
        self.place(coordinates)

    def place(self, coordinates: Array) -> None:
        """Put the sliding nodes of coordinates (2, ni, nj) where they are on their curves, in place."""
        coordinates[:, *self.nodes] = self.points

    def retract(self, coordinates: Array, *, trial: bool = False) -> None:
        """Put the sliding nodes of coordinates (2, ni, nj) back on their curves, in place.

        Of where each has been moved to counts how far that is along the tangent: so far it goes along its curve. None
        passes its neighbor, or a corner.

        Args:
            coordinates: changed in place.
            trial: do not remember where, because the step may be refused.
        """
        there = coordinates[:, *self.nodes]
        tried, places = self._tried
        if tried is None or not np.array_equal(tried, there):
            places = self._advanced((self.tangents * (there - self.points)).sum(axis=0))
        coordinates[:, *self.nodes] = _joined([derivatives[0] for _, derivatives in places])
        if trial:
            self._tried = there, places
        else:
            self.take(places)

    def colors(self) -> Iterator[npt.NDArray[np.bool_]]:
        """Yield masks of the sliding nodes, so that those of one mask have no cell in common."""
        lies = np.concatenate(
            [np.empty(0, dtype=bool), *(np.full(side.free.sum(), side.name in ALONG_XI) for side in self.sides)]
        )
        for along_xi in (True, False):
            numbers = self.nodes[0] if along_xi else self.nodes[1]
            for parity in (0, 1):
                yield (lies == along_xi) & (numbers % 2 == parity)

    def gaps(self, coordinates: Array) -> Array:
        """Return the distance of every sliding node to the nearer of its neighbors on the side."""
        found = [np.empty(0)]
        for side in self.sides:
            edges = np.hypot(*np.diff(coordinates[:, *side.index], axis=1))
            nearer = np.minimum(np.append(edges[-1], edges), np.append(edges, edges[0]))
            found.append(nearer[side.free])
        return np.concatenate(found)

    def second_along(self, planes: Array) -> Array:
        """Return the second derivative along the curve at every sliding node, from a Hessian that is constrained."""
        (xx, xy, yy), (tx, ty) = planes[:3, *self.nodes], self.tangents
        return np.asarray(xx * tx * tx + 2 * xy * tx * ty + yy * ty * ty)

    def moved(self, coordinates: Array, steps: Array) -> tuple[Array, list[Place]]:
        """Return coordinates whose sliding nodes have gone steps (number of nodes,) along their curves, and where."""
        moved, places = coordinates.copy(), self._advanced(steps)
        moved[:, *self.nodes] = _joined([derivatives[0] for _, derivatives in places])
        return moved, places

    def _advanced(self, steps: Array) -> list[Place]:
        """Return the places of the nodes of every side after steps (number of nodes,), in length along the curves.

        To the second order: a step u of the parameter is u |c'| + u^2 c' . c'' / (2 |c'|) long.
        """
        square = (self._slopes * self._slopes).sum(axis=0)
        first = steps / np.sqrt(square)
        lean = (self._slopes * self._bends).sum(axis=0) / square * first
        changes = first * (1.0 - 0.5 * np.minimum(np.maximum(lean, -1.0), 1.0))
        found, begin = [], 0
        for side in self.sides:
            end = begin + side.count
            found.append(side.in_order(side.with_free(side.at[side.free] + changes[begin:end])))
            begin = end
        if self._cubics is not None:
            return self._cubics.places(self.sides, found)
        return [side.place(at) for side, at in zip(self.sides, found, strict=True)]

    def take(self, places: list[Place]) -> None:
        """Take where the nodes of every side are."""
        for side, place in zip(self.sides, places, strict=True):
            side.take(place)
        self._set_tangents()

    def cut_sides(self, coordinates: Array, most: float = _CUT) -> list[str]:
        """Return the sides of which an edge is far from its curve.

        Few nodes may crowd at the ends of a curve, and one edge span the rest: that grid is one of another domain.

        Args:
            coordinates: (2, ni, nj), of the present sliding nodes.
            most: how far the middle of an edge may be from the curve, over its length.
        """
        cut = []
        for side in self.sides:
            line = coordinates[:, *side.index]
            edge = np.hypot(*np.diff(line, axis=1))
            middle = (line[:, 1:] + line[:, :-1]).T / 2
            nearest = side.curve.nearest(middle, (side.at[1:] + side.at[:-1]) / 2)
            away = np.hypot(*(side.curve.point(nearest) - middle).T)
            if (away > most * edge).any():
                cut.append(side.name)
        return cut

    def caution(self, coordinates: Array) -> str:
        """Return a remark on sides whose edges cut off much of their curve, with a leading blank, or nothing."""
        cut = self.cut_sides(coordinates)
        if not cut:
            return ""
        return f" Edges at {' and '.join(cut)} cut off bends of the curve: take more nodes, or let fewer sides slide."

    def _set_tangents(self) -> None:
        found = [side.derivatives for side in self.sides]
        self.points, self._slopes, self._bends = (_joined([of[order] for of in found]) for order in range(3))
        self.tangents = self._slopes / np.hypot(*self._slopes)
        self._tried = None, []

    def tangential(self, field: Array) -> Array:
        """Return the tangential part (2, number of nodes) of a field (2, ni, nj) at the sliding nodes."""
        return np.asarray(self.tangents * (self.tangents * field[:, *self.nodes]).sum(axis=0))

    def constrain(self, planes: Array, gradient: Array, *, semidefinite: bool) -> None:
        """Make the stored half of a Hessian (19, ni, nj) that of the tangential unknowns, in place.

        Args:
            planes: of the Hessian in all nodes.
            gradient: (2, ni, nj), not projected; that at the sliding nodes counts.
            semidefinite: leave out what the curves' bends would take away, so that a semidefinite Hessian stays so.
        """
        if self._couplings is None:
            self._couplings = Couplings(self.nodes, self.shape)
        self._couplings.constrain(planes, self.tangents, self.curvature(gradient, semidefinite=semidefinite))

    def curvature(self, gradient: Array, *, semidefinite: bool) -> Array:
        """Return what bends add to the second derivatives along the curves; see `constrain`."""
        added = along_curves(self._slopes, self._bends, gradient[:, *self.nodes])
        return np.maximum(added, 0.0) if semidefinite else added


def _joined(parts: list[Array]) -> Array:
    """Return vectors (m, 2) of every side as one array (2, number of nodes)."""
    return np.concatenate([np.empty((0, 2)), *parts]).T
