"""Recover derivatives of a solution from its nodal values: continuous, and better than those of its cells.

The idea is that of O. C. Zienkiewicz and J. Z. Zhu, "A simple error estimator and adaptive procedure for practical
engineering analysis" (1987): average the derivatives of the cells that meet at a node. Weighted with the corners'
Jacobians, the average on a structured grid is the central difference in the logical coordinates, by the chain rule.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError
from ..grids import Grid, quality
from ..grids.grid import check_grid


def recover_gradient(grid: Grid, values: npt.ArrayLike) -> Array:
    """Return the recovered gradient (2, ni, nj) of nodal values (ni, nj): u_x and u_y at every node.

    Exact for linear functions on every valid grid; second-order inside a smooth grid, first-order at its boundary.

    Raises:
        GridgenError: for values of another shape or not finite, or a folded grid.
    """
    u = nodal_values(grid, values)
    if not quality(grid).valid:
        raise GridgenError("derivatives need a valid grid, but some of its cells are folded: use gridgen_sym.untangle")
    return _gradient(grid, u)


def recover_hessian(grid: Grid, values: npt.ArrayLike) -> Array:
    """Return the recovered second derivatives (3, ni, nj) of nodal values: u_xx, u_xy and u_yy.

    The gradient is recovered twice, the mixed derivatives are averaged, and the boundary has the values of its inner
    neighbors, because differences of one-sided differences are not consistent there.

    Raises:
        GridgenError: as for `recover_gradient`.
    """
    u_x, u_y = recover_gradient(grid, values)
    (u_xx, u_xy), (u_yx, u_yy) = _gradient(grid, u_x), _gradient(grid, u_y)
    hessian = np.stack((u_xx, (u_xy + u_yx) / 2, u_yy))
    return from_inside(from_inside(hessian, 1), 2)


def from_inside(field: Array, axis: int) -> Array:
    """Return the field with the values of the inner neighbors at both ends of an axis."""
    inner = np.moveaxis(field, axis, 0)[1:-1]
    return np.moveaxis(np.concatenate((inner[:1], inner, inner[-1:])), 0, axis)


def nodal_values(grid: Grid, values: npt.ArrayLike, what: str = "nodal values") -> Array:
    """Return values as an array of the grid's shape.

    Raises:
        GridgenError: if they have another shape, or one of them is not finite.
    """
    check_grid(grid)
    u = real_array(values, what)
    if u.shape != grid.shape:
        raise GridgenError(f"{what} must have the grid's shape {grid.shape}; came {u.shape}")
    if not np.isfinite(u).all():
        i, j = (int(k) for k in np.argwhere(~np.isfinite(u))[0])
        raise GridgenError(f"{what} must be finite; node ({i}, {j}) has {u[i, j]}")
    return u


def _gradient(grid: Grid, u: Array) -> Array:
    gradient, J = weighted_gradient(grid, u)
    return gradient / J


def weighted_gradient(grid: Grid, u: Array) -> tuple[Array, Array]:
    """Return J times the recovered gradient (2, ni, nj) of nodal values, and J.

    J is the mean of the Jacobians of the corners at the node: positive on a valid grid.
    """
    (x_xi, x_eta), (y_xi, y_eta), (u_xi, u_eta) = (np.gradient(field) for field in (grid.x, grid.y, u))
    J = np.asarray(x_xi * y_eta - x_eta * y_xi)
    return np.stack((u_xi * y_eta - u_eta * y_xi, u_eta * x_xi - u_xi * x_eta)), J
