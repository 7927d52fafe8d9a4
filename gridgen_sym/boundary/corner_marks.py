"""Corners by marks: a number for each point that says how the grid's boundary turns there, as gridgen-c has it."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import GridgenError
from ..messages import report
from .corners import corner_penalty
from .polygon import is_clockwise

#: So many turns to the left have 10 626 choices of four corners.
_MOST_TURNS = 24
#: Nodes of the grid for which the corners are chosen.
_NOMINAL = 65


def corners_of_marks(marks: Array, points: Array, name: str) -> Array:
    """Return the indices of the four corners that marks mean.

    A mark is 1 where the grid's boundary turns to the left (counter-clockwise), -1 where it turns to the right, and 0
    where it does not turn; their sum is 4 (`beta` of pygridgen, the third column of gridgen-c and SeaGrid). Of more
    than four turns to the left four become corners, such that the turns within each side add up to 0: a side with
    several turns. Of several such choices the one of least penalty is taken and reported (see `CornerChoice`).

    Args:
        marks: of the points, and after them of copies of the first one at the end, which are marks of that.
        points: the vertices (N, 2) without copies.
        name: of the outline, for messages.

    Raises:
        GridgenError: if their sum is not 4, or more than 24 turn to the left.
    """
    merged, twice = _merged(marks, len(points))
    left, right = (np.flatnonzero(merged == sign) for sign in (1, -1))
    if merged.sum() != 4 or len(left) - len(right) != 4 or twice is None:
        also = "; the last point is the first one again, so that their marks are one corner" if twice else ""
        raise GridgenError(
            f"a grid of the outline '{name}' has four corners, marked by 1, at which it turns to the left, and sides "
            f"whose turns, marked by 1 and -1, add up to 0: the sum of the marks is 4; but the marks hold "
            f"{int((merged == 1).sum())} times 1 and {int((marks == -1).sum())} times -1{also}"
        )
    if not len(right):
        return left.astype(float)
    if len(left) > _MOST_TURNS:
        raise GridgenError(
            f"the outline '{name}' is marked with {len(left)} turns to the left, and at most {_MOST_TURNS} can be: "
            "give the four corners as indices, or let them be chosen with 'auto'"
        )
    chosen = _best_choice(merged, points, left)
    report(
        f"the outline '{name}' is marked with {len(left)} turns to the left and {len(right)} to the right: its corners "
        f"are at points {', '.join(map(str, chosen))}, and the other turns are within sides"
    )
    return chosen.astype(float)


def are_marks(values: Array, count: int) -> bool:
    """Return whether numbers, one for each of `count` points and its copies, are marks of turns."""
    return values.shape == (count,) and bool(np.isin(values, (-1, 0, 1)).all())


def refuse_fractions(values: Array, count: int, name: str) -> None:
    """Refuse marks of turns by other than right angles, which gridgen-c has for triangles and other polygons."""
    if values.shape == (count,) and count > 4 and abs(values.sum() - 4) < 1e-6 and (np.abs(values) < 4).all():
        turned = values[values != 0]
        raise GridgenError(
            f"the marks of the outline '{name}' are turns of {turned[:4].round(4).tolist()} right angles: one block of "
            "quadrilaterals has four corners of one right angle each; give these, or 'auto' (--corners auto)"
        )


def _merged(marks: Array, count: int) -> tuple[Array, bool | None]:
    """Return marks without those of copies of point 0, and whether both mark it; None if they contradict each other."""
    merged, copied = marks[:count].copy(), marks[count:]
    given = {float(mark) for mark in copied if mark != 0}
    if len(given | ({float(merged[0])} - {0.0})) > 1:
        return merged, None
    both = bool(given) and merged[0] != 0
    if given:
        merged[0] = given.pop()
    return merged, both


def _best_choice(marks: Array, points: Array, left: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the four turns to the left, between which the other turns add up to 0, that have the least penalty."""
    choices = np.array(list(combinations(left.tolist(), 4)))
    before = np.cumsum(marks)[choices]  # A corner's own mark included: from one to the next the sum rises by 1.
    fit = choices[(np.diff(before, axis=1) == 1).all(axis=1)]
    if is_clockwise(points):
        penalty = corner_penalty(points[::-1], (len(points) - 1 - fit)[:, ::-1], _NOMINAL, _NOMINAL)
    else:
        penalty = corner_penalty(points, fit, _NOMINAL, _NOMINAL)
    return np.asarray(fit[int(np.argmin(penalty))])
