"""Half-plane constraints on one inner node, and the proof that no position meets all of them.

Where two nodes of a corner's triangle are on the boundary, J > 0 there puts the third strictly to the left of the line
through them. The half-planes of one inner node have no common point exactly if three of them have none (Helly), and
then there are non-negative multipliers for which their sum reads 0 > 0 (Farkas).
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..grids.grid import Grid, corner_jacobians, folded_corners

Node = tuple[int, int]
Edge = tuple[Node, Node]
_HalfPlane = tuple[Fraction, Fraction, Fraction]
#: The nodes of a cell, counter-clockwise, relative to its first.
_CELL = ((0, 0), (1, 0), (1, 1), (0, 1))
#: `check` is called once for so many nodes, so that a few are proved even when the time is over.
_CHECKED = 8


def infeasible_nodes(grid: Grid, check: Callable[[], object] | None = None) -> list[tuple[Node, tuple[Edge, ...]]]:
    """Return the inner nodes that have no feasible position, each with boundary nodes that prove it.

    Args:
        grid: any grid with the boundary nodes; where its cells are valid no proof is tried.
        check: called often, for many nodes; what it raises ends the work.

    Returns:
        For each such node (i, j) up to three pairs of boundary nodes (s, t): the node would have to lie strictly to
        the left of every line from s to t, which no point does. This is proved in rational arithmetic.
    """
    xy = grid.xy
    valid = _in_valid_cells(grid)
    found = []
    for count, node in enumerate(node for node in _candidates(*grid.shape) if not valid[node]):
        if check is not None and count % _CHECKED == _CHECKED - 1:
            check()
        conflict = _conflict(xy, _constraints(node, *grid.shape))
        if conflict:
            found.append((node, conflict))
    return found


def _candidates(ni: int, nj: int) -> list[Node]:
    """Return the inner nodes next to more than one side: those next to a corner, or in a single inner row."""
    if ni == 3 or nj == 3:
        return [(i, j) for i in range(1, ni - 1) for j in range(1, nj - 1)]
    return [(i, j) for i in (1, ni - 2) for j in (1, nj - 2)]


def _in_valid_cells(grid: Grid) -> NDArray[np.bool_]:
    """Return for each node (ni, nj) whether all its cells are valid, which shows that its position is feasible."""
    ni, nj = grid.shape
    with np.errstate(over="ignore", invalid="ignore"):
        valid = ~folded_corners(corner_jacobians(grid.x, grid.y)).any(axis=0)
    found = np.ones((ni, nj), dtype=bool)
    for i, j in _CELL:
        found[i : ni - 1 + i, j : nj - 1 + j] &= valid
    return found


def _constraints(node: Node, ni: int, nj: int) -> list[Edge]:
    """Return the pairs of boundary nodes that form, counter-clockwise, a corner's triangle with an inner node."""
    i, j = node
    found: set[Edge] = set()
    for a, b in _CELL:
        cell = [(i - a + p, j - b + q) for p, q in _CELL]
        at = cell.index(node)
        # The triangles of the corners before, at and after the node.
        for first, second in ((-2, -1), (1, -1), (1, 2)):
            pair = cell[(at + first) % 4], cell[(at + second) % 4]
            if all(p in (0, ni - 1) or q in (0, nj - 1) for p, q in pair):
                found.add(pair)
    return sorted(found)


def _conflict(xy: Array, edges: list[Edge]) -> tuple[Edge, ...]:
    """Return up to three of the edges whose half-planes have no common point, or none."""
    planes = {edge: _half_plane(xy[edge[0]], xy[edge[1]]) for edge in edges}
    for count in (1, 2, 3):
        for chosen in combinations(edges, count):
            if _contradict([planes[edge] for edge in chosen]):
                return chosen
    return ()


def _half_plane(s: Array, t: Array) -> _HalfPlane:
    """Return (a, b, c) such that a x + b y > c to the left of the line from s to t."""
    sx, sy, tx, ty = (Fraction(float(value)) for value in (*s, *t))
    a, b = sy - ty, tx - sx
    return a, b, a * sx + b * sy


def _contradict(planes: list[_HalfPlane]) -> bool:
    """Return whether non-negative multipliers, not all 0, cancel the left sides and leave 0 > c with c >= 0."""
    if len(planes) == 1:
        multipliers = [Fraction(1)]
    elif len(planes) == 2:
        (a, b, _), (p, q, _) = planes
        multipliers = [p * p + q * q, -(a * p + b * q)]
    else:
        multipliers = [
            planes[(k + 1) % 3][0] * planes[(k + 2) % 3][1] - planes[(k + 1) % 3][1] * planes[(k + 2) % 3][0]
            for k in range(3)
        ]
        if sum(multipliers) < 0:
            multipliers = [-value for value in multipliers]
    terms = [[m * value for value in plane] for m, plane in zip(multipliers, planes, strict=True)]
    a, b, c = (sum(column) for column in zip(*terms, strict=True))
    return min(multipliers) >= 0 and max(multipliers) > 0 and a == b == 0 and c >= 0
