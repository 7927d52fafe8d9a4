"""From curves of a drawing or a map to one outline with islands."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..atomic import shown
from ..errors import GridgenError
from ..messages import report
from .content import OutlineContent

#: Ends of curves that are so near are one point, in parts of the drawing's extent.
_SNAP = 1e-6
#: So many curves without an end in common are a picture, no outline.
_MOST = 100_000
#: Products of larger coordinates overflow.
_LARGEST = 1e150


def outline_of_loops(
    loops: Sequence[Array], path: Path, name: str = "", geographic: bool | None = None
) -> OutlineContent:
    """Return the closed curve that encloses the largest area as an outline, and those inside it as its islands.

    Others are left out, which is reported.

    Raises:
        GridgenError: if there is no closed curve.
    """
    _check_finite(loops)
    areas = [_area(loop) for loop in loops]
    if not loops or not max(areas) > 0:
        raise GridgenError("it has no closed curve with an area; an outline is a closed curve")
    outer = loops[int(np.argmax(areas))]
    others = [loop for loop in loops if loop is not outer]
    islands = tuple(loop for loop in others if contains(outer, loop[0]))
    if len(islands) < len(others):
        left = len(others) - len(islands)
        report(f"{shown(path)}: the largest of {left + 1} separate curves is the outline; {left} left out")
    return OutlineContent(outer, name, None, islands, geographic)


def outline_of_polygons(
    polygons: Sequence[Sequence[Array]], path: Path, name: str = "", geographic: bool | None = None
) -> OutlineContent:
    """Return the polygon with the largest area as an outline, with its holes as islands; others are reported.

    A polygon is its outer curve, followed by its holes.

    Raises:
        GridgenError: if there is no polygon.
    """
    rings = [polygon for polygon in polygons if len(polygon) and len(polygon[0])]
    _check_finite([ring for polygon in rings for ring in polygon])
    if not rings:
        raise GridgenError("it has no polygon; expected a Polygon or a MultiPolygon")
    outer, *holes = max(rings, key=lambda polygon: _area(polygon[0]))
    if len(rings) > 1:
        report(f"{shown(path)}: the largest of {len(rings)} polygons is the outline; {len(rings) - 1} left out")
    return OutlineContent(outer, name, None, tuple(holes), geographic)


def joined(curves: Sequence[Array]) -> list[Array]:
    """Return the closed curves (n, 2) that curves make when those with a common end are joined.

    Raises:
        GridgenError: for a curve that is not closed, or an end at which more than two meet, with the place.
    """
    curves = [curve for curve in curves if len(curve) > 1]
    if not curves:
        return []
    if len(curves) > _MOST:
        raise GridgenError(f"it has {len(curves)} curves; an outline has at most {_MOST}: leave out what is not needed")
    _check_finite(curves)
    extent = float(np.ptp(np.concatenate(curves), axis=0).max())
    ends = _Ends(curves, _SNAP * extent)
    loops, used = [], [False] * len(curves)
    for first, curve in enumerate(curves):
        if used[first]:
            continue
        used[first] = True
        parts, here = [curve], (first, 1)
        while not ends.same(here, (first, 0)):
            other, side = ends.partner(here, used)
            used[other] = True
            part = curves[other] if side == 0 else curves[other][::-1]
            parts.append(part[1:])
            here = (other, 1 - side)
        loops.append(np.concatenate(parts)[:-1])
    return [loop for loop in loops if len(loop) > 2]


class _Ends:
    """The ends of curves, each (index of the curve, 0 or 1), found by where they are."""

    def __init__(self, curves: Sequence[Array], reach: float) -> None:
        self._places = [np.stack((curve[0], curve[-1])) for curve in curves]
        self._reach = reach or 1.0
        self._near: defaultdict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
        for k, places in enumerate(self._places):
            for side in range(2):
                self._near[self._key(places[side])].append((k, side))

    def _key(self, place: Array) -> tuple[int, int]:
        x, y = (int(value) for value in np.floor(place / self._reach))
        return x, y

    def same(self, one: tuple[int, int], other: tuple[int, int]) -> bool:
        """Whether two ends are at one place."""
        gap = self._places[one[0]][one[1]] - self._places[other[0]][other[1]]
        return bool(np.abs(gap).max() <= self._reach)

    def partner(self, end: tuple[int, int], used: list[bool]) -> tuple[int, int]:
        """Return the one end of another curve at the place of an end."""
        place = self._places[end[0]][end[1]]
        x, y = self._key(place)
        near = (one for dx, dy in product((-1, 0, 1), repeat=2) for one in self._near.get((x + dx, y + dy), ()))
        found = [one for one in near if not used[one[0]] and self.same(end, one)]
        if len(found) != 1:
            what = "a curve ends" if not found else f"{len(found) + 1} curves meet"
            raise GridgenError(
                f"{what} at ({place[0]:.6g}, {place[1]:.6g}); expected closed curves: close it, or leave out what does "
                "not belong to the outline"
            )
        return found[0]


def contains(curve: Array, place: Array) -> bool:
    """Return whether a place lies within a closed curve (n, 2), by the parity of the crossings of a ray."""
    (x, y), (next_x, next_y) = curve.T, np.roll(curve, -1, axis=0).T
    spans = (y > place[1]) != (next_y > place[1])
    at = x[spans] + (place[1] - y[spans]) * (next_x[spans] - x[spans]) / (next_y[spans] - y[spans])
    return bool((at > place[0]).sum() % 2)


def _check_finite(curves: Sequence[Array]) -> None:
    """Refuse coordinates that are no numbers, or whose products overflow."""
    for curve in curves:
        bad = ~(np.abs(curve) <= _LARGEST).all(axis=1)
        if bad.any():
            raise GridgenError(
                f"the point {curve[bad][0].tolist()} is not finite, or farther than {_LARGEST:g} from 0, where areas "
                "overflow"
            )


def _area(curve: Array) -> float:
    x, y = (curve - curve[0]).T
    return abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))) / 2
