"""Between a target and its inverse as kernels read it: changes of one, and derivatives in the other.

Kernels read U = S V, with V = W⁻¹ and S the diagonal matrix of the logical steps. So dU = -U dW S⁻¹ U.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import Array
from ..functionals.metric import INVERSE_TARGET_NAMES
from ..runtime import Values

Steps = tuple[float, float]


def inverse_at_corners(values: Values, names: Sequence[str]) -> list[Array]:
    """Return U at the corners, entry by entry, (4, ni-1, nj-1) each."""
    return [np.stack(values.corners[names.index(name)]) for name in INVERSE_TARGET_NAMES]


def inverse_at_nodes(values: Values, names: Sequence[str]) -> list[Array]:
    """Return U at the nodes, (ni, nj) each."""
    return [values.nodes[names.index(name)] for name in INVERSE_TARGET_NAMES]


def inverse_along(inverse: Sequence[Array], change: Sequence[Array], steps: Steps) -> dict[str, Array]:
    """Return how U changes, by the names of its entries, along a change of W, row by row."""
    u, w = _matrix(inverse), _matrix(change)
    scaled = u / np.reshape(steps, (2, 1) + (1,) * (u.ndim - 2))
    found = -_product(_product(u, w), scaled)
    return dict(zip(INVERSE_TARGET_NAMES, found.reshape(4, *found.shape[2:]), strict=True))


def derivative_in_target(inverse: Sequence[Array], in_inverse: Mapping[str, Array], steps: Steps) -> list[Array]:
    """Return derivatives in the entries of W, row by row, from those in the entries of U."""
    u, bar = _matrix(inverse), _matrix([in_inverse[name] for name in INVERSE_TARGET_NAMES])
    scaled = u / np.reshape(steps, (2, 1) + (1,) * (u.ndim - 2))
    found = -_product(_product(u.swapaxes(0, 1), bar), scaled.swapaxes(0, 1))
    return list(found.reshape(4, *found.shape[2:]))


def _matrix(entries: Sequence[Array]) -> Array:
    stacked = np.stack(np.broadcast_arrays(*entries))
    return stacked.reshape(2, 2, *stacked.shape[1:])


def _product(first: Array, second: Array) -> Array:
    return np.asarray(np.einsum("ab...,bc...->ac...", first, second))
