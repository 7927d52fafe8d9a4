"""One side whose nodes slide: its curve, the parameters of its nodes, and their order along it.

Nodes never pass each other or a corner of the curve: in one step no gap along the curve shrinks to less than a given
fraction of what it was.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...boundary.slide_curve import Derivatives, SlideCurve

#: Where nodes are in coordinates, an array (2, ...): by i and j, or by numbers in (2, n).
Index = tuple[Any, ...]

#: The parameters (n,) of all nodes of a side, and the curve's derivatives at those that slide.
Place = tuple[Array, Derivatives]

#: The sides whose nodes are numbered by i.
ALONG_XI = "bottom", "top"
#: A gap between neighbors along the curve keeps this fraction in a step (as interior-point methods keep from a bound).
_KEPT = 0.1
#: A node so far from the curve, over the largest coordinate, is not where it was looked for.
_ON_CURVE = 1e-7
#: A node so near to a corner of the curve, in its parameter, is that corner and stays.
AT_CORNER = 1e-9


@dataclass(slots=True, eq=False)
class SlidingSide:
    """A side whose nodes slide between the corners of its curve.

    Attributes:
        name: `bottom`, `right`, `top` or `left`; or that of a line round several blocks.
        index: of all its nodes. On a closed curve the first one is the last, too, one turn later.
        curve: that they slide along, in the direction of the nodes.
        at: (n,), their parameters, increasing.
        free: (n,), whether a node slides; those at corners of the curve stay.
        low, high: (n,), the parameters of the corners of the curve around each node; of a node that stays its own.
    """

    name: str
    index: Index
    curve: SlideCurve
    at: Array
    free: npt.NDArray[np.bool_] = field(init=False)
    low: Array = field(init=False)
    high: Array = field(init=False)
    _place: Place | None = field(init=False, default=None)
    _before: Place | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        """Find the corners around each node."""
        if self.curve.closed:
            self.free = np.ones(len(self.at), dtype=bool)
            self.free[-1] = False
            self.low, self.high = np.full_like(self.at, -np.inf), np.full_like(self.at, np.inf)
            return
        corners = self.curve.corners
        piece = np.clip(np.searchsorted(corners, self.at, side="right") - 1, 0, len(corners) - 2)
        low, high = corners[piece], corners[piece + 1]
        self.free = np.minimum(np.abs(self.at - low), np.abs(self.at - high)) > AT_CORNER
        self.free[[0, -1]] = False
        self.low, self.high = np.where(self.free, low, self.at), np.where(self.free, high, self.at)

    @property
    def count(self) -> int:
        """How many nodes slide."""
        return int(self.free.sum())

    @property
    def springs(self) -> Array | None:
        """The weights of the edges between all nodes, if springs space them."""
        given = self.curve.springs
        return given if given is not None and len(given) == len(self.at) - 1 else None

    @property
    def nodes(self) -> Index:
        """The indices of the nodes that slide."""
        return tuple(part[self.free] for part in self.index)

    @property
    def derivatives(self) -> Derivatives:
        """The points and the first and second derivatives of the curve (m, 2) at the nodes that slide."""
        if self._place is None or self._place[0] is not self.at:
            self._place = self.place(self.at)
        return self._place[1]

    def place(self, at: Array) -> Place:
        """Return parameters (n,) with the curve's derivatives there."""
        return at, self.curve.derivatives(at[self.free])

    def take(self, place: Place) -> None:
        """Move the nodes to a place; where they were is remembered for `follow`."""
        self._before, self.at, self._place = self._place, place[0], place

    def follow(self, coordinates: Array) -> None:
        """Take the parameters of the nodes of coordinates (2, ni, nj), which are on the curve."""
        there = coordinates[:, *self.nodes].T
        if np.array_equal(there, self.derivatives[0]):
            return
        if self._before is not None and np.array_equal(there, self._before[1][0]):
            self.take(self._before)
            return
        found = self.curve.nearest(there, self.at[self.free], self.derivatives)
        away = np.abs(self.curve.point(found) - there).max(axis=1, initial=0.0)
        far = away > _ON_CURVE * float(np.abs(there).max(initial=0.0))
        if far.any():
            searched = self.curve.nearest(there[far])
            found[far] = searched + np.rint(found[far] - searched) if self.curve.closed else searched
        self.take(self.place(self.with_free(found)))

    def in_order(self, wanted: Array) -> Array:
        """Return parameters near the wanted ones whose gaps are at least a fraction of the present ones."""
        over = wanted - _KEPT * self.at
        np.minimum(np.maximum(over, (1 - _KEPT) * self.low, out=over), (1 - _KEPT) * self.high, out=over)
        if (over[1:] < over[:-1]).any():
            over = _increasing_round(over) if self.curve.closed else _increasing(over)
        return np.asarray(over + _KEPT * self.at)

    def with_free(self, free: Array) -> Array:
        """Return the parameters of all nodes, given those of the nodes that slide."""
        at = self.at.copy()
        at[self.free] = free
        if self.curve.closed:
            at[-1] = at[0] + 1.0
        return at

    def resampled(self, index: Index) -> SlidingSide:
        """Return the same side of a grid with another number of nodes, spaced like these."""
        new, old = (np.linspace(0.0, 1.0, len(nodes)) for nodes in (index[0], self.at))
        return SlidingSide(self.name, index, self.curve, np.interp(new, old, self.at))

    def part(self, along: slice, shape: tuple[int, int]) -> SlidingSide:
        """Return some of the nodes, as the same side of a grid of this shape; the first and the last stay."""
        return SlidingSide(self.name, side_index(self.name, shape), self.curve, self.at[along])


def _increasing(values: Array) -> Array:
    """Return values that do not decrease, near others."""
    return np.asarray((np.maximum.accumulate(values) + np.minimum.accumulate(values[::-1])[::-1]) / 2)


def _increasing_round(values: Array) -> Array:
    """Return the same of values round a closed curve, of which the last is the first a turn later."""
    once, turn = values[:-1], values[-1] - values[0]
    around = _increasing(np.concatenate((once - turn, once, once + turn)))
    return around[len(once) : 2 * len(once) + 1]


def side_index(side: str, shape: tuple[int, int]) -> Index:
    """Return the indices of the nodes of a side of a grid (ni, nj)."""
    ni, nj = shape
    count, of_i = (ni, True) if side in ALONG_XI else (nj, False)
    along = np.arange(count, dtype=np.intp)
    across = np.full(count, 0 if side in ("bottom", "left") else (nj if of_i else ni) - 1, dtype=np.intp)
    return (along, across) if of_i else (across, along)
