"""Curves of a layout by name: what is drawn, and straight lines between points where nothing is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..boundary.curve_nodes import Nodes, straight
from ..errors import GridgenError, quoted

#: An end of a curve may lie so far from its point, over the size of the layout.
_APART = 1e-6


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve between two points.

    Attributes:
        ends: the names of the points that it leads from and to.
        nodes: makes its nodes, from a number of cells.
    """

    ends: tuple[str, str]
    nodes: Nodes


class CurveNames:
    """Points and curves by name; curves that are not drawn come with their first use.

    Attributes:
        ends: of all curves so far.
    """

    def __init__(self, points: Mapping[str, tuple[float, float]], curves: Mapping[str, Curve]) -> None:
        """Check the ends of what is drawn."""
        self._points = {name: np.array(place, dtype=float) for name, place in points.items()}
        self._curves = dict(curves)
        self.ends = {name: curve.ends for name, curve in curves.items()}
        places = np.array([*self._points.values()])
        self._reach = _APART * float(np.ptp(places, axis=0).max())
        for name, ends in self.ends.items():
            for point in ends:
                self._check_point(point, f"curve {name}")
            if ends[0] == ends[1]:
                raise GridgenError(
                    f"the curve {name} begins and ends at {ends[0]}: divide it into two at another point"
                )

    def find(self, name: str, where: str) -> str:
        """Return the name under which a curve is kept, for its own name or `A-B`."""
        if name in self._curves:
            return name
        first, dash, second = name.partition("-")
        if not dash:
            known = ", ".join(self._curves) or "none is drawn"
            raise GridgenError(
                f"unknown curve {quoted(name)} in {where}: expected one of {known}, or two points, such as A-B"
            )
        for point in (first, second):
            self._check_point(point, f"{name} of {where}")
        between = [curve for curve, ends in self.ends.items() if {*ends} == {first, second}]
        if len(between) > 1:
            raise GridgenError(f"{name} of {where} can be {' or '.join(between)}: give the name of the curve")
        if between:
            return between[0]
        self._curves[name] = Curve((first, second), straight(self._points[first], self._points[second]))
        self.ends[name] = (first, second)
        return name

    def nodes(self, curve: str, cells: int) -> Array:
        """Return the nodes of a curve, (cells + 1, 2), whose ends are its points."""
        nodes = self._curves[curve].nodes(cells).copy()
        for at, point in ((0, self.ends[curve][0]), (-1, self.ends[curve][1])):
            apart = float(np.hypot(*(nodes[at] - self._points[point])))
            if not apart <= self._reach:
                raise GridgenError(
                    f"the curve {curve} must {'begin' if at == 0 else 'end'} at the point {point}, "
                    f"{tuple(self._points[point].tolist())}, but is {apart:.3g} away from it, at "
                    f"{tuple(nodes[at].tolist())}"
                )
            nodes[at] = self._points[point]
        return nodes

    def _check_point(self, name: str, where: str) -> None:
        if name not in self._points:
            raise GridgenError(f"unknown point {quoted(name)} in {where}: the points are {', '.join(self._points)}")
