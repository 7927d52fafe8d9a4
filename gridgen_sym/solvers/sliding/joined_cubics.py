"""The piecewise cubic curves of all sides as one, which is evaluated at once: on small grids calls cost most."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...arrays import Array
from ...boundary.slide_curve import cubic_derivatives
from .side import Place, SlidingSide

#: The parameters of a side, from 0 to 1, are so far from those of the one before.
_APART = 2.0


class JoinedCubics:
    """The curves of sides, one after the other."""

    __slots__ = ("_breaks", "_ends", "_factors", "_shifts", "_starts")

    def __init__(self, sides: list[SlidingSide], cubics: list[tuple[Array, Array]]) -> None:
        """Join the cubics of sides: between the breaks of two sides is one more, so that all have their intervals."""
        shifts = _APART * np.arange(len(sides))
        between = [
            np.append(breaks[1:-1], 0.5 * (1.0 + _APART)) + shift
            for (breaks, _), shift in zip(cubics, shifts, strict=True)
        ]
        self._breaks = np.concatenate(between)[:-1]
        self._starts = np.concatenate([breaks[:-1] for breaks, _ in cubics])
        self._factors = np.concatenate([factors for _, factors in cubics], axis=1)
        counts = [side.count for side in sides]
        self._shifts, self._ends = np.repeat(shifts, counts), np.cumsum([0, *counts]).tolist()

    @classmethod
    def of(cls, sides: list[SlidingSide]) -> JoinedCubics | None:
        """Return those of sides; None where a curve is another one."""
        cubics = [side.curve.cubics for side in sides if side.curve.cubics is not None]
        return cls(sides, cubics) if sides and len(cubics) == len(sides) else None

    def places(self, sides: list[SlidingSide], parameters: list[Array]) -> list[Place]:
        """Return the parameters (n,) of every side with the derivatives of its curve there; see `SlidingSide.place`."""
        at = np.concatenate([of[side.free] for side, of in zip(sides, parameters, strict=True)])
        which = self._breaks.searchsorted(at + self._shifts, side="right")
        point, slope, bend = cubic_derivatives(self._factors[:, which], at - self._starts[which])
        return [
            (of, (point[low:high], slope[low:high], bend[low:high]))
            for of, (low, high) in zip(parameters, pairwise(self._ends), strict=True)
        ]
