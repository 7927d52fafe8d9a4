"""Prolongation of sliding nodes to a grid with twice as many cells: their parameters, and the corners of the grid.

At a corner that is no right angle the nodes of a conformal grid are at distances that are a power of their number. No
polynomial follows that, but such a corner is similar to itself: with twice as many cells it is the coarse one, made
smaller.
"""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np

from ...arrays import Array
from .side import SlidingSide

#: So many nodes beside a corner are similar to those of the coarse grid. Farther away polynomials are as good.
_SIMILAR = 4
#: If the exponent differs from 1 by less than this, the corner counts as smooth.
_SMOOTH = 0.1


def finer_parameters(side: SlidingSide, coarse: SlidingSide) -> Array:
    """Return the parameters that a coarser grid's nodes give to those of a side; nodes at corners stay.

    By cubic polynomials where there are twice as many, else by cubic splines through the coarse nodes and the corners;
    by monotone cubics where these overshoot.
    """
    from scipy.interpolate import CubicSpline, PchipInterpolator

    place, known = (np.linspace(0.0, 1.0, len(at)) for at in (side.at, coarse.at))
    found = side.at.copy()
    stay = np.flatnonzero(~side.free)
    for first, last in pairwise(stay):
        if last == first + 1:
            continue
        (a, b), (low, high) = place[[first, last]], side.at[[first, last]]
        inside = (known > a) & (known < b) & (coarse.at > low) & (coarse.at < high)
        x, y = (np.concatenate(([p], of[inside], [q])) for p, of, q in ((a, known, b), (low, coarse.at, high)))
        if last - first == 2 * (len(x) - 1) and len(x) > 3:
            at = _halved(y)
        else:
            at = (CubicSpline if len(x) > 3 else PchipInterpolator)(x, y)(place[first : last + 1])
        if not (np.diff(at) > 0).all():
            at = PchipInterpolator(x, y)(place[first : last + 1])
        found[first + 1 : last] = at[1:-1]
    return found


def shrink_corners(fine: Array, coarse: Array) -> None:
    """Make corners that are not smooth similar to the coarse ones, in place, if there are twice as many cells.

    Args:
        fine: (2, ni, nj).
        coarse: likewise, with fewer nodes.
    """
    if fine.shape[1:] != tuple(2 * count - 1 for count in coarse.shape[1:]):
        return
    for i, j in product((1, -1), (1, -1)):
        near, few = fine[:, ::i, ::j], coarse[:, ::i, ::j]
        z = few[0, : 2 * _SIMILAR + 1, : 2 * _SIMILAR + 1] + 1j * few[1, : 2 * _SIMILAR + 1, : 2 * _SIMILAR + 1]
        ratio = _shrinkage(z.diagonal())
        if ratio is not None:
            z = z[0, 0] + ratio * (z[:_SIMILAR, :_SIMILAR] - z[0, 0])
            near[0, :_SIMILAR, :_SIMILAR], near[1, :_SIMILAR, :_SIMILAR] = z.real, z.imag


def _halved(coarse: Array) -> Array:
    """Return parameters (2 n - 1,) between and at coarse ones (n,); ends that are not smooth are similar to theirs."""
    fine = np.empty(2 * len(coarse) - 1)
    fine[::2] = coarse
    fine[3:-3:2] = (9 * (coarse[1:-2] + coarse[2:-1]) - coarse[:-3] - coarse[3:]) / 16
    for way in (1, -1):
        near, end = coarse[::way], fine[::way]
        end[1] = (5 * near[0] + 15 * near[1] - 5 * near[2] + near[3]) / 16
        ratio = _shrinkage(near)
        if ratio is not None:
            end[:_SIMILAR] = near[0] + ratio * (near[:_SIMILAR] - near[0])
    return fine


def _shrinkage(line: Array) -> float | complex | None:
    """Return by what to shrink the beginning of a line (n,), real or complex; None where it is short, or smooth."""
    if len(line) <= 2 * _SIMILAR:
        return None
    ratio = (line[_SIMILAR // 2] - line[0]) / (line[_SIMILAR] - line[0])
    return ratio if abs(np.log2(abs(ratio)) + 1.0) > _SMOOTH else None
