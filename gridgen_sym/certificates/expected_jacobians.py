"""How large the Jacobians of a grid would be if the lengths of its boundary's edges alone decided that."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..boundary.predicates import scaled
from ..grids.grid import Grid, boundary_indices


def expected_jacobians(grid: Grid) -> Array:
    """Return the Jacobian at each corner that the boundary's spacing lets expect, as a fraction of the area inside.

    An edge is as long as those of the two opposite sides, and the nearer side counts the more; a Jacobian is the
    product of two edges, times what makes the sum of all cells' areas that of the inside. Where cells are narrow at a
    wall, or one side is much shorter than the opposite one, Jacobians are expected to be small; in a neck half-way
    between two sides they are not.

    Args:
        grid: any grid with the boundary; its inner nodes do not matter.

    Returns:
        An array (4, ni-1, nj-1), corners as in `corner_jacobians`. It is 0 if all edges of two opposite sides are.
    """
    ni, nj = grid.shape
    index = boundary_indices(ni, nj)
    ring = scaled(grid.xy[index[:, 0], index[:, 1]])
    # Not differences of arc lengths, in which very short edges are lost.
    lengths = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
    bottom, right, top, left = np.split(lengths, np.cumsum([ni - 1, nj - 1, ni - 1]))
    top, left = top[::-1], left[::-1]
    xi, eta = _parts(bottom + top), _parts(left + right)
    along_xi = np.outer(bottom, 1 - eta) + np.outer(top, eta)
    along_eta = np.outer(1 - xi, left) + np.outer(xi, right)
    low, high = slice(None, -1), slice(1, None)
    products = np.stack(
        [
            along_xi[:, xi_edge] * along_eta[eta_edge]
            for xi_edge, eta_edge in ((low, low), (low, high), (high, high), (high, low))
        ]
    )
    return np.asarray(products / (products.sum() / 4 or 1.0))


def _parts(lengths: Array) -> Array:
    """Return how far along a line of edges its nodes are, from 0 to 1."""
    return np.append(0.0, np.cumsum(lengths)) / (lengths.sum() or 1.0)
