"""What a file says of an outline, before any check: its curve, and what else the format can hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class OutlineContent:
    """The content of an outline's file.

    Attributes:
        points: the vertices of the outer curve, (N, 2); the last may repeat the first.
        name: of the outline; empty if the file has none.
        corners: four indices of points, or a mark for each point, as `Outline` takes them; None if the file has none.
        islands: the vertices of closed curves inside, each (n, 2): holes of a polygon.
        geographic: whether x and y are longitude and latitude in degrees; None where the file does not say.
    """

    points: Array
    name: str = ""
    corners: Sequence[float] | None = None
    islands: tuple[Array, ...] = ()
    geographic: bool | None = None
