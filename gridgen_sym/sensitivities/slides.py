"""Curves that boundary nodes slide along: derivatives in them, and changes of the minimum's equations with them.

A node slides along c(t) until c'·G vanishes, with the gradient G there. Where the curve moves by dc it takes the node
with it, and the equation changes by dc'·G besides. So derivatives in a curve are those in its points and in its slopes
at the parameters of the nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..boundary.slide_curve import SlideCurve
from ..errors import GridgenError
from ..solvers.sliding.side import SlidingSide
from .point_curves import Pair, PointCurve

#: Where two curves are compared, to see which way one runs through the other.
_PROBES = np.array([0.31, 0.44])


@dataclass(frozen=True, slots=True, eq=False)
class CurveGradient:
    """The derivatives of a number in a curve that was given as a spline or as a function of t.

    Attributes:
        at: (m,), the parameters of the nodes that slide.
        points: (m, 2), the derivatives in the curve's points there.
        slopes: (m, 2), those in its derivatives in t.
    """

    at: Array
    points: Array
    slopes: Array

    def along(self, change: Callable[[Array], npt.ArrayLike]) -> float:
        """Return the derivative along a change of the curve, a function of t (m,) that returns vectors (m, 2).

        Its own derivative in t is a difference of the sixth order, as for curves that are functions.
        """
        point, slope, _ = SlideCurve.of_function(change).derivatives(self.at)
        return float((self.points * point).sum() + (self.slopes * slope).sum())


class SideDerivatives:
    """One sliding side and its curve.

    Attributes:
        side: the nodes on it.
        own: whether the curve is that of the side's own nodes.
    """

    def __init__(self, side: SlidingSide, given: Any, start: Array, gradient: Array) -> None:  # noqa: ANN401
        """Take a side.

        Args:
            side: at the minimum.
            given: the curve as it was given; None for that of the side's own nodes.
            start: (n, 2), the nodes of the start.
            gradient: (2, ni, nj), at the minimum, in all nodes.
        """
        self.side, self.own = side, given is None
        points = start if given is None else given
        by_points = not callable(points) and not isinstance(points, SlideCurve)
        asked = real_array(points, "the curve of a side") if by_points else None
        self._backwards = _runs_backwards(side.curve, points)
        if asked is not None and self._backwards:
            asked = asked[::-1]
        self._curve = None if asked is None else PointCurve(asked)
        self._gradient = gradient[:, *side.index].T
        # Nodes that hold turns other than those of the start have been moved there.
        self._turns = self._held_turns(start)

    def _held_turns(self, start: Array) -> list[tuple[int, int]]:
        """Return pairs of a node that stays at a turn, and the point of the curve that is that turn."""
        if self._curve is None:
            return []
        place, pairs = self.side.curve.point(self.side.at), []
        for k in np.flatnonzero(~self.side.free[1:-1]) + 1:
            moved = np.abs(place[k] - start[k]).max() > 1e-9 * np.ptp(start)
            if moved:
                pairs.append((int(k), int(np.abs(self._curve.arc - self.side.at[k]).argmin())))
        return pairs

    @property
    def moved(self) -> list[int]:
        """The nodes that stay at turns where the start did not have them."""
        return [node for node, _ in self._turns]

    def derivative(self, nodes: Array, field: Array) -> Any:  # noqa: ANN401
        """Return the derivatives in the curve: in its points, (n, 2), or a `CurveGradient`.

        Args:
            nodes: (2, ni, nj), the derivatives in the nodes.
            field: (2, ni, nj), the solution of the adjoint system.
        """
        at, free = self.side.at[self.side.free], self.side.free
        in_points, (_, slope, _) = nodes[:, *self.side.index].T, self.side.derivatives
        pull = (field[:, *self.side.nodes].T * slope).sum(axis=1) / (slope**2).sum(axis=1)
        in_slopes = -pull[:, None] * self._gradient[free]
        if self._curve is None:
            if self._backwards:
                return CurveGradient(1.0 - at, in_points[free], -in_slopes)
            return CurveGradient(at, in_points[free], in_slopes)
        found = self._curve.transposed(in_points[free], in_slopes, at)
        for node, point in self._turns:
            found[point] += in_points[node]
        return found[::-1] if self._backwards else found

    def change(self, given: Any) -> tuple[Array, Array]:  # noqa: ANN401
        """Return how the nodes (2, n) of the side move with the curve, and what their equations change by.

        Args:
            given: the change of the curve's points (n, 2), or a function of t that returns vectors (m, 2).
        """
        side, free = self.side, self.side.free
        nodes, residual = np.zeros((2, len(side.at))), np.zeros((2, len(side.at)))
        point, slope = self._along(given, side.at[free])
        first = side.derivatives[1]
        nodes[:, free] = point.T
        turned = (slope * self._gradient[free]).sum(axis=1) / (first**2).sum(axis=1)
        residual[:, free] = (first * turned[:, None]).T
        if self._curve is not None:
            points = np.asarray(given)[::-1] if self._backwards else np.asarray(given)
            for node, number in self._turns:
                nodes[:, node] = points[number]
        return nodes, residual

    def _along(self, given: Any, at: Array) -> Pair:  # noqa: ANN401
        if self._curve is None:
            if not callable(given):
                raise GridgenError(
                    f"the change of the curve of {self.side.name}, a spline or a function, is a function of t in "
                    "[0, 1] that returns vectors (m, 2)"
                )
            point, slope, _ = SlideCurve.of_function(given).derivatives(1.0 - at if self._backwards else at)
            return point, -slope if self._backwards else slope
        change = real_array(given, f"the change of the curve of {self.side.name}")
        if change.shape != self._curve.points.shape:
            raise GridgenError(
                f"the change of the curve of {self.side.name} must have the shape of its points, "
                f"{self._curve.points.shape}; came {change.shape}"
            )
        return self._curve.along(change[::-1] if self._backwards else change, at)


def _runs_backwards(curve: SlideCurve, given: Any) -> bool:  # noqa: ANN401
    """Return whether a side runs through the curve that was given from its end."""
    from ..boundary.slide_curve import slide_curve

    asked, there = slide_curve(given), curve.point(_PROBES)
    ahead, back = (np.abs(asked.point(at) - there).max() for at in (_PROBES, 1.0 - _PROBES))
    return bool(back < ahead)
