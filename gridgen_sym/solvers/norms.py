"""Norms of fields over the nodes, and the lengths of edges that they are measured by."""

from __future__ import annotations

import numpy as np

from ..arrays import Array


def inner(first: Array, second: Array) -> float:
    """Return the inner product of two fields (2, ni, nj); infinite or NaN, and not a warning, where it overflows.

    Not by BLAS: its threads would keep spinning on the processors that the kernels' threads need.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.einsum("cij,cij->", first, second))


def norm_of(field: Array) -> float:
    """Return the Euclidean norm of a field; infinite, and not a warning, where it overflows."""
    return float(np.sqrt(inner(field, field)))


def mean_edge_length(coordinates: Array) -> float:
    """Return the root mean square length of an edge along xi plus that of one along eta."""
    return sum(
        norm_of(edges) / float(np.sqrt(edges[0].size))
        for edges in (np.diff(coordinates, axis=1), np.diff(coordinates, axis=2))
    )


def shortest_edges(coordinates: Array) -> Array:
    """Return the length (ni, nj) of the shortest edge that meets at each node."""
    shortest = np.full(coordinates.shape[1:], np.inf)
    along_xi, along_eta = (np.hypot(*np.diff(coordinates, axis=axis)) for axis in (1, 2))
    for nodes in (shortest[:-1], shortest[1:]):
        np.minimum(nodes, along_xi, out=nodes)
    for nodes in (shortest[:, :-1], shortest[:, 1:]):
        np.minimum(nodes, along_eta, out=nodes)
    return shortest
