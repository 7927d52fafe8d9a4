"""Which lines a coarser layout leaves out: in all blocks alike, never two neighbors, and about every second one."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from layouts import butterfly, cut, ring

import gridgen_sym as gg
from gridgen_sym.topology.directions import direction_groups
from gridgen_sym.topology.lines import Lines


def cascade():
    """Blocks that meet in parts of sides, beginning at odd nodes, one of them turned."""
    x = np.linspace(0, 1, 15)
    low = gg.Grid.from_planes(*np.meshgrid(x, np.linspace(0, 1, 6), indexing="ij"))
    left = gg.Grid.from_planes(*np.meshgrid(x[:6], np.linspace(1, 2, 8), indexing="ij"))
    right = gg.Grid(
        np.stack(np.meshgrid(x[5:], np.linspace(1, 2, 8), indexing="ij"), axis=-1).transpose(1, 0, 2)[:, ::-1]
    )
    return gg.MultiBlock({"low": low, "left": left, "right": right})


def c_grid(cells):
    """A C round a plate: its cut connects two parts of one side, in opposite directions."""
    wake = np.linspace(2, 1, 6)
    inside = np.concatenate((wake[:-1], np.exp(-1j * np.linspace(0, 2 * np.pi, cells + 1)), wake[-2::-1]))
    outside = 3 * np.exp(1j * np.linspace(-0.1, -2 * np.pi + 0.1, len(inside)))
    part = np.linspace(0, 1, 8)
    nodes = inside[:, None] * (1 - part) + outside[:, None] * part
    return gg.MultiBlock([gg.Grid.from_planes(nodes.real, nodes.imag)])


LAYOUTS = {
    "even": lambda: cut(gg.domain("wavy", 17, 33), (0, 4, 16), (0, 16, 20, 32)),
    "odd": lambda: cut(gg.domain("wavy", 14, 20), (0, 5, 13), (0, 6, 19)),
    "ring": lambda: gg.MultiBlock([ring(np.linspace(0, 2 * np.pi, 34), 1.0, 3.0, 8)]),
    "pipe": lambda: butterfly(7, 5),
    "parts": cascade,
    "C, odd": lambda: c_grid(17),
    "C, even": lambda: c_grid(18),
}


@pytest.mark.parametrize("make", LAYOUTS.values(), ids=LAYOUTS)
def test_coarser_layouts_are_layouts(make):
    layout = make()
    assert layout.bonds
    groups = direction_groups(layout.bonds, len(layout))
    lines = Lines.of(layout.bonds, groups, [grid.shape for grid in layout.blocks])
    nodes = [layout.node_count]
    while found := lines.groups(2, 2):
        coarsening = lines.coarsening(found, 2)
        coarse = layout.coarsened(coarsening)
        for grid, fine, kept in zip(coarse.blocks, layout.blocks, coarsening.kept, strict=True):
            for count, one in zip(fine.shape, kept, strict=True):
                assert one[0] == 0
                assert one[-1] == count - 1
                assert np.diff(one).max() <= 2
            assert np.array_equal(grid.planes, fine.planes[:, *np.ix_(*kept)])
        # Its copies are those that its own connections have.
        connections = [gg.Connection(_part(bond.one), _part(bond.other)) for bond in coarse.bonds]
        again = gg.MultiBlock(coarse.blocks, connections)
        assert _sorted(again.copies) == _sorted(coarse.copies)
        assert all(np.array_equal(a, b) for a, b in zip(again.outer, coarse.outer, strict=True))
        layout, lines = coarse, lines.coarsened(coarsening)
        nodes.append(layout.node_count)
    assert all(after <= 0.45 * before for before, after in itertools.pairwise(nodes[:3]))
    assert nodes[-1] <= 40


def _part(part):
    return part.block, part.side, (part.first, part.last)


def _sorted(copies):
    ends = itertools.pairwise([*copies.starts, len(copies.block)])
    entries = list(zip(copies.block.tolist(), copies.i.tolist(), copies.j.tolist(), strict=True))
    return sorted(sorted(entries[a:b]) for a, b in ends)


def test_every_second_line_is_left_out_where_numbers_of_cells_are_even():
    layout = LAYOUTS["even"]()
    groups = direction_groups(layout.bonds, len(layout))
    lines = Lines.of(layout.bonds, groups, [grid.shape for grid in layout.blocks])
    for grid, kept in zip(layout.blocks, lines.coarsening(lines.groups(2, 4), 2).kept, strict=True):
        assert [one.tolist() for one in kept] == [list(range(0, count, 2)) for count in grid.shape]
    assert len(lines.groups(2, 4)) == 2
    assert lines.groups(16, 4) == set()
    assert lines.groups(2, 32) == set()
