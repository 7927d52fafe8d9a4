"""Directions of blocks that continue each other or run side by side: what is said of one holds for all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .connection import SidePart
from .copies import Bond


def direction_groups(bonds: Sequence[Bond], blocks: int) -> list[tuple[int, int]]:
    """Return for each block the numbers of the groups that its directions, along xi and along eta, belong to."""
    parent = {(block, axis): (block, axis) for block in range(blocks) for axis in range(2)}

    def root(key: tuple[int, int]) -> tuple[int, int]:
        while parent[key] != key:
            parent[key] = parent[parent[key]]
            key = parent[key]
        return key

    for bond in bonds:
        for turn in range(2):  # Along the parts, and across them.
            one = root((bond.one.block, bond.one.axis ^ turn))
            parent[one] = root((bond.other.block, bond.other.axis ^ turn))
    numbers = {key: number for number, key in enumerate(sorted({root(key) for key in parent}))}
    return [(numbers[root((block, 0))], numbers[root((block, 1))]) for block in range(blocks)]


def halvable_groups(
    bonds: Sequence[Bond],
    groups: Sequence[tuple[int, int]],
    shapes: Sequence[tuple[int, int]],
    least: int,
    most: int,
) -> set[int]:
    """Return the groups of directions in which every second node can be left out, in all blocks alike.

    Their numbers of cells are even, and connections begin at nodes that are kept.

    Args:
        bonds: the connections.
        groups: of the directions, as from `direction_groups`.
        shapes: (ni, nj) of the blocks.
        least: the cells that every block must be left with in such a direction.
        most: groups in which no block has more cells than this stay.
    """
    odd, large = set(), set()
    for (ni, nj), of_block in zip(shapes, groups, strict=True):
        for count, group in zip((ni, nj), of_block, strict=True):
            if count % 2 == 0 or (count - 1) // 2 < least:
                odd.add(group)
            if count - 1 > most:
                large.add(group)
    for bond in bonds:
        for part in (bond.one, bond.other):
            if part.first % 2 or part.last % 2:
                odd.add(groups[part.block][part.axis])
    return large - odd


def halved_bonds(bonds: Sequence[Bond], halved: Sequence[tuple[bool, bool]]) -> list[Bond]:
    """Return the connections of the blocks with every second node."""

    def half(part: SidePart) -> SidePart:
        step = 1 + halved[part.block][part.axis]
        return replace(part, first=part.first // step, last=part.last // step)

    return [Bond(half(bond.one), half(bond.other), bond.motion) for bond in bonds]
