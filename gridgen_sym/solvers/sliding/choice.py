"""From what a user says of sliding sides to the sliding nodes of a grid, checked."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...arrays import Array
from ...boundary.sides import Sides
from ...boundary.slide_curve import SlideCurve, chord_fractions, slide_curve
from ...errors import GridgenError, quoted
from ...grids import Grid
from .side import SlidingSide, side_index
from .slide import Slide

#: Corners must be so near to the ends of a curve, and nodes to it, over the extent of the grid.
_NEAR_END, _NEAR = 1e-6, 0.05
#: Nodes so near to a curve, over the extent, are where they were looked for.
_ON = 1e-9


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
    extent = float(np.ptp(grid.xy.reshape(-1, 2), axis=0).max())
    for name, given in _curves(slide).items():
        index = side_index(name, grid.shape)
        nodes = grid.xy[index]
        if given is None:
            curve, at = SlideCurve.of_points(nodes), chord_fractions(nodes)
        else:
            curve, at = _placed(name, slide_curve(given), nodes, extent)
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


def _placed(name: str, curve: SlideCurve, nodes: Array, extent: float) -> tuple[SlideCurve, Array]:
    """Return a curve in the direction of the nodes of a side, and their parameters; it may be given either way."""
    at = curve.nearest(nodes, chord_fractions(nodes))
    if np.abs(curve.point(at) - nodes).max() > _ON * extent:
        at = curve.nearest(nodes)
    ends = curve.point(np.array([0.0, 1.0]))
    ahead, back = (np.abs(two - nodes[[0, -1]]).max() for two in (ends, ends[::-1]))
    if min(ahead, back) > _NEAR_END * extent:
        raise GridgenError(
            f"the curve of the side {name} must begin and end at the corners of the grid; an end is "
            f"{min(ahead, back):.3g} away: move the corners of the start onto it, or extend or cut the curve"
        )
    away = float(np.hypot(*(curve.point(at) - nodes).T).max())
    if away > _NEAR * extent:
        raise GridgenError(
            f"the nodes of the side {name} must lie on its curve; one is {away:.3g} away: sample the side on the curve"
        )
    # Of a closed curve both ends are the same point: its inner nodes show the direction.
    if back < ahead or (back == ahead and np.diff(at[1:-1]).sum() < 0):
        curve, at = curve.reversed(), 1.0 - at
    at[0], at[-1] = 0.0, 1.0
    wrong = np.flatnonzero(~(np.diff(at) > 0))
    if len(wrong):
        k = int(wrong[0])
        raise GridgenError(
            f"the nodes of the side {name} must follow each other along its curve; nodes {k} and {k + 1} are at "
            f"{at[k]:.6g} and {at[k + 1]:.6g} of it: sample the side on the curve"
        )
    return curve, at
