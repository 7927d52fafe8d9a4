"""Curves that boundary nodes slide along: of the nodes of a side, a polyline, a SciPy spline or a function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted

#: A polyline that turns by more than this, in radians, has a corner there, and is smooth between corners.
_SHARP = np.radians(20.0)
#: The step of differences of functions, whose error is its sixth power.
_STEP = 2e-3
#: Samples of a function among which the nearest point is looked for first.
_SAMPLES = 2001
#: So many of the nearest samples are tried.
_CANDIDATES = 8
_NEWTON_STEPS = 12
#: After so short a Newton step the next is near rounding.
_LAST_STEP = 1e-7

_FIRST = ((-3, -1 / 60), (-2, 3 / 20), (-1, -3 / 4), (1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
_SECOND = ((-3, 1 / 90), (-2, -3 / 20), (-1, 3 / 2), (0, -49 / 18), (1, 3 / 2), (2, -3 / 20), (3, 1 / 90))

#: Points of a curve (m, 2), and its first and second derivatives there.
Derivatives = tuple[Array, Array, Array]


@dataclass(frozen=True, slots=True, eq=False)
class SlideCurve:
    """A curve with a parameter from 0 to 1.

    Attributes:
        point: its points (m, 2) at parameters (m,).
        derivatives: its points, and their first and second derivatives in the parameter.
        corners: the parameters of its sharp turns and of its two ends, in order.
        springs: the weights (n - 1,) of the edges of n nodes along it, which are pulled to equal weight times length;
            None where the functional alone spaces the nodes.
        closed: whether it has no ends: parameters go on beyond 1 where they began at 0.
        cubics: the breaks (m + 1,) and factors (4, m, 2) of a piecewise cubic curve; None for others.
    """

    point: Callable[[Array], Array]
    derivatives: Callable[[Array], Derivatives]
    corners: Array
    springs: Array | None = None
    closed: bool = False
    cubics: tuple[Array, Array] | None = None

    def first(self, t: Array) -> Array:
        """Return the first derivatives (m, 2)."""
        return self.derivatives(t)[1]

    def second(self, t: Array) -> Array:
        """Return the second derivatives (m, 2)."""
        return self.derivatives(t)[2]

    @classmethod
    def of_points(cls, points: npt.ArrayLike, corners: npt.NDArray[np.intp] | None = None) -> SlideCurve:
        """Return the curve through points (n, 2): cubic splines between corners, straight where there are few points.

        Args:
            points: in their order.
            corners: the indices of those that are corners, increasing, between the two ends; by default sharp turns.
        """
        line = real_array(points, "the curve of a side")
        if line.ndim != 2 or line.shape[1] != 2 or len(line) < 2:
            raise GridgenError(
                f"the curve of a side must be at least two different points (n, 2); came an array of shape {line.shape}"
            )
        arc = chord_fractions(line)
        bad = np.flatnonzero(~(np.diff(arc) > 0))
        if len(bad):
            k = int(bad[0])
            raise GridgenError(
                "the points of the curve of a side must be finite, and each different from the one before; points "
                f"{k} and {k + 1} are {line[k].tolist()} and {line[k + 1].tolist()}: leave out what is repeated"
            )
        inner = np.flatnonzero(sharp_turns(line)) if corners is None else corners
        sharp = np.concatenate(([0], inner, [len(line) - 1]))
        cubics = _splines(arc, line, sharp)
        derivatives = _of_cubics(*cubics)
        return cls(lambda t: derivatives(t)[0], derivatives, arc[sharp], cubics=cubics)

    @classmethod
    def round_points(cls, points: Array) -> SlideCurve:
        """Return the smooth closed curve through points (n, 2), of which the last is the first again."""
        from scipy.interpolate import CubicSpline

        arc = chord_fractions(points)
        spline = CubicSpline(arc, np.concatenate((points[:-1], points[:1])), bc_type="periodic")
        derivatives = _of_cubics(arc, spline.c)
        return cls(lambda t: derivatives(t)[0], derivatives, np.array([0.0, 1.0])).as_closed()

    @classmethod
    def of_function(cls, function: Callable[[Array], Any]) -> SlideCurve:
        """Return the curve of a function of an array (m,) of parameters from 0 to 1, which returns points (m, 2).

        Derivatives are differences of the sixth order.
        """

        def point(t: Array) -> Array:
            found = real_array(function(t), "the curve of a side")
            if found.shape != (len(t), 2):
                raise GridgenError(
                    f"the curve of a side must return points of shape ({len(t)}, 2) for {len(t)} parameters; came "
                    f"{found.shape}"
                )
            if not np.isfinite(found).all():
                raise GridgenError("the curve of a side must be finite for all t from 0 to 1, and a little beyond")
            return found

        def derivatives(t: Array) -> Derivatives:
            near = {k: point(t + k * _STEP) for k, _ in _SECOND}
            first, second = (sum(w * near[k] for k, w in weights) for weights in (_FIRST, _SECOND))
            return near[0], np.asarray(first / _STEP), np.asarray(second / _STEP**2)

        return cls(point, derivatives, np.array([0.0, 1.0]))

    def as_closed(self) -> SlideCurve:
        """Return the same curve as one without ends; its last point must be its first."""
        whole = replace(self, point=lambda t: self.point(t % 1.0), derivatives=lambda t: self.derivatives(t % 1.0))
        return replace(whole, closed=True, cubics=None)

    def reversed(self) -> SlideCurve:
        """Return the same curve, run through the other way."""

        def derivatives(t: Array) -> Derivatives:
            point, first, second = self.derivatives(1.0 - t)
            return point, -first, second

        springs = None if self.springs is None else self.springs[::-1]
        return SlideCurve(lambda t: self.point(1.0 - t), derivatives, 1.0 - self.corners[::-1], springs, self.closed)

    def nearest(self, place: Array, start: Array | None = None, known: Derivatives | None = None) -> Array:
        """Return the parameters (m,) of the nearest points of the curve.

        Args:
            place: (m, 2).
            start: parameters near those; without them the whole curve is searched.
            known: the curve's points and derivatives there, if they have been evaluated.
        """
        if start is None:
            return self._searched(place)
        low, high = (-np.inf, np.inf) if self.closed else (0.0, 1.0)
        return self._near(place, start, low, high, known)

    def _searched(self, place: Array) -> Array:
        """Return the parameters of the nearest points of the whole curve."""
        from scipy.spatial import cKDTree

        ends = list(pairwise(self.corners.tolist()))
        pieces = [np.linspace(low, high, max(3, int(np.ceil((high - low) * _SAMPLES)))) for low, high in ends]
        low, high = (np.repeat(side, [len(piece) for piece in pieces]) for side in zip(*ends, strict=True))
        samples = np.concatenate(pieces)
        # Where arms of a curve are close together, the nearest sample may be on the wrong one.
        found = cKDTree(self.point(samples)).query(place, k=_CANDIDATES)[1].T
        at = np.stack([self._near(place, samples[k], low[k], high[k]) for k in found])
        away = np.stack([np.hypot(*(self.point(t) - place).T) for t in at])
        return np.asarray(at[away.argmin(axis=0), np.arange(len(place))])

    def _near(
        self,
        place: Array,
        start: Array,
        low: Array | float,
        high: Array | float,
        known: Derivatives | None = None,
    ) -> Array:
        """Return the parameters of the nearest points near a start, between bounds."""
        t = start.copy()
        for _ in range(_NEWTON_STEPS):
            (point, slope, second), known = known or self.derivatives(t), None
            apart, square = point - place, (slope**2).sum(axis=1)
            bend = square + (apart * second).sum(axis=1)
            step = (apart * slope).sum(axis=1) / np.where(bend > 0.1 * square, bend, square)
            t = np.clip(t - step, low, high)
            if np.abs(step).max(initial=0.0) < _LAST_STEP:
                break
        return t


def chord_fractions(line: npt.ArrayLike) -> Array:
    """Return the length of a polyline (n, 2) up to each of its points, over the whole length."""
    points = np.asarray(line, dtype=float)
    length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    return length / (length[-1] or 1.0)


def slide_curve(given: Any) -> SlideCurve:  # noqa: ANN401 - whatever a user gave
    """Return a curve from points, a SciPy spline, or a function of t in [0, 1].

    Raises:
        GridgenError: for what is none of these.
    """
    if isinstance(given, SlideCurve):
        return given
    if callable(given):
        knots = getattr(given, "x", None)  # Of a CubicSpline or another piecewise polynomial.
        if knots is None and hasattr(given, "t") and hasattr(given, "k"):  # Of a BSpline.
            knots = given.t[given.k : len(given.t) - given.k]
        return SlideCurve.of_function(given) if knots is None else _of_spline(given, float(knots[0]), float(knots[-1]))
    if isinstance(given, (np.ndarray, list, tuple)):
        return SlideCurve.of_points(given)
    raise GridgenError(
        f"the curve of a side must be points (n, 2), a SciPy spline or a function of t in [0, 1]; came {quoted(given)}"
    )


def _of_spline(spline: Any, begin: float, end: float) -> SlideCurve:  # noqa: ANN401 - SciPy has no types
    """Return the curve of a SciPy spline, whose derivatives are exact."""
    scale = end - begin

    def derivatives(t: Array) -> Derivatives:
        point, first, second = (np.asarray(spline(begin + scale * t, nu=order) * scale**order) for order in range(3))
        return point, first, second

    if np.shape(spline(np.array([begin, end]))) != (2, 2):
        raise GridgenError("the spline of a side must have two components, x and y")
    return SlideCurve(lambda t: np.asarray(spline(begin + scale * t)), derivatives, np.array([0.0, 1.0]))


def _splines(arc: Array, line: Array, sharp: npt.NDArray[np.intp]) -> tuple[Array, Array]:
    """Return the breaks (m + 1,) and the factors (4, m, 2) of cubic splines through the points between sharp turns.

    Through three points it is a parabola, through two a straight line.
    """
    from scipy.interpolate import CubicSpline

    pieces = [CubicSpline(arc[begin : end + 1], line[begin : end + 1]) for begin, end in pairwise(sharp)]
    return arc, np.concatenate([piece.c for piece in pieces], axis=1)


def _of_cubics(breaks: Array, factors: Array) -> Callable[[Array], Derivatives]:
    """Return the derivatives of a piecewise cubic curve, with breaks (m + 1,) and factors (4, m, 2)."""

    def derivatives(t: Array) -> Derivatives:
        which = breaks[1:-1].searchsorted(t, side="right")
        return cubic_derivatives(factors[:, which], t - breaks[which])

    return derivatives


def cubic_derivatives(factors: Array, x: Array) -> Derivatives:
    """Return the values and derivatives (m, 2) of cubics with factors (4, m, 2) at places (m,), one of each."""
    (a, b, c, d), x = factors, x[:, None]
    return ((a * x + b) * x + c) * x + d, (3 * a * x + 2 * b) * x + c, 6 * a * x + 2 * b


def sharp_turns(line: Array) -> npt.NDArray[np.bool_]:
    """Return at which points of a polyline (n, 2) it turns by more than a curve would; never at the ends."""
    step = np.diff(line, axis=0)
    cross = step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0]
    turns = np.abs(np.arctan2(cross, (step[:-1] * step[1:]).sum(axis=1)))
    return np.concatenate(([False], turns > _SHARP, [False]))
