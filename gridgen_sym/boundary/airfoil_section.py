"""Sections of airfoils: NACA numbers, files of points, and the spline through them."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..atomic import read_bytes, shown
from ..errors import GridgenError
from ..outlines.formats.section import EXPECTED, parse_section
from .curves import Side
from .laws import two_ended
from .naca import naca_points

_FEWEST = 9
#: Ends that are so near, in chords, are the same point.
_SHARP = 1e-6
_SAMPLES = 4001


@dataclass(frozen=True, slots=True, eq=False)
class AirfoilSection:
    """A section: a curve from the lower side of the trailing edge over the leading edge to its upper side.

    Attributes:
        name: of the section.
        points: (n, 2) on it, in this order, which is clockwise; with a sharp trailing edge the ends are equal.
    """

    name: str
    points: Array

    @classmethod
    def of(
        cls, given: str | os.PathLike[str] | AirfoilSection | npt.ArrayLike, *, blunt: bool = False
    ) -> AirfoilSection:
        """Return a section from a NACA number, the path of a `.dat` file, or points (n, 2) in either direction.

        Raises:
            GridgenError: for what is none of these, or no section.
        """
        if isinstance(given, AirfoilSection):
            return given
        if isinstance(given, (str, os.PathLike)):
            text = os.fspath(given)
            if Path(text).suffix:
                return cls.read(text)
            return cls.of_points(text, naca_points(text, blunt=blunt))
        return cls.of_points("section", real_array(given, "the section"))

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> AirfoilSection:
        """Read a file of Selig's or Lednicer's form; coordinates stay what they are."""
        try:
            return cls.of_points(*parse_section(read_bytes(path), Path(path)))
        except GridgenError as error:
            raise GridgenError(f"cannot read the airfoil {shown(path)}: {error}") from error

    @classmethod
    def of_points(cls, name: str, points: Array) -> AirfoilSection:
        """Return the section through points (n, 2), in either direction from trailing edge to trailing edge."""
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise GridgenError(f"a section must be finite points of shape (n, 2); came an array of {points.shape}")
        again = np.zeros(len(points), dtype=bool)
        again[1:] = (np.diff(points, axis=0) == 0).all(axis=1)
        points = points[~again]
        if len(points) < _FEWEST:
            raise GridgenError(f"a section needs at least {_FEWEST} different points; came {len(points)}. {EXPECTED}")
        x, y = points.T
        area = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
        if area > 0:
            points = points[::-1]
        chord, gap = _chord(points), float(np.hypot(*(points[0] - points[-1])))
        if gap > 0.1 * chord or abs(area) < 1e-4 * chord**2:
            raise GridgenError(
                f"the section is not closed at the trailing edge: its ends are {gap / chord:.3g} chords apart, and it "
                f"encloses {abs(area) / chord**2:.3g} square chords; {EXPECTED}"
            )
        points = points.copy()
        if gap < _SHARP * chord:
            points[0] = points[-1] = (points[0] + points[-1]) / 2
        return cls(name, points)

    @property
    def chord(self) -> float:
        """The greatest distance from the trailing edge."""
        return _chord(self.points)

    @property
    def trailing_edge(self) -> Array:
        """The middle of the trailing edge, (2,)."""
        return np.asarray((self.points[0] + self.points[-1]) / 2)

    @property
    def base(self) -> float:
        """The thickness of the trailing edge; 0 where it is sharp."""
        return float(np.hypot(*(self.points[0] - self.points[-1])))

    @property
    def wake_slope(self) -> float:
        """The slope dy/dx with which the line halfway between both sides leaves the trailing edge."""
        lower, upper = self.points[0] - self.points[1], self.points[-1] - self.points[-2]
        way = lower / np.hypot(*lower) + upper / np.hypot(*upper)
        if not way[0] > abs(way[1]):
            raise GridgenError(
                f"the trailing edge of {self.name} points along ({way[0]:.3g}, {way[1]:.3g}): the flow must come along "
                "x, so turn the section"
            )
        return float(way[1] / way[0])

    def nodes(self, cells: int, leading: float, trailing: float) -> Array:
        """Return nodes (cells + 1, 2) on the spline of the points, half of the cells on each side.

        Args:
            cells: their even number.
            leading: length of the cells at the leading edge, along the arc.
            trailing: the same at the trailing edge.
        """
        spline, nose, length = self._spline()
        lower = nose * two_ended(trailing / nose, leading / nose, cells // 2)[0]
        rest = length - nose
        upper = nose + rest * two_ended(leading / rest, trailing / rest, cells // 2)[0]
        nodes = spline(np.concatenate((lower, upper[1:])))
        nodes[0], nodes[-1] = self.points[0], self.points[-1]
        return np.asarray(nodes)

    def side(self, name: Literal["lower", "upper"]) -> Side:
        """Return the curve of one side from the leading edge to the trailing edge, on the spline of the points."""
        spline, nose, length = self._spline()
        end = 0.0 if name == "lower" else length
        return lambda s: np.asarray(spline((1 - s) * nose + s * end))

    def _spline(self) -> tuple[Side, float, float]:
        """Return the spline of the points by arc length, where the leading edge is on it, and its whole length."""
        from scipy.interpolate import CubicSpline

        arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(self.points, axis=0).T))))
        spline = CubicSpline(arc, self.points)
        dense = np.linspace(0, arc[-1], _SAMPLES)
        nose = float(dense[np.hypot(*(spline(dense) - self.trailing_edge).T).argmax()])
        return spline, nose, float(arc[-1])


def _chord(points: npt.NDArray[np.float64]) -> float:
    return float(np.hypot(*(points - (points[0] + points[-1]) / 2).T).max())
