"""From planes of stencil blocks to sparse matrices over the free nodes.

The unknowns are numbered node by node, in the order of the array (eta runs fastest), x before y: component c of
the k-th free node is unknown 2 k + c.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array, Mask
from .assembly import NEIGHBORS, Sources, assemble

#: The first of the planes of a node's couplings, xx, xy, yx, yy, with the neighbors whose blocks the Hessian stores.
_STORED = {(1, 0): 3, (0, 1): 7, (1, 1): 11, (1, -1): 15}


def _hessian_sources() -> Sources:
    """Return where entries are in the stored half: those of the other half at the neighbors, transposed."""
    found, at_neighbor = np.empty((9, 2, 2), dtype=np.int64), np.zeros(9, dtype=np.bool_)
    for place, (di, dj) in enumerate(NEIGHBORS):
        if (di, dj) == (0, 0):
            found[place] = ((0, 1), (1, 2))
        elif (di, dj) in _STORED:  # The node's component is the block's row, and the column of the matrix.
            found[place] = _STORED[di, dj] + np.arange(4).reshape(2, 2)
        else:
            found[place] = _STORED[-di, -dj] + np.arange(4).reshape(2, 2).T
            at_neighbor[place] = True
    return Sources(found, at_neighbor)


def _jacobian_sources() -> Sources:
    """Return where entries are in the nine blocks of a node's equations: a column's are at the nodes of its rows."""
    blocks = np.array([NEIGHBORS.index((-di, -dj)) for di, dj in NEIGHBORS])
    return Sources(4 * blocks[:, None, None] + np.arange(4).reshape(2, 2).T, np.ones(9, dtype=np.bool_))


_HESSIAN, _JACOBIAN = _hessian_sources(), _jacobian_sources()


def assemble_hessian(planes: Array, fixed: Mask, *, compiled: bool = False) -> Any:  # noqa: ANN401 - scipy.sparse has no types
    """Return the symmetric Hessian over the free nodes (CSC) from its stored half (19, ni, nj)."""
    return assemble(planes, fixed, _HESSIAN, compiled=compiled)


def assemble_jacobian(planes: Array, fixed: Mask, *, compiled: bool = False) -> Any:  # noqa: ANN401
    """Return the Jacobian of the Euler-Lagrange residual over the free nodes (CSC) from its planes (36, ni, nj)."""
    return assemble(planes, fixed, _JACOBIAN, compiled=compiled)


def to_vector(field: Array, fixed: Mask) -> Array:
    """Return the components of a field (2, ni, nj) at the free nodes as a vector of unknowns."""
    return np.ascontiguousarray(field[:, fixed == 0].T).ravel()


def to_field(vector: Array, fixed: Mask) -> Array:
    """Return a vector of unknowns as a field (2, ni, nj), zero at the fixed nodes."""
    field = np.zeros((2, *fixed.shape))
    field[:, fixed == 0] = vector.reshape(-1, 2).T
    return field
