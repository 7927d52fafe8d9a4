"""Certificates: proofs, from the boundary nodes alone, that no grid without a folded cell exists.

In a grid whose corner Jacobians are all positive every cell is a convex quadrilateral that is not turned over. So its
corners have angles below 180 degrees, its map covers no point a negative number of times, its boundary turns through
360 degrees in all, and its area is positive. Each certificate contradicts one of these, by exact arithmetic. A boundary
that touches or overlaps itself may still have a valid grid: an annulus that is cut open, or a spiral.

All of this is quick. The search for cells that conflict (`conflict.py`) takes longer and proves much more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import GridgenError
from .conflict import LITTLE_WORK, Conflict, find_conflict
from .grid import FloatArray, Grid, boundary_indices, check_grid
from .neck import Node, crowded_nodes
from .network import nodes_of
from .polygon import first_repeated, inner_angles, proper_crossings, turns, winding_number
from .predicates import area_sign, orientation

Kind = Literal["coincident", "crossing", "clockwise", "corner", "spike", "neck", "conflict"]

# Of very many crossings so many are tried, each at these distances from it, as fractions of the shorter edge.
_MOST_CROSSINGS, _DISTANCES = 200, (0.25, 0.05, 0.01, 1e-3)
# A message names so many cells, and counts the others.
_MOST_NAMED = 6


@dataclass(frozen=True, slots=True)
class Certificate:
    """One proof that no grid without a folded cell has these boundary nodes.

    Attributes:
        kind: 'coincident': two neighbors are one point; 'crossing': the boundary crosses itself, so that cells must be
            turned over; 'clockwise': the boundary runs clockwise, which can be repaired; 'corner': the three fixed
            nodes at a logical corner turn the wrong way; 'spike': the boundary runs back on itself at a node; 'neck':
            there is no place for an inner node; 'conflict': some cells cannot all be valid while the others are, which
            a search has shown.
        nodes: indices (i, j) of the nodes that prove it. Two for 'coincident'; the ends of two edges for 'crossing';
            before, at and after the place for 'corner' and 'spike'; the inner node and pairs of boundary nodes, to
            the left of each of which it would have to lie, for 'neck'; none for 'clockwise'; the four of each cell,
            counter-clockwise from its first, for 'conflict'.
        point: where to look, (x, y).
        numbers: what was measured. 'corner': the number (0 to 3, counter-clockwise from (0, 0)) of a 'corner';
            'angle': its inner angle in degrees, also of a 'spike'; 'crossings': how many pairs of edges cross;
            'winding': how often the boundary winds round the point 'x', 'y'; 'turn': its total turn in degrees;
            'cells': how many conflict.
        message: a sentence that names the thing and what helps.
    """

    kind: Kind
    nodes: tuple[Node, ...]
    point: tuple[float, float]
    numbers: Mapping[str, float]
    message: str

    def __str__(self) -> str:
        """Return the message."""
        return self.message


def certificates(
    grid: Grid, *, search: bool = False, work: int = LITTLE_WORK, check: Callable[[], object] | None = None
) -> tuple[Certificate, ...]:
    """Return proofs that the boundary nodes of a grid, which do not move, admit no grid without a folded cell.

    The inner nodes do not matter. None for a valid grid; and no certificate is no proof that a valid grid exists.
    What follows from another certificate is not listed: a clockwise boundary has four wrong corners.

    Args:
        grid: any grid with the boundary in question, such as `transfinite(bottom, top, left, right)`.
        search: where there is no certificate otherwise, search near the folded cells of `grid` for cells that cannot
            all be valid. It finds most on the least folded grid, as `untangle` returns it.
        work: how many steps each of the few attempts of the search may take, some 50 microseconds each. The
            default means a few seconds; hard boundaries need a hundred times as many, or are never decided.
        check: called again and again during the search; what it raises ends it.

    Raises:
        GridgenError: if `grid` is no Grid, or `work` no positive whole number.
    """
    check_grid(grid)
    if not isinstance(work, (int, np.integer)) or isinstance(work, bool) or work < 1:
        raise GridgenError(f"work must be a whole number of steps, at least 1; came {work!r}")
    found = _quick(grid)
    if search and not found:
        conflict = find_conflict(grid, work, check)
        found = [_conflict(grid, conflict)] if conflict else []
    return tuple(found)


def _quick(grid: Grid) -> list[Certificate]:
    """Return the certificates that need no search."""
    index = boundary_indices(*grid.shape)
    ring = np.ascontiguousarray(grid.planes[:, index[:, 0], index[:, 1]].T)
    found = _coincident(ring, index)
    if found:
        return found
    turn, back = turns(ring)
    with np.errstate(over="ignore", invalid="ignore"):  # Huge coordinates may spoil the place that is told, no proof.
        found = _crossing(ring, index, None if back.any() else float(turn.sum()))
        if not found and area_sign(ring) <= 0:
            return [_clockwise(ring)]
        found += _corners(ring, index, grid.shape) + _spikes(ring, index, turn, back, grid.shape)
        return found or _necks(grid)


def _coincident(ring: FloatArray, index: NDArray[np.intp]) -> list[Certificate]:
    """Certify an edge of the boundary without length: both corners at it have J = 0."""
    k = first_repeated(ring)
    if k is None:
        return []
    nodes, point = _nodes(index, k, k + 1), _point(ring[k])
    message = (
        f"no valid grid exists: the boundary's nodes {nodes[0]} and {nodes[1]} are one point, {_text(point)}; "
        "place them apart"
    )
    return [Certificate("coincident", nodes, point, {}, message)]


def _crossing(ring: FloatArray, index: NDArray[np.intp], turn: float | None) -> list[Certificate]:
    """Certify a boundary that crosses itself and winds backwards round some point, or turns too little or too much."""
    crossings = proper_crossings(ring)
    numbers: dict[str, float] = {"crossings": len(crossings)}
    for a, b in crossings[:_MOST_CROSSINGS]:
        witness = _negative_winding(ring, a, b)
        if witness:
            (x, y), winding = witness
            numbers |= {"winding": winding, "x": x, "y": y}
            proof = f"it winds {winding} times round {_text((x, y))}, counted counter-clockwise"
            return [_crossing_certificate(_nodes(index, a, a + 1, b, b + 1), _meeting(ring, a, b), numbers, proof)]
    whole = 1 if turn is None else round(turn / (2 * np.pi))
    if crossings and abs(whole) != 1:
        a, b = crossings[0]
        numbers |= {"turn": 360.0 * whole}
        proof = f"it turns through {360 * whole} degrees in all instead of 360"
        return [_crossing_certificate(_nodes(index, a, a + 1, b, b + 1), _meeting(ring, a, b), numbers, proof)]
    return []


def _crossing_certificate(
    nodes: tuple[Node, ...], meeting: FloatArray, numbers: dict[str, float], proof: str
) -> Certificate:
    """Return the certificate of two edges that cross, given by their ends."""
    more = f" (and in {numbers['crossings'] - 1} more places)" if numbers["crossings"] > 1 else ""
    message = (
        f"no valid grid exists: the boundary crosses itself at {_text(_point(meeting))}, where the edge "
        f"{nodes[0]}-{nodes[1]} meets the edge {nodes[2]}-{nodes[3]}{more}; {proof}. Mend the boundary there, or take "
        "more nodes if it is sampled from a curve that does not cross itself"
    )
    return Certificate("crossing", nodes, _point(meeting), numbers, message)


def _negative_winding(ring: FloatArray, a: int, b: int) -> tuple[tuple[float, float], int] | None:
    """Return a point to the right of two edges that cross, near them, round which the boundary winds backwards."""
    end = np.roll(ring, -1, axis=0)
    one, other = end[a] - ring[a], end[b] - ring[b]
    sign = float(orientation(ring[a], end[a], end[b])[0])
    lengths = np.hypot(*one), np.hypot(*other)
    away = sign * (one / lengths[0] - other / lengths[1])  # To the right of both.
    for distance in _DISTANCES:
        at = _meeting(ring, a, b) + distance * min(lengths) * away
        winding = winding_number(ring, at) if np.isfinite(at).all() else None
        if winding is not None and winding < 0:
            return _point(at), winding
    return None


def _meeting(ring: FloatArray, a: int, b: int) -> FloatArray:
    """Return about where two edges cross."""
    p, q = ring[a], ring[b]
    one, other = np.roll(ring, -1, axis=0)[[a, b]] - (p, q)
    scale = np.abs((one, other)).max()
    one_unit, other_unit, apart = one / scale, other / scale, (q - p) / scale
    cross = one_unit[0] * other_unit[1] - one_unit[1] * other_unit[0]
    part = (apart[0] * other_unit[1] - apart[1] * other_unit[0]) / cross if cross else 0.5
    return np.asarray(p + np.clip(part, 0.0, 1.0) * one)


def _clockwise(ring: FloatArray) -> Certificate:
    """Certify a boundary whose area is not positive: the area of a grid is the sum of the areas of its cells."""
    message = (
        "no valid grid exists: the boundary runs clockwise, or encloses no area. Let it run counter-clockwise: "
        "exchange left and right, Grid(grid.xy[::-1])"
    )
    return Certificate("clockwise", (), _point(ring.mean(axis=0)), {}, message)


def _corners(ring: FloatArray, index: NDArray[np.intp], shape: tuple[int, int]) -> list[Certificate]:
    """Certify logical corners whose three nodes, all fixed, do not turn to the left: J <= 0 there in every grid."""
    at = _corner_places(*shape)
    previous, following = ring[at - 1], ring[(at + 1) % len(ring)]
    signs = orientation(previous, ring[at], following)
    angles = inner_angles(previous, ring[at], following)
    found = []
    for corner in np.flatnonzero(signs <= 0).tolist():
        k, angle = int(at[corner]), float(angles[corner])
        nodes, point = _nodes(index, k - 1, k, k + 1), _point(ring[k])
        message = (
            f"no valid grid exists: at corner {corner}, node {nodes[1]} at {_text(point)}, the boundary turns the "
            f"wrong way: its inner angle is {angle:.4g} degrees and must be less than 180, and the node and its two "
            "neighbors are fixed. What helps: a corner where the boundary turns to the left, more nodes if the curve "
            "itself turns to the left here, or the neighbors moved along the boundary"
        )
        found.append(Certificate("corner", nodes, point, {"corner": corner, "angle": angle}, message))
    return found


def _spikes(
    ring: FloatArray, index: NDArray[np.intp], turn: FloatArray, back: NDArray[np.bool_], shape: tuple[int, int]
) -> list[Certificate]:
    """Certify nodes on a side where the boundary runs back on itself: two cells cannot share an angle of 0 or 360."""
    found = []
    for k in np.setdiff1d(np.flatnonzero(back), _corner_places(*shape)).tolist():
        nodes, point = _nodes(index, k - 1, k, k + 1), _point(ring[k])
        message = (
            f"no valid grid exists: at node {nodes[1]} at {_text(point)} the boundary runs back on itself; its inner "
            "angle is 0 or 360 degrees and must lie between them. Open the spike, or place no node at its tip"
        )
        found.append(Certificate("spike", nodes, point, {"angle": 180.0 - float(np.degrees(turn[k]))}, message))
    return found


def _necks(grid: Grid) -> list[Certificate]:
    """Certify inner nodes next to so much boundary that there is no place for them."""
    found = []
    for node, edges in crowded_nodes(grid):
        nodes = (node, *(end for edge in edges for end in edge))
        point = _point(np.mean([grid.planes[:, i, j] for i, j in nodes[1:]], axis=0))
        lines = ", ".join(f"{s}-{t}" for s, t in edges)
        message = (
            f"no valid grid exists: round {_text(point)} there is no place for the inner node {node}, which must lie "
            f"to the left of each line through the boundary's nodes {lines}. Take more cells across the neck, or place "
            "the boundary's nodes otherwise there"
        )
        found.append(Certificate("neck", nodes, point, {}, message))
    return found


def _conflict(grid: Grid, conflict: Conflict) -> Certificate:
    """Return the certificate of cells that cannot all be valid."""
    ni, nj = grid.shape
    nodes = tuple(node for cell in conflict.cells for node in nodes_of(cell))
    fixed = {(i, j) for i, j in nodes if i in (0, ni - 1) or j in (0, nj - 1)}
    point = _point(np.mean([grid.planes[:, i, j] for i, j in sorted(fixed or set(nodes))], axis=0))
    named = ", ".join(map(str, conflict.cells[:_MOST_NAMED]))
    more = f" and {len(conflict.cells) - _MOST_NAMED} more" if len(conflict.cells) > _MOST_NAMED else ""
    message = (
        f"no valid grid exists: near {_text(point)} there is no room for the inner nodes: wherever they are, not all "
        f"of the {len(conflict.cells)} cells {named}{more} can be valid while every other cell is. Take more cells "
        "there, or place the boundary's nodes otherwise"
    )
    return Certificate("conflict", nodes, point, {"cells": len(conflict.cells)}, message)


def _corner_places(ni: int, nj: int) -> NDArray[np.intp]:
    """Return where the four logical corners stand in `boundary_indices`."""
    return np.array([0, ni - 1, ni + nj - 2, 2 * ni + nj - 3])


def _nodes(index: NDArray[np.intp], *places: int) -> tuple[Node, ...]:
    """Return the indices (i, j) of places in the ring, counted round it."""
    return tuple((int(i), int(j)) for i, j in index[np.array(places) % len(index)])


def _point(xy: FloatArray) -> tuple[float, float]:
    return float(xy[0]), float(xy[1])


def _text(point: tuple[float, float]) -> str:
    """Return a point as text for a message."""
    return f"({point[0]:.6g}, {point[1]:.6g})"
