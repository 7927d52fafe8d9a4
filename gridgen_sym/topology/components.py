"""Things that are the same, by pairs that are: connected components of a graph."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Indices = npt.NDArray[np.intp]


def component_numbers(first: Indices, second: Indices, count: int) -> Indices:
    """Return for each of `count` things the number of what it is part of, given pairs of things that are one."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    # SciPy's older releases take indices of 32 bits only.
    pairs = first.astype(np.int32), second.astype(np.int32)
    graph = coo_array((np.ones(len(first)), pairs), shape=(count, count))
    labels: Indices = connected_components(graph, directed=False)[1].astype(np.intp)
    return labels
