"""The kinds of curves that a description can draw."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..boundary.airfoil_section import AirfoilSection
from ..boundary.curve_nodes import Nodes, nodes_on, nodes_on_polyline, straight
from ..errors import GridgenError, quoted
from ..fields.formula import Formula
from ..outlines import read_content
from ..topology.curve_names import Curve
from .values import check_keys, pair

Points = Mapping[str, tuple[float, float]]
#: The ends of a curve, and what makes its nodes, given the law of their spacing.
Drawn = tuple[tuple[str, str], Callable[[str | None], Nodes]]


@dataclass(frozen=True, slots=True)
class _Entry:
    """A curve of a description.

    Attributes:
        name: of the curve.
        table: what is said of it.
        kind: `line`, `polyline`, `spline`, `arc`, `formula` or `section`.
        points: places by name.
        folder: what file names are relative to.
    """

    name: str
    table: Mapping[str, Any]
    kind: str
    points: Points
    folder: Path

    @property
    def given(self) -> Any:  # noqa: ANN401
        """What stands at the key of the kind."""
        return self.table[self.kind]

    def ends(self) -> tuple[str, str]:
        """Return the names of the ends of a curve that does not begin and end with points by itself."""
        return self._two_names(self.table.get("ends"), "ends")

    def two_points(self) -> tuple[str, str]:
        """Return the names of the points of a line or an arc, which must be known."""
        names = self._two_names(self.given, self.kind)
        for name in names:
            self.place(name)
        return names

    def place(self, given: object) -> Array:
        """Return a place: that of a point, or two numbers."""
        if isinstance(given, str):
            if given not in self.points:
                raise GridgenError(
                    f"unknown point {quoted(given)} in the curve {self.name}: the points are {', '.join(self.points)}"
                )
            return np.array(self.points[given])
        return np.array(pair(given, f"a place of the curve {self.name}"))

    def spacing(self) -> str | None:
        """Return the law of the spacing, if there is one."""
        law = self.table.get("spacing")
        if law is not None and not isinstance(law, str):
            raise GridgenError(f"spacing of the curve {self.name} must be a law as text; came {quoted(law)}")
        return law

    def _two_names(self, given: object, key: str) -> tuple[str, str]:
        if not isinstance(given, list) or len(given) != 2 or not all(isinstance(name, str) for name in given):
            raise GridgenError(
                f"{key} of the curve {self.name} must be the names of two points, such as {key} = ['A', 'B']; came "
                f"{quoted(given)}"
            )
        return given[0], given[1]


def drawn(name: str, table: object, points: Points, folder: Path) -> tuple[Curve, Array]:
    """Return the curve that an entry of the table `curves` draws, and the places of its ends, (2, 2).

    Args:
        name: of the curve.
        table: the entry.
        points: places by name.
        folder: what file names are relative to.

    Raises:
        GridgenError: for an entry that draws none.
    """
    kinds = [kind for kind in _KINDS if isinstance(table, dict) and kind in table]
    if not isinstance(table, dict) or len(kinds) != 1:
        raise GridgenError(f"the curve {name} must have one of {', '.join(_KINDS)}; came {quoted(table)}")
    keys, draw = _KINDS[kinds[0]]
    check_keys(table, (kinds[0], *keys, "spacing"), f"the curve {name}")
    entry = _Entry(name, table, kinds[0], points, folder)
    ends, make = draw(entry)
    return Curve(ends, make(entry.spacing())), make(None)(1)


def _line(entry: _Entry) -> Drawn:
    ends = entry.two_points()
    return ends, partial(straight, entry.place(ends[0]), entry.place(ends[1]))


def _polyline(entry: _Entry) -> Drawn:
    ends, places = _places(entry)
    return ends, partial(nodes_on_polyline, places)


def _spline(entry: _Entry) -> Drawn:
    from scipy.interpolate import CubicSpline

    ends, places = _places(entry)
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))))
    spline = CubicSpline(arc / arc[-1], places)
    return ends, partial(nodes_on, lambda s: np.asarray(spline(s)))


def _arc(entry: _Entry) -> Drawn:
    ends = entry.two_points()
    center = np.array(pair(entry.table.get("center"), f"center of the curve {entry.name}"))
    start, end = entry.place(ends[0]) - center, entry.place(ends[1]) - center
    radius, other = float(np.hypot(*start)), float(np.hypot(*end))
    if not abs(radius - other) <= 1e-9 * radius or radius == 0:
        raise GridgenError(
            f"the ends of the arc {entry.name} must be equally far from its center, but are {radius:.9g} and "
            f"{other:.9g} away: correct the center or a point"
        )
    clockwise = entry.table.get("clockwise", False)
    if not isinstance(clockwise, bool):
        raise GridgenError(f"clockwise of the arc {entry.name} must be true or false; came {quoted(clockwise)}")
    first = float(np.arctan2(start[1], start[0]))
    turn = float(np.arctan2(end[1], end[0]) - first) % (2 * np.pi)
    turn -= 2 * np.pi * clockwise

    def on_arc(s: Array) -> Array:
        angle = first + turn * s
        return center + radius * np.stack((np.cos(angle), np.sin(angle)), axis=-1)

    return ends, partial(nodes_on, on_arc)


def _formula(entry: _Entry) -> Drawn:
    if not isinstance(entry.given, list) or len(entry.given) != 2 or not all(isinstance(x, str) for x in entry.given):
        raise GridgenError(
            f"formula of the curve {entry.name} must be two formulas of t from 0 to 1, such as ['t', '0.1*sin(pi*t)']; "
            f"came {quoted(entry.given)}"
        )
    x, y = (Formula(text, ("t", "t")) for text in entry.given)

    def on_curve(t: Array) -> Array:
        found = np.stack([np.broadcast_to(one.values(t, t), t.shape) for one in (x, y)], axis=-1)
        if not np.isfinite(found).all():
            at = float(t[int((~np.isfinite(found)).any(axis=-1).argmax())])
            raise GridgenError(f"the formula of the curve {entry.name} has no finite value at t = {at:.6g}")
        return found

    return entry.ends(), partial(nodes_on, on_curve)


def _section(entry: _Entry) -> Drawn:
    part = entry.table.get("part")
    if part not in ("lower", "upper"):
        raise GridgenError(
            f"part of the section {entry.name} must be 'lower' or 'upper', from the leading edge to the trailing edge; "
            f"came {quoted(part)}"
        )
    if not isinstance(entry.given, str):
        raise GridgenError(
            f"section of the curve {entry.name} must be a NACA number or a file; came {quoted(entry.given)}"
        )
    is_file = Path(entry.given).suffix != ""
    section = AirfoilSection.of(entry.folder / entry.given if is_file else entry.given)
    return entry.ends(), partial(nodes_on, section.side(part))


def _places(entry: _Entry) -> tuple[tuple[str, str], Array]:
    """Return the ends and the places (n, 2) of a polyline or a spline: given one by one, or by a file of points."""
    if isinstance(entry.given, str):
        path = entry.folder / entry.given
        ends, places = entry.ends(), read_content(path).points
    elif isinstance(entry.given, list) and len(entry.given) >= 2 and "ends" not in entry.table:
        first, last = entry.given[0], entry.given[-1]
        if not isinstance(first, str) or not isinstance(last, str):
            raise GridgenError(f"the curve {entry.name} must begin and end with the name of a point")
        ends, places = (first, last), np.array([entry.place(one) for one in entry.given])
    else:
        raise GridgenError(
            f"{entry.kind} of the curve {entry.name} must be a list of points and pairs [x, y] that begins and ends "
            f"with a point, or a file of points with ends = ['A', 'B']; came {quoted(entry.given)}"
        )
    again = np.flatnonzero((np.diff(places, axis=0) == 0).all(axis=1))
    if len(places) < 2 or len(again):
        raise GridgenError(
            f"the curve {entry.name} needs two different places at least, and no place twice in succession"
            + (f"; places {again[0]} and {again[0] + 1} are equal" if len(again) else "")
        )
    return ends, places


_KINDS: dict[str, tuple[tuple[str, ...], Callable[[_Entry], Drawn]]] = {
    "line": ((), _line),
    "polyline": (("ends",), _polyline),
    "spline": (("ends",), _spline),
    "arc": (("center", "clockwise"), _arc),
    "formula": (("ends",), _formula),
    "section": (("part", "ends"), _section),
}
