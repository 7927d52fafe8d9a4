"""From what a user says of sliding sides to the sliding nodes of a grid, checked."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...boundary.sides import Sides
from ...boundary.slide_curve import SlideCurve, chord_fractions, slide_curve
from ...errors import GridgenError, quoted
from ...grids import Grid
from .placing import placed
from .side import SlidingSide, side_index
from .slide import Slide


def make_slide(grid: Grid, slide: object) -> Slide:
    """Return the sliding nodes of a grid.

    Args:
        grid: whose boundary nodes begin where they are.
        slide: `"all"`, the name of a side, several names, or a mapping from sides to curves (None for that of the
            side's own nodes: splines between sharp turns, whose nodes stay).

    Raises:
        GridgenError: for an unknown side, or a curve that does not belong to its side.
    """
    sides = []
    extent = float(np.ptp(grid.planes.reshape(2, -1), axis=1).max())
    for name, given in _curves(slide).items():
        index = side_index(name, grid.shape)
        nodes = grid.xy[index]
        if given is None:
            curve, at = SlideCurve.of_points(nodes), chord_fractions(nodes)
        else:
            curve, at = placed(f"the side {name}", slide_curve(given), nodes, extent)
        sides.append(SlidingSide(name, index, curve, at))
    return Slide(sides, grid.shape)


def slide_curves(grid: Grid, slide: object) -> dict[str, SlideCurve]:
    """Return the curves of the sliding sides, by side; see `make_slide`."""
    return {
        name: SlideCurve.of_points(grid.xy[side_index(name, grid.shape)]) if given is None else slide_curve(given)
        for name, given in _curves(slide).items()
    }


def _curves(slide: object) -> dict[str, object]:
    """Return what was said of the curve of every sliding side."""
    if slide == "all":
        return dict.fromkeys(Sides._fields)
    if isinstance(slide, str):
        slide = (slide,)
    if not isinstance(slide, (Mapping, tuple, list, set, frozenset)):
        raise GridgenError(f"slide must be 'all', sides, or a mapping from sides to curves; came {quoted(slide)}")
    for side in slide:
        if side not in Sides._fields:
            raise GridgenError(
                f"unknown side {quoted(side)} in slide: the sides are {', '.join(Sides._fields)}, or 'all'"
            )
    return dict(slide) if isinstance(slide, Mapping) else dict.fromkeys(slide)
