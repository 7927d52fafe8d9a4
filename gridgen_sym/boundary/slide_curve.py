"""Curves that boundary nodes slide along: of the nodes of a side, a polyline, a SciPy spline or a function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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
_NEWTON_STEPS = 12

_FIRST = ((-3, -1 / 60), (-2, 3 / 20), (-1, -3 / 4), (1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
_SECOND = ((-3, 1 / 90), (-2, -3 / 20), (-1, 3 / 2), (0, -49 / 18), (1, 3 / 2), (2, -3 / 20), (3, 1 / 90))


@dataclass(frozen=True, slots=True, eq=False)
class SlideCurve:
    """A curve with a parameter from 0 to 1.

    Attributes:
        point: its points (m, 2) at parameters (m,).
        first, second: the derivatives in the parameter.
        corners: the parameters of its sharp turns and of its two ends, in order.
    """

    point: Callable[[Array], Array]
    first: Callable[[Array], Array]
    second: Callable[[Array], Array]
    corners: Array

    @classmethod
    def of_points(cls, points: npt.ArrayLike) -> SlideCurve:
        """Return the curve through points (n, 2): cubic splines between sharp turns, straight where there are few."""
        from scipy.interpolate import CubicSpline, make_interp_spline

        line = real_array(points, "the curve of a side")
        if line.ndim != 2 or line.shape[1] != 2 or len(line) < 2:
            raise GridgenError(
                f"the curve of a side must be at least two different points (n, 2); came an array of shape {line.shape}"
            )
        arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
        bad = np.flatnonzero(~(np.diff(arc) > 0))
        if len(bad):
            k = int(bad[0])
            raise GridgenError(
                "the points of the curve of a side must be finite, and each different from the one before; points "
                f"{k} and {k + 1} are {line[k].tolist()} and {line[k + 1].tolist()}: leave out what is repeated"
            )
        arc /= arc[-1]
        sharp = np.concatenate(([0], 1 + np.flatnonzero(_turns(line) > _SHARP), [len(line) - 1]))
        pieces = []
        for begin, end in pairwise(sharp):
            s, p = arc[begin : end + 1], line[begin : end + 1]
            pieces.append(CubicSpline(s, p) if len(s) > 3 else make_interp_spline(s, p, k=len(s) - 1))
        ends = arc[sharp]

        def evaluate(t: Array, order: int) -> Array:
            which = np.clip(np.searchsorted(ends, t, side="right") - 1, 0, len(pieces) - 1)
            found = np.empty((len(t), 2))
            for k in np.unique(which):
                found[which == k] = pieces[k](t[which == k], nu=order)
            return found

        return cls(lambda t: evaluate(t, 0), lambda t: evaluate(t, 1), lambda t: evaluate(t, 2), ends)

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

        def difference(weights: tuple[tuple[int, float], ...], order: int) -> Callable[[Array], Array]:
            return lambda t: np.asarray(sum(w * point(t + k * _STEP) for k, w in weights) / _STEP**order)

        return cls(point, difference(_FIRST, 1), difference(_SECOND, 2), np.array([0.0, 1.0]))

    def nearest(self, place: Array, start: Array | None = None) -> Array:
        """Return the parameters (m,) of the nearest points of the curve.

        Args:
            place: (m, 2).
            start: parameters near those; without them the whole curve is searched first.
        """
        if start is None:
            t = np.linspace(0, 1, _SAMPLES)
            from scipy.spatial import cKDTree

            start = t[cKDTree(self.point(t)).query(place)[1]]
        t = start.copy()
        for _ in range(_NEWTON_STEPS):
            apart, slope = self.point(t) - place, self.first(t)
            square = (slope**2).sum(axis=1)
            bend = square + (apart * self.second(t)).sum(axis=1)
            step = (apart * slope).sum(axis=1) / np.where(bend > 0.1 * square, bend, square)
            t = np.clip(t - step, 0.0, 1.0)
            if np.abs(step).max(initial=0.0) < 1e-15:
                break
        return t


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

    def evaluate(order: int) -> Callable[[Array], Array]:
        return lambda t: np.asarray(spline(begin + scale * t, nu=order) * scale**order)

    if np.shape(spline(np.array([begin, end]))) != (2, 2):
        raise GridgenError("the spline of a side must have two components, x and y")
    return SlideCurve(evaluate(0), evaluate(1), evaluate(2), np.array([0.0, 1.0]))


def _turns(line: Array) -> Array:
    """Return by how much a polyline turns at its inner points, in radians."""
    step = np.diff(line, axis=0)
    cross = step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0]
    return np.asarray(np.abs(np.arctan2(cross, (step[:-1] * step[1:]).sum(axis=1))))
