"""The boundary nodes of a grid on an outline's sides, and the choice of the corners between the sides."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from .corners import STRAIGHT, CornerChoice, Corners, as_corners, corner_penalty, ranked_corners, settled_corners
from .polygon import inner_angles
from .sampling import Sampling, sample
from .side_spacing import SideSpacing, spaced
from .sides import Sides

_FREE: Sides[SideSpacing | None] = Sides(None, None, None, None)


def check_sampling(sampling: str) -> None:
    """Raise a `GridgenError` unless there is such a sampling."""
    if sampling not in ("features", "equal"):
        raise GridgenError(f"sampling must be 'features' or 'equal', but is {quoted(sampling)}")


def rolled(points: Array, corners: Corners) -> tuple[Array, Corners]:
    """Roll a curve so that its first corner comes first."""
    c0, c1, c2, c3 = ((corner - corners[0]) % len(points) for corner in corners)
    return np.roll(points, -corners[0], axis=0), (c0, c1, c2, c3)


def sampled_sides(
    points: Array,
    corners: Corners,
    nodes: tuple[int, int],
    sampling: Sampling,
    spacing: Sides[SideSpacing | None] = _FREE,
) -> list[Array]:
    """Return the ni, nj, ni and nj nodes of bottom, right, top and left, all counter-clockwise.

    A `spacing` is that of a side as grids have it: top and left run the other way.
    """
    line, places = rolled(points, corners)
    closed = np.concatenate((line, line[:1]))
    pieces = [closed[first : last + 1] for first, last in pairwise((*places, len(points)))]
    found = []
    for k, (piece, count, law) in enumerate(zip(pieces, (*nodes, *nodes), spacing, strict=True)):
        if law is None:
            found.append(sample(piece, count, sampling))
        else:
            found.append(spaced(piece, count, law) if k < 2 else spaced(piece[::-1], count, law)[::-1])
    return found


def corner_choice(
    points: Array, name: str, wanted: Corners, nodes: tuple[int, int], sampling: Sampling, *, keep: bool
) -> CornerChoice:
    """Return the corners of a grid with given numbers of nodes, and their penalty.

    Args:
        points: the vertices of the outline.
        name: what to call it in the message.
        wanted: the corners.
        nodes: the numbers of nodes (ni, nj).
        sampling: as for `Outline.sides`.
        keep: whether they are kept; otherwise those at which no valid grid could exist are moved.
    """

    def angles_of(corners: Corners) -> Array:
        return _corner_angles(sampled_sides(points, corners, nodes, sampling))

    chosen, moved = (wanted, ()) if keep else settled_corners(points, wanted, nodes, angles_of)
    before, after = angles_of(wanted), angles_of(chosen)
    a0, a1, a2, a3 = after.tolist()
    penalty = float(corner_penalty(points, np.array([chosen]), *nodes)[0])
    message = "; ".join(
        f"corner {k} of '{name}' is moved from point {wanted[k]}, where the boundary's nodes make an angle of "
        f"{before[k]:.4g} degrees, to point {chosen[k]}, where they make {after[k]:.4g}"
        for k in moved
    )
    message += "; give the corners as indices to keep them where they are" if message else ""
    return CornerChoice(chosen, (a0, a1, a2, a3), penalty, moved, message)


def automatic_choice(points: Array, name: str, nodes: tuple[int, int], sampling: Sampling) -> CornerChoice:
    """Return the corners of least penalty at none of which the boundary nodes make a straight or reflex angle.

    Straight corners are moved; where that does not help, no further choice has a corner there. Where nothing helps, as
    in a triangle, the first choice is returned.
    """
    ranked, first = ranked_corners(points, *nodes), None
    while len(ranked):
        choice = corner_choice(points, name, as_corners(ranked[0]), nodes, sampling, keep=False)
        straight = np.array(choice.angles) >= STRAIGHT
        if not straight.any():
            return choice
        first = first or choice
        ranked = ranked[~np.isin(ranked, ranked[0][straight]).any(axis=1)]
    assert first is not None  # An outline has four points at least.
    return first


def _corner_angles(sides: list[Array]) -> Array:
    """Return the inner angles in degrees between the nodes at the four corners of counter-clockwise sides."""
    before = np.array([sides[k - 1][-2] for k in range(4)])
    return inner_angles(before, np.array([side[0] for side in sides]), np.array([side[1] for side in sides]))
