"""The Jacobians predicted from the spacing of the boundary nodes."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..boundary.predicates import scaled
from ..grids.grid import Grid, boundary_indices


def expected_jacobians(grid: Grid) -> Array:
    """Return the Jacobian at each corner predicted from the boundary spacing, as a fraction of the area inside.

    It is the product of two expected edges, scaled so that the areas of all cells sum to that of the inside. So small
    Jacobians are predicted where cells are narrow at a wall, or where one side is much shorter than the opposite one,
    but not in a neck half-way between two sides.

    Args:
        grid: any grid with the boundary nodes; its inner nodes do not matter.

    Returns:
        An array (4, ni-1, nj-1), corners as in `corner_jacobians`. It is 0 if two opposite sides have no length.
    """
    products = np.multiply(*expected_edges(grid))
    return np.asarray(products / (products.sum() / 4 or 1.0))


def expected_edges(grid: Grid) -> tuple[Array, Array]:
    """Return the lengths of the two edges at each corner that are predicted from the boundary spacing.

    The length of an inner edge is interpolated between the two boundary edges opposite each other on the same grid
    lines, linearly in the relative arc length.

    Args:
        grid: any grid with the boundary nodes; its inner nodes do not matter.

    Returns:
        The lengths along xi, and along eta, each (4, ni-1, nj-1), corners as in `corner_jacobians`. The unit of both is
        the extent of the boundary.
    """
    ni, nj = grid.shape
    index = boundary_indices(ni, nj)
    ring = scaled(grid.xy[index[:, 0], index[:, 1]])
    # Differences of arc lengths would lose very short edges.
    lengths = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
    bottom, right, top, left = np.split(lengths, np.cumsum([ni - 1, nj - 1, ni - 1]))
    top, left = top[::-1], left[::-1]
    xi, eta = _relative_arc_lengths(bottom + top), _relative_arc_lengths(left + right)
    along_xi = np.outer(bottom, 1 - eta) + np.outer(top, eta)
    along_eta = np.outer(1 - xi, left) + np.outer(xi, right)
    low, high = slice(None, -1), slice(1, None)
    corners = (low, low), (low, high), (high, high), (high, low)
    return (
        np.stack([along_xi[:, xi_edge] for xi_edge, _ in corners]),
        np.stack([along_eta[eta_edge] for _, eta_edge in corners]),
    )


def _relative_arc_lengths(lengths: Array) -> Array:
    """Return the relative arc length of each node of a line of edges, from 0 to 1."""
    return np.append(0.0, np.cumsum(lengths)) / (lengths.sum() or 1.0)
