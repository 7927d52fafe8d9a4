"""A posteriori error indicators from nodal values that a solver has computed on a structured grid."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..grids import Grid
from .equidistribution import cell_areas, cell_means
from .recovery import from_inside, nodal_values, recover_gradient

_GAUSS = (0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12))


def recovery_error(grid: Grid, values: npt.ArrayLike) -> Array:
    """Return the indicator of Zienkiewicz and Zhu (1987) per cell, (ni-1, nj-1).

    It is the norm ||G u - grad u_h|| over the cell, in L2: G u the recovered gradient, interpolated bilinearly, and
    u_h the bilinear interpolant of the values. The root of the sum of its squares estimates the error of the gradient.

    Raises:
        GridgenError: as for `recover_gradient`.
    """
    return recovery_indicator(grid, nodal_values(grid, values), recover_gradient(grid, values))


def recovery_indicator(grid: Grid, values: Array, recovered: Array) -> Array:
    """Return the same for values that are checked, with their recovered gradient (2, ni, nj)."""
    nodes = np.concatenate((grid.planes, values[np.newaxis], recovered))
    corners = nodes[:, :-1, :-1], nodes[:, 1:, :-1], nodes[:, 1:, 1:], nodes[:, :-1, 1:]
    total = np.zeros((grid.shape[0] - 1, grid.shape[1] - 1))
    for p in _GAUSS:
        for q in _GAUSS:
            shapes = (1 - p) * (1 - q), p * (1 - q), p * q, (1 - p) * q
            g = sum(shape * corner[3:] for shape, corner in zip(shapes, corners, strict=True))
            x_xi, y_xi, u_xi = ((1 - q) * (corners[1] - corners[0]) + q * (corners[2] - corners[3]))[:3]
            x_eta, y_eta, u_eta = ((1 - p) * (corners[3] - corners[0]) + p * (corners[2] - corners[1]))[:3]
            J = x_xi * y_eta - x_eta * y_xi
            difference = g - np.stack((u_xi * y_eta - u_eta * y_xi, u_eta * x_xi - u_xi * x_eta)) / J
            total += (difference**2).sum(axis=0) * J / 4
    return np.sqrt(total)


def hierarchical_error(grid: Grid, values: npt.ArrayLike) -> Array:
    """Return the hierarchical indicator per cell, (ni-1, nj-1): the L2 norm of the error of bilinear interpolation.

    The grid of every second node is compared with the grid itself: at a node between two neighbors, the value minus
    that of the line between them (on a curved line, minus the recovered gradient times the node's offset from its
    middle) is the hierarchical surplus, -g1·H g1/2 along xi, H the Hessian of the solution. The error within a cell is
    then (a xi(1-xi) + b eta(1-eta))/2 with a = -g1·H g1, b = -g2·H g2 (R. E. Bank and R. K. Smith, "A posteriori error
    estimates based on hierarchical bases", 1993, on structured grids).

    Raises:
        GridgenError: as for `recover_gradient`.
    """
    return hierarchical_indicator(grid, nodal_values(grid, values), recover_gradient(grid, values))


def hierarchical_indicator(grid: Grid, values: Array, gradient: Array) -> Array:
    """Return the same for values that are checked, with their recovered gradient (2, ni, nj)."""
    fields = np.concatenate((values[np.newaxis], grid.planes))
    curvatures = []
    for axis in (1, 2):
        second = from_inside(_second_difference(fields, axis), axis)
        bend = second[0] - gradient[0] * second[1] - gradient[1] * second[2]
        curvatures.append(cell_means(bend))
    a, b = curvatures
    # The integrals of (xi(1-xi))² and of xi(1-xi) eta(1-eta) over the unit square are 1/30 and 1/36.
    return np.asarray(np.sqrt(cell_areas(grid) * ((a**2 + b**2) / 120 + a * b / 72)))


def richardson_error(grid: Grid, values: npt.ArrayLike, coarse_values: npt.ArrayLike, *, order: float = 2.0) -> Array:
    """Return Richardson's estimate of the error at the nodes, (ni, nj), from solutions on two grids.

    At the nodes of both grids it is (u_2h - u_h)/(2^p - 1) (L. F. Richardson 1911), p the order of the solver; it is
    interpolated in the logical coordinates to the nodes between. The sign is that of u_h minus the solution.

    Args:
        grid: the fine grid, with odd numbers of nodes.
        values: (ni, nj), the solution on it.
        coarse_values: ((ni+1)/2, (nj+1)/2), the solution on `Grid(grid.xy[::2, ::2])`.
        order: of convergence of the solver, positive.

    Raises:
        GridgenError: for other shapes, values that are not finite, or an order that is not positive.
    """
    fine, (ni, nj) = nodal_values(grid, values), grid.shape
    if ni % 2 == 0 or nj % 2 == 0:
        raise GridgenError(f"Richardson's estimate needs odd numbers of nodes; the grid has {ni} x {nj}")
    if not order > 0:
        raise GridgenError(f"the order of convergence must be positive; came {quoted(order)}")
    coarse = nodal_values(Grid(grid.xy[::2, ::2]), coarse_values, "values on the grid of every second node")
    error = np.empty_like(fine)
    error[::2, ::2] = (fine[::2, ::2] - coarse) / (1 - 2.0**order)
    error[1::2, ::2] = (error[:-2:2, ::2] + error[2::2, ::2]) / 2
    error[:, 1::2] = (error[:, :-2:2] + error[:, 2::2]) / 2
    return error


def _second_difference(fields: Array, axis: int) -> Array:
    """Return second differences along an axis; at both ends zero."""
    difference = np.zeros_like(fields)
    inner = np.moveaxis(difference, axis, 0)
    moved = np.moveaxis(fields, axis, 0)
    inner[1:-1] = moved[2:] - 2 * moved[1:-1] + moved[:-2]
    return difference
