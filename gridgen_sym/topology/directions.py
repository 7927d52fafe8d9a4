"""Directions of blocks that continue each other or run side by side: what is said of one holds for all of them."""

from __future__ import annotations

from collections.abc import Sequence

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
