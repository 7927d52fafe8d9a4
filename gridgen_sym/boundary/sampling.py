"""Boundary nodes on a polyline: at equal arc lengths, or so that its sharp turns are nodes and the spacing is smooth.

The second is a shortest path. A sharp vertex may become node k; the stretch between two such vertices has a whole
number of cells. Every cell longer or shorter than the mean costs the square of the logarithm of that factor, every
sharp vertex that is passed over costs the square of its turn; the cheapest choice is found by dynamic programming. A
monotone cubic through the chosen (node, arc length) pairs then spaces the nodes between them.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .predicates import scaled

Sampling = Literal["features", "equal"]

#: Mean spacing of a stretch over that of its side lies between 1/_STRETCH and _STRETCH; two neighboring stretches
#: differ by the square of it at most.
_STRETCH = 1.5
#: A vertex is sharp if the polyline turns by so much there (in radians), seen over one cell on either side.
_SHARP = np.radians(20.0)
#: Node k may be so many cells away from its position at equal spacing.
_BAND = 3
#: The weight of a turn of one radian, in units of one cell that is longer by the factor e.
_WORTH = 1.0
#: The previous sharp vertex is searched so many cells back.
_REACH = 24


def sample(line: Array, count: int, sampling: Sampling) -> Array:
    """Return `count` points on an open polyline (n, 2); its ends and the chosen sharp vertices are kept exactly."""
    length = arc_lengths(line)
    cells = count - 1
    node, vertex = np.array([0, cells]), np.array([0, len(line) - 1])
    if sampling == "features" and len(line) > 2:
        node, vertex = _chosen_vertices(line, length, cells)
    at = _smooth_spacing(node, length[vertex], cells)
    side = np.stack([np.interp(at, length, line[:, axis]) for axis in (0, 1)], axis=-1)
    side[node] = line[vertex]
    return side


def arc_lengths(line: Array) -> Array:
    """Return the arc length of each vertex of an open polyline (n, 2), in units of a power of 2 near its extent."""
    # Lengths of huge coordinates must not overflow.
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(scaled(line), axis=0).T))))


def turns_at(line: Array, length: Array, at: Array, reach: float, period: float | None = None) -> Array:
    """Return how much a polyline turns at arc lengths `at`, in radians, positive to the left.

    The turn is that between the chords to the points one `reach` before and after: the turn at the resolution of that
    spacing. With a `period`, the whole arc length, the polyline is closed and its last vertex is not a copy of the
    first.
    """
    line = scaled(line)
    before, here, after = (
        np.stack([np.interp(where, length, line[:, axis], period=period) for axis in (0, 1)], axis=-1)
        for where in (at - reach, at, at + reach)
    )
    one, two = here - before, after - here
    cross = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    return np.asarray(np.arctan2(cross, (one * two).sum(axis=1)))


def _chosen_vertices(line: Array, length: Array, cells: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the nodes that lie on vertices, and these vertices, both with the ends: the choice of least cost."""
    spacing = length[-1] / cells
    vertex, worth = _sharp_vertices(line, length, spacing)
    place = length[vertex] / spacing  # In cells.
    passed = np.concatenate(([0.0], np.cumsum(worth)))
    offsets = np.arange(-_BAND, _BAND + 1)
    nodes = np.rint(place).astype(int)[:, None] + offsets
    cost = np.full(nodes.shape, np.inf)
    cost[0, _BAND] = 0.0
    came_from = np.zeros((*nodes.shape, 2), dtype=int)
    for m in range(1, len(vertex)):
        # The sharp vertices within reach and the last one; and always the start, so that some path exists.
        first = min(m - 1, int(np.searchsorted(place, place[m] - _REACH)))
        earlier = np.unique(np.concatenate(([0], np.arange(first, m))))
        number = nodes[m][None, None] - nodes[earlier][:, :, None]  # Cells: (earlier, offset there, offset here).
        with np.errstate(divide="ignore", invalid="ignore"):  # A stretch without cells is excluded.
            log = np.log((place[m] - place[earlier])[:, None, None] / number)
            stretched = np.where(np.abs(log) <= np.log(_STRETCH), number * log**2, np.inf)
        step = stretched + (passed[m] - passed[earlier + 1])[:, None, None]
        total = (cost[earlier][:, :, None] + step).reshape(-1, len(offsets))
        best = total.argmin(axis=0)
        cost[m] = total[best, np.arange(len(offsets))]
        came_from[m, :, 0], came_from[m, :, 1] = earlier[best // len(offsets)], best % len(offsets)
    return _way_back(vertex, nodes, came_from)


def _way_back(
    vertex: NDArray[np.intp], nodes: NDArray[np.int_], came_from: NDArray[np.int_]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Follow the path of least cost from the end of the polyline to its start."""
    m, offset = len(vertex) - 1, _BAND
    way = [(m, offset)]
    while m > 0:
        m, offset = came_from[m, offset]
        way.append((int(m), int(offset)))
    chosen = np.array(way[::-1])
    return nodes[chosen[:, 0], chosen[:, 1]], vertex[chosen[:, 0]]


def _sharp_vertices(line: Array, length: Array, spacing: float) -> tuple[NDArray[np.intp], Array]:
    """Return the vertices that may become nodes, with the ends, and their weights.

    Of those nearer to each other than a third of a cell the sharpest is taken.
    """
    inner = np.arange(1, len(line) - 1)
    turn = np.abs(turns_at(line, length, length[1:-1], spacing))
    place = length[1:-1] / spacing
    first, last = (np.searchsorted(place, place + shift) for shift in (-1 / 3, 1 / 3))
    sharpest = np.array([turn[a:b].max() for a, b in zip(first, last, strict=True)])
    inside = (place > 1 / _STRETCH) & (place < length[-1] / spacing - 1 / _STRETCH)
    sharp = inside & (turn >= _SHARP) & (turn == sharpest)
    vertex = np.concatenate(([0], inner[sharp], [len(line) - 1]))
    return vertex, np.concatenate(([0.0], _WORTH * turn[sharp] ** 2, [0.0]))


def _smooth_spacing(node: NDArray[np.intp], at: Array, cells: int) -> Array:
    """Return the arc lengths of all nodes, monotone and smooth, from those of some."""
    if len(node) == 2:
        return np.linspace(at[0], at[-1], cells + 1)
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(node, at)(np.arange(cells + 1)))
