"""Blocks put together, and taken apart again."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from layouts import butterfly, cut, ring

import gridgen_sym as gg
from gridgen_sym.topology.merging import merge

WAVY = gg.domain("wavy", 13, 17)


def turned_cut(quarters):
    """Three blocks of a grid, each turned by so many quarters more than the one before."""
    blocks = []
    for number, (begin, end) in enumerate(((0, 4), (4, 6), (6, 12))):
        planes = WAVY.planes[:, begin : end + 1]
        for _ in range(quarters * number):
            planes = planes.transpose(0, 2, 1)[:, ::-1]
        blocks.append(gg.Grid.from_planes(*planes))
    return gg.MultiBlock(blocks)


def around(count):
    """An O-grid in so many blocks."""
    nodes = ring(np.linspace(0, 2 * np.pi, 25), 1.0, 2.0, 9).planes
    lines = np.linspace(0, 24, count + 1).astype(int)
    return gg.MultiBlock([gg.Grid.from_planes(*nodes[:, a : b + 1]) for a, b in itertools.pairwise(lines)])


@pytest.mark.parametrize(
    ("layout", "shapes", "bonds"),
    [
        (cut(WAVY, (0, 4, 12), (0, 6, 10, 16)), [(13, 17)], 0),
        *((turned_cut(quarters), [(13, 17)], 0) for quarters in range(4)),
        (around(4), [(25, 9)], 1),
        (around(1), [(25, 9)], 1),
        (butterfly(8, 6), [(9, 9), (33, 7)], 5),
    ],
)
def test_blocks_are_put_together_and_taken_apart(layout, shapes, bonds):
    merged = merge(layout)
    assert sorted(sorted(grid.shape) for grid in merged.layout.blocks) == sorted(sorted(shape) for shape in shapes)
    assert len(merged.layout.bonds) == bonds
    assert merged.layout.node_count == layout.node_count
    assert gg.energy(merged.layout, "winslow") == pytest.approx(gg.energy(layout, "winslow"), rel=1e-13)
    parts = merged.split([grid.planes for grid in merged.layout.blocks])
    assert all(np.array_equal(part, grid.planes) for part, grid in zip(parts, layout.blocks, strict=True))
    again = merged.join(parts)
    assert all(np.array_equal(a.planes, b.planes) for a, b in zip(again.blocks, merged.layout.blocks, strict=True))


def test_what_is_connected_in_part_or_moved_stays_apart():
    square = gg.domain("square", 5, 7)
    pitch = gg.MultiBlock([square], [gg.Connection((0, "bottom"), (0, "top"), translation=(0, 1))])
    assert len(merge(pitch).layout) == 1
    upper = gg.Grid.from_planes(square.x, square.y + 1)
    both = [gg.Connection((0, "top"), (1, "bottom")), gg.Connection((1, "top"), (0, "bottom"), translation=(0, -2))]
    merged = merge(gg.MultiBlock([square, upper], both)).layout
    assert [grid.shape for grid in merged.blocks] in ([(5, 13)], [(13, 5)])
    (bond,) = merged.bonds
    assert np.hypot(*bond.motion.shift) == pytest.approx(2)
    long = gg.Grid.from_planes(*np.meshgrid(np.linspace(0, 2, 9), np.linspace(1, 2, 4), indexing="ij"))
    assert len(merge(gg.MultiBlock([square, long], [gg.Connection((0, "top"), (1, "bottom", (0, 4)))])).layout) == 2
