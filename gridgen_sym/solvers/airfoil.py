"""C- and O-grids around airfoils: the boundary, a transfinite start, and Newton's method with a wall."""

from __future__ import annotations

import os

import numpy.typing as npt

from ..boundary.airfoil_boundary import airfoil_boundary
from ..boundary.airfoil_section import AirfoilSection
from ..boundary.airfoil_sides import Kind
from ..boundary.wall import Wall
from ..grids import transfinite
from .optimize import optimize
from .run.progress import Callback
from .run.result import Result


def airfoil_grid(
    section: str | os.PathLike[str] | AirfoilSection | npt.ArrayLike,
    kind: Kind = "C",
    *,
    first: float = 1e-5,
    growth: float | None = None,
    far: float = 20.0,
    cells: tuple[int, int] = (96, 64),
    wake: int = 40,
    leading: float | None = None,
    trailing: float | None = None,
    blunt: bool = False,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> Result:
    """Make a C- or an O-grid around an airfoil, with first cells of a given height and right angles at its wall.

    The airfoil is a part of the bottom of the block, all of it in an O-grid. Lines along xi run from the lower side of
    the cut over the leading edge to its upper side; nodes on both sides of the cut have the same places.

    Args:
        section: a NACA number of four or five digits (`naca2412`), the path of a `.dat` file in Selig's form, or points
            (n, 2) from the trailing edge around to it. Its coordinates stay; the flow comes along x.
        kind: type of the grid: `C`, with a cut along the wake, or `O`.
        first: height of the first cells at the airfoil, in the unit of the section; see `first_height`.
        growth: factor from one height to the next; by default the one that reaches the outer boundary.
        far: distance of the outer boundary from the airfoil, in chords.
        cells: numbers of cells on the airfoil, which is even, and outwards.
        wake: number of cells along the wake of a C-grid.
        leading: length of the cells at the leading edge, in chords; by default an eighth of the mean one.
        trailing: length of the cells at the trailing edge, in chords; by default a sixth of the mean one.
        blunt: whether a section of a NACA number has the published thickness of its trailing edge; else it is sharp.
            That of a file is what its ends make it. Four more cells lie on each half of a blunt edge.
        callback: as of `optimize`, as are the next ones.
        time_limit: as in `optimize`.
        progress: show progress.
        backend: `c`, `numpy`, or one that is installed.

    Returns:
        The result; `result.quality.sides["bottom"]` has heights and angles, at the nodes of the cut too.

    Raises:
        GridgenError: for a file that is no section, or numbers that have no place.
    """
    Wall(first, growth)  # Refuses what is no height or no factor.
    boundary = airfoil_boundary(
        section,
        kind,
        first=first,
        far=far,
        cells=cells,
        wake=wake,
        leading=leading,
        trailing=trailing,
        blunt=blunt,
    )
    bottom, right, top, left = boundary.sides
    wall = Wall(first, growth, nodes=boundary.wall)
    return optimize(
        transfinite(bottom, top, left, right),
        "winslow",
        walls={"bottom": wall},
        callback=callback,
        time_limit=time_limit,
        progress=progress,
        backend=backend,
    )
