"""Certificates of several blocks: of those whose whole boundary stays, and of corners and spikes of the outer boundary.

A proof for a block takes all nodes of its boundary as fixed. Nodes on a connection move, so that of a connected block
only what three neighbors of the outer boundary prove is left. Blocks that make up a plain grid are one block.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..boundary.polygon import turns
from ..grids import Grid
from ..grids.grid import boundary_indices
from ..topology import MultiBlock
from ..topology.merging import joined_names, merge
from ..topology.outer_lines import Edge, outer_edges
from .boundary_proofs import certify_coincident, certify_corners, certify_spikes
from .certificate import Certificate


def layout_certificates(
    layout: MultiBlock, prove: Callable[[Grid], tuple[Certificate, ...]]
) -> dict[str, tuple[Certificate, ...]]:
    """Return the certificates of a layout by the names of blocks; those without any are left out.

    Args:
        layout: whose outer boundary stays.
        prove: finds those of one block with a fixed boundary.
    """
    merged, outer = merge(layout), outer_edges(layout)
    connected = {part.block for bond in merged.layout.bonds for part in (bond.one, bond.other)}
    proofs = {}
    for number, together in enumerate(merged.layout.blocks):
        parts = [block for block, place in enumerate(merged.places) if place.block == number]
        if number not in connected:
            proofs[joined_names(layout, parts)] = _of_plain_grid(together, len(parts), prove)
            continue
        for block in parts:
            edges = [edge for edge in outer if edge[0] == block]
            proofs[layout.names[block]] = _of_outer_boundary(layout.blocks[block], edges)
    return {name: found for name, found in proofs.items() if found}


def _of_plain_grid(
    grid: Grid, blocks: int, prove: Callable[[Grid], tuple[Certificate, ...]]
) -> tuple[Certificate, ...]:
    """Return the proofs of blocks that make up a plain grid, whose whole boundary stays."""
    if blocks == 1:
        return prove(grid)
    ni, nj = grid.shape
    said = f" (Nodes are counted as in one block of {ni} x {nj} nodes, which {blocks} blocks make up.)"
    return tuple(replace(one, message=one.message + said) for one in prove(grid))


def _of_outer_boundary(grid: Grid, outer: Sequence[Edge]) -> tuple[Certificate, ...]:
    """Return what neighbors on the outer boundary of a connected block prove, of which the edges are given."""
    stays = _outer_edges_of_ring(outer, grid.shape)
    index = boundary_indices(*grid.shape)
    ring = np.ascontiguousarray(grid.planes[:, index[:, 0], index[:, 1]].T)
    found = certify_coincident(ring, index, stays)
    if found:
        return tuple(found)
    turn, back = turns(ring)
    between = stays & np.roll(stays, 1)
    proofs = [
        *certify_corners(ring, index, grid.shape),
        *certify_spikes(ring, index, turn, back & between, grid.shape),
    ]
    fixed = {(int(i), int(j)) for i, j in index[between]}
    return tuple(one for one in proofs if one.nodes[1] in fixed)


def _outer_edges_of_ring(edges: Sequence[Edge], shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Return which edges of a block's boundary are outer ones, counter-clockwise from the first node."""
    along = {"bottom": shape[0] - 1, "right": shape[1] - 1, "top": shape[0] - 1, "left": shape[1] - 1}
    sides = {side: np.zeros(count, dtype=bool) for side, count in along.items()}
    for _, side, number in edges:
        sides[side][number] = True
    return np.concatenate((sides["bottom"], sides["right"], sides["top"][::-1], sides["left"][::-1]))
