"""Algebraic grids with walls, and the control functions that hold a grid as it is.

J. F. Thompson, Z. U. A. Warsi and C. W. Mastin, Numerical Grid Generation (1985), chapter VI, begin an elliptic grid
with walls so: the equations, solved for P and Q at every node of an algebraic grid, are met by that grid.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...fields.wall_cells import WallCells
from .control import thomas_middlecoff
from .residual import Equations


def law_grid(planes: Array, cells: WallCells) -> Array:
    """Return the transfinite grid whose lines have their nodes where the walls' laws place them, (2, ni, nj).

    The sides that meet a wall are taken at the fractions of the law, too, so that thin cells are not skewed by them;
    their own nodes are put back in the end.

    Args:
        planes: (2, ni, nj), of which the boundary is used.
        cells: what walls ask for there.
    """
    _, ni, nj = planes.shape
    eta = np.broadcast_to(np.linspace(0, 1, nj), (ni, nj)) if cells.eta is None else cells.eta
    xi = np.broadcast_to(np.linspace(0, 1, ni)[:, None], (ni, nj)) if cells.xi is None else cells.xi
    left, right = (_sampled(planes[:, i], cells.eta, planes[:, i, None]) for i in (0, -1))
    bottom, top = (_sampled(planes[:, :, j], cells.xi, planes[:, :, j, None]) for j in (0, -1))
    corners = [planes[:, i, j, None, None] for i in (0, -1) for j in (0, -1)]
    found = (1 - eta) * (bottom - (1 - xi) * corners[0] - xi * corners[2])
    found += eta * (top - (1 - xi) * corners[1] - xi * corners[3])
    found += (1 - xi) * left + xi * right
    for side in (np.s_[:, 0], np.s_[:, -1], np.s_[:, :, 0], np.s_[:, :, -1]):
        found[side] = planes[side]
    return np.ascontiguousarray(found)


def holding_controls(equations: Equations, coordinates: Array) -> Array:
    """Return P and Q with which a valid grid solves the equations, (2, ni, nj); at the boundary, those beside it.

    The residual is linear in P and Q: at every node its two components give both.
    """
    rest = equations.residual_with(coordinates, (0.0, 0.0))
    by_p, by_q = (equations.residual_with(coordinates, one) - rest for one in ((1.0, 0.0), (0.0, 1.0)))
    inside = np.s_[:, 1:-1, 1:-1]
    (a, c), (b, d), (e, f) = by_p[inside], by_q[inside], rest[inside]
    return np.pad(np.stack([b * f - d * e, c * e - a * f]) / (a * d - b * c), ((0, 0), (1, 1), (1, 1)), mode="edge")


def law_controls(planes: Array, eta: Array | None, xi: Array | None, steps: tuple[float, float]) -> Array:
    """Return P and Q of lines whose nodes are at fractions of their lengths, (2, ni, nj).

    Q = -s''/s' of the fraction s along eta, by central differences, P = -s''/s' along xi; without fractions those of
    Thomas and Middlecoff, from the boundary nodes.

    Args:
        planes: (2, ni, nj), of which the boundary is used.
        eta: (ni, nj), the fractions along eta, or None.
        xi: the same along xi.
        steps: of the logical coordinates.
    """
    found = thomas_middlecoff(planes, steps)
    if eta is not None:
        found[1] = _of_fractions(eta, steps[1])
    if xi is not None:
        found[0] = _of_fractions(xi.T, steps[0]).T
    return found


def line_fractions(planes: Array) -> Array:
    """Return what part of its length every line along eta has behind its nodes, (ni, nj)."""
    lengths = np.hypot(*np.diff(planes, axis=2))
    ends = np.concatenate((np.zeros((len(lengths), 1)), np.cumsum(lengths, axis=1)), axis=1)
    return np.asarray(ends / ends[:, -1:])


def smoothed(planes: Array, sweeps: int) -> Array:
    """Return planes (2, ni, nj) whose values were so often replaced by means with their neighbors."""
    for _ in range(sweeps):
        middle = planes[:, 1:-1, 1:-1]
        across = planes[:, 2:, 1:-1] + planes[:, :-2, 1:-1] + planes[:, 1:-1, 2:] + planes[:, 1:-1, :-2]
        planes = np.pad(middle / 2 + across / 8, ((0, 0), (1, 1), (1, 1)), mode="edge")
    return planes


def _sampled(side: Array, fractions: Array | None, nodes: Array) -> Array:
    """Return the points of a side (2, n) at fractions (ni, nj) of its length; without these, its nodes as given."""
    if fractions is None:
        return nodes
    own = line_fractions(side[:, None])[0]
    return np.stack([np.interp(fractions, own, component) for component in side])


def _of_fractions(fractions: Array, step: float) -> Array:
    """Return -s''/s' along the last axis; at the ends, that beside them."""
    lengths = np.diff(fractions, axis=1)
    after, before = lengths[:, 1:], lengths[:, :-1]
    return np.pad(-2 / step * (after - before) / (after + before), ((0, 0), (1, 1)), mode="edge")
