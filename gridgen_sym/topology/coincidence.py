"""Find the parts of sides whose nodes coincide."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.sides import Sides
from ..errors import GridgenError
from ..grids import Grid
from .components import component_numbers
from .connection import SidePart

#: Nodes coincide that are nearer than this part of the shortest edge that meets there, or than rounding explains.
_NEAR, _ROUNDING = 1e-4, 32 * float(np.finfo(float).eps)


def coinciding_parts(blocks: Sequence[Grid], names: Sequence[str]) -> list[tuple[SidePart, SidePart]]:
    """Return all pairs of parts of sides whose nodes coincide, edge by edge, as long as possible.

    Raises:
        GridgenError: if an edge coincides with more than one other.
    """
    sides = [_whole(block, side, grid.shape) for block, grid in enumerate(blocks) for side in Sides._fields]
    nodes = [side.nodes(blocks) for side in sides]
    numbers = _places(nodes)
    partner: dict[tuple[int, int], tuple[int, int]] = {}
    seen: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for number, places in enumerate(numbers):
        for edge, (one, other) in enumerate(pairwise(places)):
            if one != other:
                seen.setdefault((min(one, other), max(one, other)), []).append((number, edge))
    for edges in seen.values():
        if len(edges) > 2:
            told = "; ".join(SidePart(sides[s].block, sides[s].side, e, e + 1).described(names) for s, e in edges)
            raise GridgenError(
                f"{len(edges)} edges of sides lie at one place: {told}. At most two blocks can meet there; name the "
                "connections one by one, or move the nodes apart"
            )
        if len(edges) == 2:
            partner[edges[0]], partner[edges[1]] = edges[1], edges[0]
    return [(_part(sides[a], first), _part(sides[b], second)) for a, first, b, second in _runs(sides, partner)]


def _whole(block: int, side: str, shape: tuple[int, int]) -> SidePart:
    return SidePart(block, side, 0, shape[0 if side in ("bottom", "top") else 1] - 1)


def _part(side: SidePart, edges: tuple[int, int]) -> SidePart:
    return SidePart(side.block, side.side, edges[0], edges[1] + 1)


def _places(nodes: list[Array]) -> list[npt.NDArray[np.intp]]:
    """Return for every node of the sides the number of its place: nodes that coincide have the same."""
    from scipy.spatial import cKDTree

    points = np.concatenate(nodes)
    reach = _NEAR * np.concatenate([_shortest_edges(side) for side in nodes])
    reach = np.maximum(reach, _ROUNDING * np.abs(points).max())
    found = cKDTree(points).query_ball_point(points, reach)
    rows = np.repeat(np.arange(len(points)), [len(near) for near in found])
    columns = np.concatenate([np.asarray(near, dtype=np.intp) for near in found])
    apart = np.hypot(*(points[rows] - points[columns]).T)
    near = apart <= np.minimum(reach[rows], reach[columns])
    labels = component_numbers(rows[near], columns[near], len(points))
    ends = np.cumsum([len(side) for side in nodes])
    return [labels[end - len(side) : end] for side, end in zip(nodes, ends, strict=True)]


def _shortest_edges(side: Array) -> Array:
    """Return the length of the shortest edge, not of length zero, that meets at each node of a side."""
    edges = np.hypot(*np.diff(side, axis=0).T)
    edges = np.where(edges > 0, edges, np.inf)
    shortest = np.minimum(np.r_[np.inf, edges], np.r_[edges, np.inf])
    return np.where(np.isfinite(shortest), shortest, 0.0)


def _runs(
    sides: list[SidePart], partner: dict[tuple[int, int], tuple[int, int]]
) -> Iterator[tuple[int, tuple[int, int], int, tuple[int, int]]]:
    """Yield side, first and last edge, of both, of every longest run of edges that coincide in order."""
    left = dict(partner)
    for number, side in enumerate(sides):
        edge = 0
        while edge < side.count - 1:
            if (number, edge) not in left:
                edge += 1
                continue
            other, at = left[number, edge]
            step = -1 if sides[other].counterclockwise == side.counterclockwise else 1
            length = 1
            while left.get((number, edge + length)) == (other, at + step * length) and (
                other != number or edge + length < at + step * length
            ):
                length += 1
            for k in range(length):
                del left[number, edge + k]
                left.pop((other, at + step * k), None)
            ends = sorted((at, at + step * (length - 1)))
            yield number, (edge, edge + length - 1), other, (ends[0], ends[1])
            edge += length
