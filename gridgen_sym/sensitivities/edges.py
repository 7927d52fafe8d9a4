"""From derivatives in edges to those in nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Array

#: The ends of the edges along xi, and along eta, at the corners of a cell, counter-clockwise from node (i, j).
_ENDS_XI = ((0, 0), (1, 0)), ((0, 0), (1, 0)), ((0, 1), (1, 1)), ((0, 1), (1, 1))
_ENDS_ETA = ((0, 0), (0, 1)), ((1, 0), (1, 1)), ((1, 0), (1, 1)), ((0, 0), (0, 1))


def corner_edges_transposed(entries: Sequence[Array]) -> Array:
    """Return derivatives in the nodes, planes (2, ni, nj), given those in what `corner_edges` returns of them."""
    _, rows, columns = entries[0].shape
    nodes = np.zeros((2, rows + 1, columns + 1))
    x_xi, x_eta, y_xi, y_eta = entries
    for edges, ends in (((x_xi, y_xi), _ENDS_XI), ((x_eta, y_eta), _ENDS_ETA)):
        for corner, pair in enumerate(ends):
            for (i, j), sign in zip(pair, (-1.0, 1.0), strict=True):
                for plane, edge in zip(nodes, edges, strict=True):
                    plane[i : rows + i, j : columns + j] += sign * edge[corner]
    return nodes


def lengths_transposed(line: Array, in_lengths: Array) -> Array:
    """Return derivatives in the nodes of a line (2, n), given those in the lengths (n - 1,) of its edges."""
    edges = np.diff(line, axis=1)
    pull = edges * (in_lengths / np.hypot(*edges))
    found = np.zeros_like(line)
    found[:, 1:] += pull
    found[:, :-1] -= pull
    return found


def fractions_transposed(lengths: Array, in_fractions: Array) -> Array:
    """Return derivatives in lengths (n - 1,), given those in the fractions (n,) of their sum up to each node."""
    total = lengths.sum()
    fractions = np.concatenate(([0.0], np.cumsum(lengths))) / total
    behind = np.cumsum(in_fractions[::-1])[::-1][1:]
    return np.asarray((behind - (in_fractions * fractions).sum()) / total)


def transfinite_transposed(nodes: Array) -> Array:
    """Return derivatives in the boundary nodes (2, ni, nj) of those in a transfinite grid of them."""
    found = np.zeros_like(nodes)
    found[:, 0], found[:, -1], found[:, :, 0], found[:, :, -1] = (
        nodes[:, 0],
        nodes[:, -1],
        nodes[:, :, 0],
        nodes[:, :, -1],
    )
    inner = nodes[:, 1:-1, 1:-1]
    s, t = (np.linspace(0, 1, count)[1:-1] for count in nodes.shape[1:])
    low, high = np.einsum("aij,j->ai", inner, 1 - t), np.einsum("aij,j->ai", inner, t)
    left, right = np.einsum("aij,i->aj", inner, 1 - s), np.einsum("aij,i->aj", inner, s)
    found[:, 1:-1, 0] += low
    found[:, 1:-1, -1] += high
    found[:, 0, 1:-1] += left
    found[:, -1, 1:-1] += right
    found[:, 0, 0] -= low @ (1 - s)
    found[:, -1, 0] -= low @ s
    found[:, 0, -1] -= high @ (1 - s)
    found[:, -1, -1] -= high @ s
    return found
