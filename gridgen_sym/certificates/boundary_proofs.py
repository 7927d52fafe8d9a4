"""Quick proofs that no valid grid exists, from the boundary nodes alone.

In a grid whose corner Jacobians are all positive every cell is a convex quadrilateral with positive orientation. So its
corners have angles below 180 degrees, its map covers no point a negative number of times, its boundary turns through
360 degrees in all, and its area is positive. Each certificate contradicts one of these, by exact arithmetic. A boundary
that touches or overlaps itself may still have a valid grid: an annulus that is cut open, or a spiral.

A search (`search.py`) takes longer and proves much more.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..boundary.polygon import first_repeated, inner_angles, proper_crossings, turns, winding_number
from ..boundary.predicates import area_sign, orientation
from ..grids.grid import Grid, boundary_indices
from .certificate import Certificate, point_of, point_text
from .node_constraints import Node, infeasible_nodes

# Of very many crossings the first are tested, each at these distances from it, as fractions of the shorter edge.
_MOST_CROSSINGS, _DISTANCES = 200, (0.25, 0.05, 0.01, 1e-3)


def boundary_proofs(grid: Grid, check: Callable[[], object] | None = None) -> list[Certificate]:
    """Return the certificates that need no search; what `check`, called where it takes long, raises ends the work."""
    index = boundary_indices(*grid.shape)
    ring = np.ascontiguousarray(grid.planes[:, index[:, 0], index[:, 1]].T)
    found = certify_coincident(ring, index)
    if found:
        return found
    turn, back = turns(ring)
    with np.errstate(over="ignore", invalid="ignore"):  # Huge coordinates may spoil a reported point, but no proof.
        found = _crossing(ring, index, None if back.any() else float(turn.sum()), check)
        if not found and area_sign(ring) <= 0:
            return [_clockwise(ring)]
        found += certify_corners(ring, index, grid.shape) + certify_spikes(ring, index, turn, back, grid.shape)
        return found or _necks(grid, check)


def certify_coincident(
    ring: Array, index: NDArray[np.intp], among: NDArray[np.bool_] | None = None
) -> list[Certificate]:
    """Certify an edge of the boundary without length, of those that are `among`: both corners at it have J = 0."""
    k = first_repeated(ring, among)
    if k is None:
        return []
    nodes, point = _nodes(index, k, k + 1), point_of(ring[k])
    message = (
        f"no valid grid exists: the boundary nodes {nodes[0]} and {nodes[1]} are one point, {point_text(point)}; "
        "move them apart"
    )
    return [Certificate("coincident", nodes, point, {}, message)]


def _crossing(
    ring: Array, index: NDArray[np.intp], turn: float | None, check: Callable[[], object] | None
) -> list[Certificate]:
    """Certify a boundary that crosses itself and winds backwards around some point, or turns too little or too much."""
    crossings = proper_crossings(ring, check)
    numbers: dict[str, float] = {"crossings": len(crossings)}
    for count, (a, b) in enumerate(crossings[:_MOST_CROSSINGS]):
        if check is not None and count:
            check()
        witness = _negative_winding(ring, a, b)
        if witness:
            (x, y), winding = witness
            numbers |= {"winding": winding, "x": x, "y": y}
            proof = f"its winding number, counter-clockwise, about the point {point_text((x, y))} is {winding}"
            return [_crossing_certificate(_nodes(index, a, a + 1, b, b + 1), _meeting(ring, a, b), numbers, proof)]
    whole = 1 if turn is None else round(turn / (2 * np.pi))
    if crossings and abs(whole) != 1:
        a, b = crossings[0]
        numbers |= {"turn": 360.0 * whole}
        proof = f"it turns through {360 * whole} degrees in all instead of 360"
        return [_crossing_certificate(_nodes(index, a, a + 1, b, b + 1), _meeting(ring, a, b), numbers, proof)]
    return []


def _crossing_certificate(
    nodes: tuple[Node, ...], meeting: Array, numbers: dict[str, float], proof: str
) -> Certificate:
    """Return the certificate of two edges that cross, given by their ends."""
    more = f" (and at {numbers['crossings'] - 1} more points)" if numbers["crossings"] > 1 else ""
    message = (
        f"no valid grid exists: the boundary crosses itself at {point_text(point_of(meeting))}, where the edge "
        f"{nodes[0]}-{nodes[1]} meets the edge {nodes[2]}-{nodes[3]}{more}; {proof}. Repair the boundary there, or "
        "take more nodes if it is sampled from a curve that does not cross itself"
    )
    return Certificate("crossing", nodes, point_of(meeting), numbers, message)


def _negative_winding(ring: Array, a: int, b: int) -> tuple[tuple[float, float], int] | None:
    """Return a point to the right of two edges that cross, near them, around which the boundary winds backwards."""
    end = np.roll(ring, -1, axis=0)
    one, other = end[a] - ring[a], end[b] - ring[b]
    sign = float(orientation(ring[a], end[a], end[b])[0])
    lengths = np.hypot(*one), np.hypot(*other)
    away = sign * (one / lengths[0] - other / lengths[1])  # To the right of both.
    for distance in _DISTANCES:
        at = _meeting(ring, a, b) + distance * min(lengths) * away
        winding = winding_number(ring, at) if np.isfinite(at).all() else None
        if winding is not None and winding < 0:
            return point_of(at), winding
    return None


def _meeting(ring: Array, a: int, b: int) -> Array:
    """Return about where two edges cross."""
    p, q = ring[a], ring[b]
    one, other = np.roll(ring, -1, axis=0)[[a, b]] - (p, q)
    scale = np.abs((one, other)).max()
    one_unit, other_unit, apart = one / scale, other / scale, (q - p) / scale
    cross = one_unit[0] * other_unit[1] - one_unit[1] * other_unit[0]
    part = (apart[0] * other_unit[1] - apart[1] * other_unit[0]) / cross if cross else 0.5
    return np.asarray(p + np.clip(part, 0.0, 1.0) * one)


def _clockwise(ring: Array) -> Certificate:
    """Certify a boundary whose area is not positive: the area of a grid is the sum of the areas of its cells."""
    message = (
        "no valid grid exists: the boundary runs clockwise, or encloses no area. Make it run counter-clockwise: "
        "exchange left and right, Grid(grid.xy[::-1])"
    )
    return Certificate("clockwise", (), point_of(ring.mean(axis=0)), {}, message)


def certify_corners(ring: Array, index: NDArray[np.intp], shape: tuple[int, int]) -> list[Certificate]:
    """Certify logical corners whose three nodes, all fixed, do not turn to the left: J <= 0 there in every grid."""
    at = _corner_positions(*shape)
    previous, following = ring[at - 1], ring[(at + 1) % len(ring)]
    signs = orientation(previous, ring[at], following)
    angles = inner_angles(previous, ring[at], following)
    found = []
    for corner in np.flatnonzero(signs <= 0).tolist():
        k, angle = int(at[corner]), float(angles[corner])
        nodes, point = _nodes(index, k - 1, k, k + 1), point_of(ring[k])
        message = (
            f"no valid grid exists: at corner {corner}, node {nodes[1]} at {point_text(point)}, the boundary turns the "
            f"wrong way: its inner angle is {angle:.4g} degrees and must be less than 180, and the node and its two "
            "neighbors are fixed. Choose a corner where the boundary turns to the left, take more nodes if the curve "
            "itself turns to the left here, or move the neighbors along the boundary"
        )
        found.append(Certificate("corner", nodes, point, {"corner": corner, "angle": angle}, message))
    return found


def certify_spikes(
    ring: Array, index: NDArray[np.intp], turn: Array, back: NDArray[np.bool_], shape: tuple[int, int]
) -> list[Certificate]:
    """Certify nodes on a side where the boundary runs back on itself: two cells cannot share an angle of 0 or 360."""
    found = []
    for k in np.setdiff1d(np.flatnonzero(back), _corner_positions(*shape)).tolist():
        nodes, point = _nodes(index, k - 1, k, k + 1), point_of(ring[k])
        message = (
            f"no valid grid exists: at node {nodes[1]} at {point_text(point)} the boundary runs back on itself; its "
            "inner angle is 0 or 360 degrees and must lie between them. Open the spike, or move the node from its tip"
        )
        found.append(Certificate("spike", nodes, point, {"angle": 180.0 - float(np.degrees(turn[k]))}, message))
    return found


def _necks(grid: Grid, check: Callable[[], object] | None) -> list[Certificate]:
    """Certify inner nodes next to so much boundary that they have no feasible position."""
    found = []
    for node, edges in infeasible_nodes(grid, check):
        nodes = (node, *(end for edge in edges for end in edge))
        point = point_of(np.mean([grid.planes[:, i, j] for i, j in nodes[1:]], axis=0))
        lines = ", ".join(f"{s}-{t}" for s, t in edges)
        message = (
            f"no valid grid exists: near {point_text(point)} the inner node {node} has no feasible position: it "
            f"must lie to the left of each line through the boundary nodes {lines}. Take more cells across the neck, "
            "or move the boundary nodes there"
        )
        found.append(Certificate("neck", nodes, point, {}, message))
    return found


def _corner_positions(ni: int, nj: int) -> NDArray[np.intp]:
    """Return the positions of the four logical corners in `boundary_indices`."""
    return np.array([0, ni - 1, ni + nj - 2, 2 * ni + nj - 3])


def _nodes(index: NDArray[np.intp], *positions: int) -> tuple[Node, ...]:
    """Return the indices (i, j) of positions in the ring, counted around it."""
    return tuple((int(i), int(j)) for i, j in index[np.array(positions) % len(index)])
