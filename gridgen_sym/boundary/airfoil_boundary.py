"""What a user may say of a C- or an O-grid's boundary: sections, cells and lengths in chords, checked."""

from __future__ import annotations

import os
from typing import get_args

import numpy as np
import numpy.typing as npt

from ..errors import GridgenError, quoted
from .airfoil_section import AirfoilSection
from .airfoil_sides import AirfoilSides, Kind, airfoil_sides

#: The cells at the leading and the trailing edge are shorter than the mean one by these factors.
_LEADING, _TRAILING = 8.0, 6.0
#: Cells on each half of a blunt trailing edge.
_EDGE = 4


def airfoil_boundary(
    section: str | os.PathLike[str] | AirfoilSection | npt.ArrayLike,
    kind: Kind,
    *,
    first: float,
    far: float,
    cells: tuple[int, int],
    wake: int,
    leading: float | None = None,
    trailing: float | None = None,
    blunt: bool = False,
) -> AirfoilSides:
    """Return the boundary of a C- or an O-grid round a section.

    Args:
        section: a NACA number of four or five digits (`naca2412`), the path of a `.dat` file in Selig's form, or points
            (n, 2) from the trailing edge around to it.
        kind: `C`, with a cut along the wake, or `O`.
        first: height of the first cells at the airfoil, in the unit of the section; positive.
        far: distance of the outer boundary from the airfoil, in chords.
        cells: their even number on the airfoil, and the number from it outwards.
        wake: the number of cells along the wake of a C-grid.
        leading: length of the cells at the leading edge, in chords; by default an eighth of the mean one.
        trailing: the same at the trailing edge; by default a sixth.
        blunt: whether a section of a NACA number has the published thickness of its trailing edge.

    Raises:
        GridgenError: for a file that is no section, or numbers that have no place.
    """
    if kind not in get_args(Kind):
        raise GridgenError(f"kind of an airfoil's grid must be 'C' or 'O'; came {quoted(kind)}")
    around, outwards = _counts(cells)
    if not isinstance(wake, int) or wake < 3:
        raise GridgenError(f"wake must be at least 3 cells; came {quoted(wake)}")
    shape = AirfoilSection.of(section, blunt=blunt)
    chord = shape.chord
    if not 1 < far < np.inf:
        raise GridgenError(f"far must be more than 1 chord; came {quoted(far)}")
    if not 0 < float(first) < chord / outwards:
        raise GridgenError(
            f"first must be less than a chord over the {outwards} cells outwards, and positive; came {quoted(first)}"
        )
    mean = 2 / around
    return airfoil_sides(
        shape,
        kind,
        cells=(around, outwards),
        wake=wake,
        edge=_EDGE,
        first=float(first),
        far=far * chord,
        leading=chord * _part(leading, mean / _LEADING, mean, "leading"),
        trailing=chord * _part(trailing, mean / _TRAILING, mean, "trailing"),
    )


def _counts(cells: object) -> tuple[int, int]:
    if (
        isinstance(cells, tuple)
        and len(cells) == 2
        and all(isinstance(count, int) for count in cells)
        and cells[0] >= 16
        and cells[0] % 2 == 0
        and cells[1] >= 4
    ):
        return cells
    raise GridgenError(
        f"cells must be two numbers: an even one of at least 16 on the airfoil, and at least 4 outwards; came "
        f"{quoted(cells)}"
    )


def _part(given: float | None, default: float, mean: float, name: str) -> float:
    if given is None:
        return default
    if not 0 < given < mean:
        raise GridgenError(f"{name} must be between 0 and the mean length of cells, {mean:.3g} chords; came {given}")
    return given
