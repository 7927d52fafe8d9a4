"""Curves through points: how they change with these, as `SlideCurve.of_points` makes them.

Between sharp turns the curve is a cubic spline in the chord length along the points, which changes with them, too.
Where a knot x moves while the values stay, the spline S changes by -[S''']/2 (t - x)² beyond it, with the jump of its
third derivative there, and by the spline on the present knots that restores what is interpolated, -S'(x) at the knot.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.slide_curve import chord_fractions, sharp_turns
from .edges import fractions_transposed, lengths_transposed

#: Changes of points, or derivatives in them, of a curve at some parameters: of its points, and of its slopes (m, 2).
Pair = tuple[Array, Array]


class PointCurve:
    """The curve through points (n, 2), of parameters that grow with the chord length from 0 to 1.

    Attributes:
        points: that it goes through.
        arc: (n,), their parameters.
    """

    def __init__(self, points: Array) -> None:
        """Fit the splines between sharp turns."""
        self.points, self.arc = points, chord_fractions(points)
        sharp = [0, *np.flatnonzero(sharp_turns(points)).tolist(), len(points) - 1]
        self._pieces = [
            _Piece.of(self.arc[a : b + 1], points[a : b + 1], np.arange(a, b + 1)) for a, b in pairwise(sharp)
        ]

    def along(self, change: Array, at: Array) -> Pair:
        """Return how points and slopes at parameters (m,) change along a change of the points (n, 2)."""
        moved, point, slope = _arc_along(self.points, change), np.zeros((len(at), 2)), np.zeros((len(at), 2))
        for piece, chosen in self._chosen(at):
            point[chosen], slope[chosen] = piece.along(change[piece.number], moved[piece.number], at[chosen])
        return point, slope

    def transposed(self, in_points: Array, in_slopes: Array, at: Array) -> Array:
        """Return derivatives in the points (n, 2), given those in the curve's points and slopes at parameters."""
        found, in_arc = np.zeros_like(self.points), np.zeros(len(self.points))
        for piece, chosen in self._chosen(at):
            values, knots = piece.transposed(in_points[chosen], in_slopes[chosen], at[chosen])
            found[piece.number] += values
            in_arc[piece.number] += knots
        return found + _arc_transposed(self.points, in_arc)

    def _chosen(self, at: Array) -> list[tuple[_Piece, npt.NDArray[np.bool_]]]:
        ends = np.array([piece.knots[-1] for piece in self._pieces[:-1]])
        which = np.searchsorted(ends, at, side="right")
        return [(piece, which == k) for k, piece in enumerate(self._pieces)]


@dataclass(eq=False)
class _Piece:
    """One spline.

    Attributes:
        knots: (k,).
        number: of its points among all.
        spline: through the points.
        cardinal: the splines that are 1 at one knot and 0 at the others.
        jumps: (k, 2), of the third derivative at the knots.
    """

    knots: Array
    number: npt.NDArray[np.intp]
    spline: Any
    cardinal: Any
    jumps: Array

    @classmethod
    def of(cls, knots: Array, points: Array, number: npt.NDArray[np.intp]) -> _Piece:
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(knots, points)
        jumps = np.zeros_like(points)
        if len(knots) > 4:  # At the second knot from each end there is none.
            jumps[2:-2] = 6 * np.diff(spline.c[0], axis=0)[1:-1]
        return cls(knots, number, spline, CubicSpline(knots, np.eye(len(knots))), jumps)

    def along(self, change: Array, moved: Array, at: Array) -> Pair:
        """Return how points and slopes change with the points and with the knots (k,)."""
        pull = self.jumps * moved[:, None]
        values = change - self.spline(self.knots, 1) * moved[:, None] + 0.5 * _squares(self.knots, self.knots) @ pull
        point = self.cardinal(at) @ values - 0.5 * _squares(at, self.knots) @ pull
        return point, self.cardinal(at, 1) @ values - _beyond(at, self.knots) @ pull

    def transposed(self, in_points: Array, in_slopes: Array, at: Array) -> Pair:
        """Return derivatives in the points (k, 2), and in the knots (k,)."""
        values = self.cardinal(at).T @ in_points + self.cardinal(at, 1).T @ in_slopes
        pull = 0.5 * _squares(self.knots, self.knots).T @ values
        pull -= 0.5 * _squares(at, self.knots).T @ in_points + _beyond(at, self.knots).T @ in_slopes
        knots = (self.jumps * pull - self.spline(self.knots, 1) * values).sum(axis=1)
        return values, np.asarray(knots)


def _beyond(at: Array, knots: Array) -> Array:
    return np.asarray(np.maximum(at[:, None] - knots, 0.0))


def _squares(at: Array, knots: Array) -> Array:
    return _beyond(at, knots) ** 2


def _arc_along(points: Array, change: Array) -> Array:
    """Return how fractions of the chord length change with the points."""
    edges = np.diff(points, axis=0)
    lengths = np.hypot(*edges.T)
    grown = (edges * np.diff(change, axis=0)).sum(axis=1) / lengths
    part, total = np.concatenate(([0.0], np.cumsum(lengths))), lengths.sum()
    return np.asarray(np.concatenate(([0.0], np.cumsum(grown))) / total - part * grown.sum() / total**2)


def _arc_transposed(points: Array, in_arc: Array) -> Array:
    """Return derivatives in points (n, 2), given those in the fractions of the chord length."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    return lengths_transposed(points.T, fractions_transposed(lengths, in_arc)).T
