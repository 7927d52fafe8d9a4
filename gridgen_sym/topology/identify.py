"""From connected parts of sides to the copies of every node, checked: no node may be in two places."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Mask
from ..errors import GridgenError
from ..grids import Grid
from .components import component_numbers
from .connection import Motion, SidePart
from .copies import Bond, Copies, Indices

#: Copies of a node may lie apart by this part of the shortest edge there, or by what rounding explains.
_APART, _ROUNDING = 1e-3, 64 * float(np.finfo(float).eps)
#: Motions that differ by less, over the size of the layout, are the same.
_SAME = 1e-9


class Identified(NamedTuple):
    """What connections make of blocks.

    Attributes:
        copies: the nodes with several copies.
        planes: for each block the coordinates (2, ni, nj), with equal copies.
        outer: for each block the mask (ni, nj) of the nodes on the outer boundary; all copies of a node alike.
    """

    copies: Copies
    planes: list[Array]
    outer: list[Mask]


class _Pairs(NamedTuple):
    """Nodes that are the same, pair by pair, by their numbers, and the bond that says so."""

    first: Indices
    second: Indices
    bond: Indices


def identify(blocks: Sequence[Grid], bonds: Sequence[Bond], names: Sequence[str]) -> Identified:
    """Find the copies of every node.

    Raises:
        GridgenError: where copies lie apart, or connections lead back to a free node at another place.
    """
    shapes = [grid.shape for grid in blocks]
    offsets = np.cumsum([0, *(ni * nj for ni, nj in shapes)])
    pairs = _pairs(bonds, shapes, offsets)
    entries, starts = _together(pairs, int(offsets[-1]))
    block = np.searchsorted(offsets, entries, side="right") - 1
    i, j = np.divmod(entries - offsets[block], np.array([nj for _, nj in shapes])[block])
    motions = _motions(bonds, pairs, entries)
    copies = Copies(starts, block, i, j, motions[:2])
    flat = np.concatenate([grid.planes.reshape(2, -1) for grid in blocks], axis=1)
    points = _moved(motions, np.repeat(flat[:, entries[starts]], copies.counts, axis=1))
    _check_together(copies, points, flat[:, entries], blocks, names)
    held = np.concatenate([mask.ravel() for mask in _outer_nodes(bonds, shapes)])
    if len(entries):
        held[entries] = np.repeat(np.maximum.reduceat(held[entries], starts), copies.counts)
        _check_ways(bonds, pairs, entries, motions, held, names)
        flat[:, entries] = points
    cut = zip(offsets[:-1], offsets[1:], shapes, strict=True)
    spans = [(slice(begin, end), shape) for begin, end, shape in cut]
    planes = [flat[:, span].reshape(2, *shape) for span, shape in spans]
    return Identified(copies, planes, [held[span].reshape(shape) for span, shape in spans])


def _pairs(bonds: Sequence[Bond], shapes: Sequence[tuple[int, int]], offsets: Indices) -> _Pairs:
    parts: list[list[Indices]] = [[np.empty(0, np.intp)] for _ in range(3)]
    for number, bond in enumerate(bonds):
        for part, (i, j), found in zip((bond.one, bond.other), bond.indices(shapes), parts[:2], strict=True):
            found.append(offsets[part.block] + i * shapes[part.block][1] + j)
        parts[2].append(np.full(bond.one.count, number, dtype=np.intp))
    return _Pairs(*(np.concatenate(part) for part in parts))


def _together(pairs: _Pairs, count: int) -> tuple[Indices, Indices]:
    """Return the numbers of all nodes that have copies, copies together, and where those of each node begin."""
    labels = component_numbers(pairs.first, pairs.second, count)
    entries = np.flatnonzero(np.bincount(labels)[labels] > 1)
    entries = entries[np.argsort(labels[entries], kind="stable")]
    return entries, np.flatnonzero(np.diff(labels[entries], prepend=-1))


def _motions(bonds: Sequence[Bond], pairs: _Pairs, entries: Indices) -> Array:
    """Return cosine, sine and shift of the motion from the first copy of a node to each of its copies, (4, entries).

    Motions are composed over the fewest bonds. Another way may lead elsewhere, which is checked afterwards.
    """
    found = np.zeros((4, len(entries)))
    found[0] = 1.0
    if all(bond.motion == Motion() for bond in bonds):
        return found
    forth = [_numbers(bond.motion) for bond in bonds]
    partners: dict[int, list[tuple[int, Array]]] = {}
    for a, b, bond in zip(*(part.tolist() for part in pairs), strict=True):
        partners.setdefault(a, []).append((b, forth[bond]))
        partners.setdefault(b, []).append((a, _inverse(forth[bond])))
    known: dict[int, Array] = {}
    for start in entries.tolist():
        if start in known:
            continue
        known[start], waiting = np.array([1.0, 0.0, 0.0, 0.0]), [start]
        for node in waiting:
            for other, motion in partners[node]:
                if other not in known:
                    known[other] = _after(motion, known[node])
                    waiting.append(other)
    return np.array([known[node] for node in entries.tolist()]).T.copy()


def _numbers(motion: Motion) -> Array:
    turn = motion.matrix if motion.angle else np.eye(2)
    return np.array([turn[0, 0], turn[1, 0], *motion.shift])


def _moved(motion: Array, points: Array) -> Array:
    """Return moved points (2, ...)."""
    c, s, x, y = motion
    return np.array([c * points[0] - s * points[1] + x, s * points[0] + c * points[1] + y])


def _after(second: Array, first: Array) -> Array:
    """Return the motion that is `first` and then `second`."""
    turn = _moved(np.array([*second[:2], 0.0, 0.0]), first[:2])
    return np.concatenate((turn, _moved(second, first[2:])))


def _inverse(motion: Array) -> Array:
    c, s, x, y = motion
    return np.array([c, -s, -(c * x + s * y), s * x - c * y])


def _outer_nodes(bonds: Sequence[Bond], shapes: Sequence[tuple[int, int]]) -> list[Mask]:
    """Return for each block the nodes at which an edge of a side ends that belongs to no bond."""
    masks = []
    for block, (ni, nj) in enumerate(shapes):
        counts = {"bottom": ni, "right": nj, "top": ni, "left": nj}
        open_edges = {side: np.ones(count - 1, dtype=bool) for side, count in counts.items()}
        for part in (part for bond in bonds for part in (bond.one, bond.other) if part.block == block):
            open_edges[part.side][part.first : part.last] = False
        mask = np.zeros((ni, nj), dtype=np.uint8)
        for side, edges in open_edges.items():
            i, j = SidePart(block, side, 0, len(edges)).indices((ni, nj))
            mask[i[:-1][edges], j[:-1][edges]] = mask[i[1:][edges], j[1:][edges]] = 1
        masks.append(mask)
    return masks


def _check_together(copies: Copies, points: Array, own: Array, blocks: Sequence[Grid], names: Sequence[str]) -> None:
    """Refuse copies that lie apart."""
    if not own.size:
        return
    size = max(float(np.abs(grid.planes).max()) for grid in blocks)
    shortest = np.empty(len(copies.block))
    for block, grid in enumerate(blocks):
        here = copies.block == block
        shortest[here] = _shortest_edges(grid.planes)[copies.i[here], copies.j[here]]
    apart = np.hypot(*(own - points))
    bad = np.flatnonzero(apart > np.maximum(_APART * shortest, _ROUNDING * size))
    if bad.size:
        entry = int(bad[np.argmax(apart[bad])])
        first = int(copies.starts[np.searchsorted(copies.starts, entry, side="right") - 1])
        here, there = (f"({copies.i[e]}, {copies.j[e]}) of block {names[copies.block[e]]}" for e in (first, entry))
        raise GridgenError(
            f"connected nodes must be at one place, but node {there} lies {apart[entry]:.3g} away from where node "
            f"{here} is ({len(bad)} such nodes): correct the connection, its translation or rotation, or the nodes"
        )


def _check_ways(
    bonds: Sequence[Bond], pairs: _Pairs, entries: Indices, motions: Array, held: Mask, names: Sequence[str]
) -> None:
    """Refuse bonds round a free node that lead back to it at another place, or turned."""
    every = np.zeros((4, len(held)))
    every[0], every[:, entries] = 1.0, motions
    for number, bond in enumerate(bonds):
        here = pairs.bond == number
        first, second = every[:, pairs.first[here]], every[:, pairs.second[here]]
        own = _numbers(bond.motion)
        turn = _moved(np.array([*own[:2], 0.0, 0.0]), first[:2])
        found = np.concatenate((turn, _moved(own, first[2:])))
        wrong = np.abs(found - second).max(axis=0) > _SAME * (1.0 + np.abs(motions).max())
        if (wrong & (held[pairs.first[here]] == 0)).any():
            raise GridgenError(
                f"the connections round a node of {bond.one.described(names)} do not lead back to it: correct a "
                "translation or rotation, or leave the edges there out of a connection, so that the node stays"
            )


def _shortest_edges(planes: Array) -> Array:
    """Return the length of the shortest edge, not of length zero, that meets at each node."""
    shortest = np.full(planes.shape[1:], np.inf)
    along_xi, along_eta = (np.hypot(*np.diff(planes, axis=axis)) for axis in (1, 2))
    for edges in (along_xi, along_eta):
        edges[edges == 0] = np.inf
    for nodes, edges in (
        (shortest[:-1], along_xi),
        (shortest[1:], along_xi),
        (shortest[:, :-1], along_eta),
        (shortest[:, 1:], along_eta),
    ):
        np.minimum(nodes, edges, out=nodes)
    return np.where(np.isfinite(shortest), shortest, 0.0)
