"""Where the nodes of a boundary are on a curve that a user gives for them, checked."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array
from ...boundary.slide_curve import SlideCurve, chord_fractions, sharp_turns, slide_curve
from ...errors import GridgenError

#: Ends of nodes must be so near to the ends of a curve, and nodes to it, over the extent of the grid.
_NEAR_END, _NEAR = 1e-6, 0.05
#: Nodes so near to a curve, over the extent, are where they were looked for.
_ON = 1e-9
#: The same but for rounding.
_ROUNDING = 1e-14


def placed(what: str, curve: SlideCurve, nodes: Array, extent: float) -> tuple[SlideCurve, Array]:
    """Return a curve in the direction of nodes (n, 2), and their parameters; it may be given either way.

    Args:
        what: the nodes are, for messages.
        curve: with two ends, which the first and the last node are at.
        nodes: of the boundary.
        extent: of the grid.

    Raises:
        GridgenError: for a curve that does not belong to the nodes.
    """
    at = chord_fractions(nodes)
    if np.abs(curve.point(at) - nodes).max() > _ROUNDING * extent:  # It is not the curve of these nodes themselves.
        at = curve.nearest(nodes, at)
    if np.abs(curve.point(at) - nodes).max() > _ON * extent:
        at = curve.nearest(nodes)
    ends = curve.point(np.array([0.0, 1.0]))
    ahead, back = (np.abs(two - nodes[[0, -1]]).max() for two in (ends, ends[::-1]))
    if min(ahead, back) > _NEAR_END * extent:
        raise GridgenError(
            f"the curve of {what} must begin and end at the corners of the grid; an end is {min(ahead, back):.3g} "
            "away: move the corners of the start onto it, or extend or cut the curve"
        )
    # Of a closed curve both ends are the same point: its inner nodes show the direction.
    if back < ahead or (back == ahead and np.diff(at[1:-1]).sum() < 0):
        curve, at = curve.reversed(), 1.0 - at
    at[0], at[-1] = 0.0, 1.0
    _check(what, curve, at, nodes, extent)
    return curve, at


def placed_round(what: str, given: Any, nodes: Array, extent: float) -> tuple[SlideCurve, Array]:  # noqa: ANN401
    """Return the same for nodes round a closed boundary, of which the last is the first again, a turn later."""
    curve = slide_curve(given)
    (begin, end), slopes = curve.point(np.array([0.0, 1.0])), curve.first(np.array([0.0, 1.0]))
    if np.abs(end - begin).max() > _NEAR_END * extent:
        raise GridgenError(
            f"the curve of {what} must end where it begins, because this boundary is closed; its ends are "
            f"{np.hypot(*(end - begin)):.3g} apart"
        )
    if len(curve.corners) > 2 or sharp_turns(np.cumsum([0 * begin, *slopes[::-1]], axis=0)).any():
        raise GridgenError(
            f"the curve of {what} must be smooth all round, because this boundary is closed and no node of it stays: "
            "give curves that end at its sharp turns, by block and side"
        )
    if not callable(given) and not isinstance(given, SlideCurve):
        curve = SlideCurve.round_points(np.asarray(given, dtype=float))
    curve = curve if curve.closed else curve.as_closed()
    at = np.unwrap(curve.nearest(nodes), period=1.0)
    if at[-1] < at[0]:
        curve, at = curve.reversed(), 1.0 - at
    _check(what, curve, at, nodes, extent)
    return curve, at


def _check(what: str, curve: SlideCurve, at: Array, nodes: Array, extent: float) -> None:
    """Refuse nodes that are far from their curve, or do not follow each other along it."""
    away = float(np.hypot(*(curve.point(at) - nodes).T).max())
    if away > _NEAR * extent:
        raise GridgenError(
            f"the nodes of {what} must lie on its curve; one is {away:.3g} away: sample the side on the curve"
        )
    wrong = np.flatnonzero(~(np.diff(at) > 0))
    if len(wrong):
        k = int(wrong[0])
        raise GridgenError(
            f"the nodes of {what} must follow each other along its curve; nodes {k} and {k + 1} are at {at[k]:.6g} and "
            f"{at[k + 1]:.6g} of it: sample the side on the curve"
        )
