"""Outlines: closed curves with four corners, checked, read and written, and the grids inside them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..atomic import write_bytes
from ..errors import GridgenError
from ..geography import Projection
from ..grids.grid import Grid, check_counts
from ..messages import report
from ..outlines import read_content
from .corners import CornerChoice, Corners, automatic_corners
from .outline_checks import (
    are_places,
    checked_corners,
    checked_islands,
    checked_points,
    crossing_text,
    run_backwards,
)
from .outline_places import projected
from .outline_sides import automatic_choice, check_sampling, corner_choice, rolled, sampled_sides
from .polygon import first_crossing, first_repeated, is_clockwise
from .sampling import Sampling
from .side_spacing import SideSpacing, spacings_by_side
from .sides import Sides, grid_of_sides, ring_of_sides, sides_of_ring

#: Nodes of the grid for which an outline's own corners are chosen automatically.
_NOMINAL = 65


@dataclass(frozen=True, slots=True, init=False, eq=False)
class Outline:
    """A closed curve with four corners: a simple polygon that runs counter-clockwise.

    With the corners c0 = 0 < c1 < c2 < c3, bottom is points c0..c1, right c1..c2, top c2..c3 (from right to
    left) and left c3..N, 0 (downwards).

    Attributes:
        points: the vertices, shape (N, 2), read-only; the last is not a copy of the first.
        corners: the indices of the four corners.
        name: what to call it in messages.
        islands: closed curves inside, each (n, 2), read-only: a grid runs across them, for a mask to cover.
        projection: of longitude and latitude onto the plane in which the points are; None for a plane of its own.
    """

    points: Array
    corners: Corners
    name: str
    islands: tuple[Array, ...]
    projection: Projection | None

    def __init__(
        self,
        points: ArrayLike,
        corners: ArrayLike | Literal["auto"],
        name: str = "outline",
        *,
        reorient: bool = True,
        islands: Sequence[ArrayLike] = (),
        projection: Projection | None = None,
    ) -> None:
        """Copy and check an outline.

        Args:
            points: shape (N, 2), N >= 4, finite, no two in succession equal, not crossing itself. Copies of the first
                point at the end, by which many programs mark a closed curve, are left out.
            corners: corners of the outline: four indices in the order of the points; four places (4, 2), to which the
                nearest points are taken, from the first one counter-clockwise; or N marks, 1 where the grid's
                boundary turns to the left, -1 where it turns to the right and 0 elsewhere, with the sum 4, as
                pygridgen's `beta`: of more than four turns to the left four are corners, and the others turn within
                sides, which is reported; or 'auto': the best four for a square of cells, see `choose_corners`. The
                points are rolled so that the first corner comes first. Indices and marks of copies of the first point
                are those of that point.
            name: what to call it in messages.
            reorient: whether a clockwise curve is reversed, from its second corner, which is reported: bottom and top
                stay on their curves, left and right are exchanged. Without it such a curve is refused.
            islands: closed curves inside, each (n, 2), that a mask is to cover.
            projection: by which the points came into their plane, to be found again as an attribute.

        Raises:
            GridgenError: naming the outline, the fault, its position and the repair.
        """
        array, copies = checked_points(points, name)
        automatic, checked = isinstance(corners, str) and corners == "auto", (0, 1, 2, 3)
        if not automatic and are_places(corners) and reorient and is_clockwise(array):
            array = array[::-1]  # Places have no order along the points.
        if not automatic:
            array, checked = rolled(array, checked_corners(corners, array, name, copies))
        crossing = first_crossing(array)
        if crossing is not None:
            raise GridgenError(f"the outline '{name}' crosses or touches itself: {crossing_text(array, crossing)}")
        clockwise = is_clockwise(array)
        if clockwise and not reorient:
            raise GridgenError(f"the outline '{name}' runs clockwise; expected counter-clockwise, or reorient=True")
        if clockwise:
            array, checked = run_backwards(array, checked)
            ways = "" if automatic else " from corner 1: bottom and top stay, left and right are exchanged"
            report(f"the outline '{name}' runs clockwise, and is taken backwards{ways}")
        if automatic:
            array, checked = rolled(array, automatic_corners(array, _NOMINAL, _NOMINAL))
        array.setflags(write=False)
        around = checked_islands(islands, name)
        made = {"points": array, "corners": checked, "name": name, "islands": around, "projection": projection}
        for field, value in made.items():
            object.__setattr__(self, field, value)

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        corners: ArrayLike | Literal["auto"] | None = None,
        reorient: bool = True,
        crs: str | None = None,
    ) -> Outline:
        """Read an outline from a file: a table of points, or another of the formats of `gridgen-sym formats`.

        A text file has comment lines (``# name: NAME`` and ``# corners: c0 c1 c2 c3``; others are ignored), perhaps a
        header with the names of the columns, and one line for each point, with a comma, a semicolon, a tab or blanks
        between x and y. Holes of polygons become islands.

        Args:
            path: the file.
            corners: corners of the outline instead of those of the file, which then need not have any; as for
                `Outline`. Places are in longitude and latitude where the file is, and is projected.
            reorient: as for `Outline`.
            crs: plane onto which longitude and latitude are projected: `auto`, or a system such as `EPSG:32616`; see
                `gridgen_sym.project`. Without it coordinates are those of a plane.

        Raises:
            GridgenError: if the file is missing or malformed (with the line's number), or its curve is no
                outline.
            MissingExtraError: if the package is not installed that reads the format, or projects.
        """
        found = read_content(path)
        chosen = found.corners if corners is None else corners
        if chosen is None:
            raise GridgenError(
                f"cannot read {path}: it has no corners; add a line like '# corners: 0 10 20 30' above its points, "
                "give four points or places (--corners), or let them be chosen with corners='auto' (--corners auto)"
            )
        try:
            projection, points, islands = projected(found, crs)
            if projection is not None and are_places(chosen):
                chosen = projection.to_plane(chosen)
            name = found.name or Path(path).stem
            return cls(points, chosen, name, reorient=reorient, islands=islands, projection=projection)
        except GridgenError as error:
            raise GridgenError(f"cannot use {path}: {error}") from error

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the outline in the format that `read` reads, with 17 significant digits.

        Raises:
            GridgenError: if no file can be written there.
        """
        head = [
            f"# name: {' '.join(self.name.split())}",
            f"# corners: {' '.join(map(str, self.corners))}",
            "x,y",
        ]
        curves = ["\n".join(f"{x:.17g},{y:.17g}" for x, y in curve.tolist()) for curve in (self.points, *self.islands)]
        write_bytes(path, ("\n".join((*head, "\n# island\n".join(curves))) + "\n").encode())

    def choose_corners(
        self,
        ni: int,
        nj: int,
        corners: ArrayLike | Literal["auto"] | None = None,
        sampling: Sampling = "features",
    ) -> CornerChoice:
        """Return the corners of a grid of ni x nj nodes, and their penalty.

        Args:
            ni: nodes along bottom and top.
            nj: nodes along left and right.
            corners: None for those of the outline, of which one at which the boundary nodes make a straight or reflex
                angle (170 degrees or more) is moved to the nearest convex turn; 'auto' for the choice of least
                penalty (see `CornerChoice`), moved likewise; or four indices of points, which are kept.
            sampling: as for `sides`.

        Raises:
            GridgenError: for fewer than 3 nodes, or corners or a sampling that are none of these.
        """
        check_counts(ni, nj)
        check_sampling(sampling)
        if isinstance(corners, str) and corners == "auto":
            return automatic_choice(self.points, self.name, (ni, nj), sampling)
        wanted = self.corners if corners is None else checked_corners(corners, self.points, self.name)
        return corner_choice(self.points, self.name, wanted, (ni, nj), sampling, keep=corners is not None)

    def sides(
        self,
        ni: int,
        nj: int,
        corners: ArrayLike | Literal["auto"] | None = None,
        sampling: Sampling = "features",
        spacing: Mapping[str, SideSpacing] | None = None,
    ) -> tuple[Array, Array, Array, Array]:
        """Sample bottom, top, shape (ni, 2), and left, right, shape (nj, 2).

        They run as the sides of a grid do. Corners are kept bit by bit.

        Args:
            ni: nodes along bottom and top.
            nj: nodes along left and right.
            corners: as for `choose_corners`; a moved corner is reported on standard error.
            sampling: boundary nodes on sharp turns of the outline, or at equal arc lengths. 'features' keeps sharp
                turns as nodes where there are nodes enough, and lets the spacing vary smoothly between them; 'equal'
                takes equal arc lengths of each side's polygon.
            spacing: laws for the boundary nodes of sides, by side, instead of the sampling: `{"left":
                "tanh:first=1e-3"}`; `"LAW:first=LENGTH,last=LENGTH"` with `geometric`, `tanh` or `sinh`,
                `"LAW:at=FRACTION,size=LENGTH"`, `"equal"`, or an array of fractions of the side's length. Sides run as
                those of a grid do.

        Raises:
            GridgenError: as for `choose_corners`, and for a law that cannot be read or has no place on its side.
        """
        sides = self._sides(ni, nj, corners, sampling, spacing)
        return sides.bottom, sides.top, sides.left, sides.right

    def _sides(
        self,
        ni: int,
        nj: int,
        corners: ArrayLike | Literal["auto"] | None,
        sampling: Sampling,
        spacing: Mapping[str, SideSpacing] | None,
    ) -> Sides[Array]:
        """Sample the sides, in the order of the package; a moved corner is reported."""
        choice = self.choose_corners(ni, nj, corners, sampling)
        if choice.message:
            report(choice.message)
        laws = spacings_by_side(spacing or {})
        return sides_of_ring(sampled_sides(self.points, choice.corners, (ni, nj), sampling, laws))

    def grid(
        self,
        ni: int,
        nj: int,
        corners: ArrayLike | Literal["auto"] | None = None,
        sampling: Sampling = "features",
        spacing: Mapping[str, SideSpacing] | None = None,
    ) -> Grid:
        """Return the transfinite grid of ni x nj nodes between the sides that `sides` samples.

        Raises:
            GridgenError: as for `sides`, and when two of the sampled nodes are one point or their polygon crosses
                itself, so that the grid would fold or overlap itself.
        """
        sides = self._sides(ni, nj, corners, sampling, spacing)
        ring = ring_of_sides(sides)
        fault = f"with {ni} x {nj} nodes the sampled boundary of '{self.name}'"
        repeated = first_repeated(ring)
        if repeated is not None:
            raise GridgenError(f"{fault} has two nodes at the point {ring[repeated].tolist()}; take fewer nodes")
        crossing = first_crossing(ring)
        if crossing is not None:
            raise GridgenError(
                f"{fault} crosses itself, so that a grid would fold or overlap itself: {crossing_text(ring, crossing)} "
                "(counted along the sampled boundary); take more nodes"
            )
        return grid_of_sides(sides)

    def __eq__(self, other: object) -> bool:
        """Whether `other` has the same points, corners and islands; names do not matter."""
        if not isinstance(other, Outline):
            return NotImplemented
        mine, theirs = ((one.points, *one.islands) for one in (self, other))
        same = self.corners == other.corners and len(mine) == len(theirs)
        return same and all(map(np.array_equal, mine, theirs))

    def __hash__(self) -> int:
        """Agree with `==`."""
        return hash((self.corners, (self.points + 0.0).tobytes()))
