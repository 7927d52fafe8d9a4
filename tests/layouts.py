"""Layouts that tests of topology and of solvers share."""

from __future__ import annotations

import itertools

import numpy as np

import gridgen_sym as gg


def cut(grid, columns, rows):
    """The grid as blocks between these lines i and j, ends included."""
    return gg.MultiBlock(
        {
            f"{a}-{b}": gg.Grid.from_planes(*grid.planes[:, i0 : i1 + 1, j0 : j1 + 1])
            for a, (i0, i1) in enumerate(itertools.pairwise(columns))
            for b, (j0, j1) in enumerate(itertools.pairwise(rows))
        }
    )


def assembled(layout, columns, rows):
    """The planes of such blocks as one grid's."""
    planes = np.empty((2, columns[-1] + 1, rows[-1] + 1))
    blocks = iter(layout.blocks)
    for i0, i1 in itertools.pairwise(columns):
        for j0, j1 in itertools.pairwise(rows):
            planes[:, i0 : i1 + 1, j0 : j1 + 1] = next(blocks).planes
    return planes


def ring(angles, inner, outer, levels):
    """An O-grid round the origin, with J > 0: nodes at these angles, of which the last is the first, a turn later."""
    part = np.linspace(0, 1, levels)
    along = np.exp(-1j * np.asarray(angles))
    inside, outside = (along * np.asarray(radius) for radius in (inner, outer))
    nodes = inside[:, None] * (1 - part) + outside[:, None] * part
    return gg.Grid.from_planes(nodes.real, nodes.imag)


def butterfly(cells, around):
    """A pipe's cross-section: a square of cells x cells, and four blocks round it with `around` cells to the circle."""
    s, t = np.linspace(-1, 1, cells + 1), np.linspace(0, 1, around + 1)
    blocks = {"core": gg.Grid(np.stack(np.meshgrid(0.4 * s, 0.4 * s, indexing="ij"), axis=-1))}
    edge = np.stack((0.4 * s, np.full_like(s, -0.4)), axis=-1)
    angle = -np.pi / 2 + np.pi / 4 * s
    arc = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    for k, name in enumerate(("south", "east", "north", "west")):
        c, d = round(np.cos(k * np.pi / 2)), round(np.sin(k * np.pi / 2))
        turn = np.array([[c, -d], [d, c]])
        nodes = (arc[:, None] * (1 - t)[:, None] + edge[:, None] * t[:, None]) @ turn.T
        blocks[name] = gg.Grid(nodes)
    return gg.MultiBlock(blocks)


def valences(layout):
    """How many cells meet at each node, for each block (ni, nj); all copies of a node alike."""
    found = []
    for grid in layout.blocks:
        cells = np.zeros(grid.shape, dtype=int)
        for i, j in itertools.product((slice(None, -1), slice(1, None)), repeat=2):
            cells[i, j] += 1
        found.append(cells)
    copies = layout.copies
    entries = list(zip(copies.block, copies.i, copies.j, strict=True))
    for begin, end in itertools.pairwise([*copies.starts, len(entries)]):
        total = sum(found[b][i, j] for b, i, j in entries[begin:end])
        for b, i, j in entries[begin:end]:
            found[b][i, j] = total
    return found


def kinks(layout):
    """The angles in degrees, off straight, between the edges of eta on both sides of the cut of a C-grid."""
    (bond,) = layout.bonds
    planes = layout.blocks[0].planes
    (along, _), (back, _) = bond.indices([planes.shape[1:]])
    up, down = (planes[:, i[1:-1], 1] - planes[:, i[1:-1], 0] for i in (along, back))
    cosine = -(up * down).sum(axis=0) / np.hypot(*up) / np.hypot(*down)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))
