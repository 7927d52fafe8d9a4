"""The steps of the logical coordinates in every block, so that a grid is the same however it is cut into blocks."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .components import component_numbers
from .connection import SidePart
from .directions import direction_groups
from .multiblock import MultiBlock


def unit_steps(layout: MultiBlock) -> list[tuple[float, float]]:
    """Return (h_xi, h_eta) for each block.

    Directions of blocks that continue each other, or run side by side, have one step. It is 1 over the number of cells
    of the shortest row of cells in such a direction from one outer side to another, through all blocks between. So one
    block has the steps of the unit square, and so has that block cut into several. A direction in which all rows close,
    round an O-grid or from pitch to pitch, has no length of its own and takes the smallest step of the others.
    """
    groups = direction_groups(layout.bonds, len(layout))
    shortest: dict[int, int] = {}
    for group, cells in zip(*_open_rows(layout, groups), strict=True):
        shortest[int(group)] = min(shortest.get(int(group), int(cells)), int(cells))
    every = sum((ni - 1) * (nj - 1) for ni, nj in (grid.shape for grid in layout.blocks))
    most = max(shortest.values(), default=max(1, round(every**0.5)))
    return [(1 / shortest.get(along_xi, most), 1 / shortest.get(along_eta, most)) for along_xi, along_eta in groups]


def _open_rows(layout: MultiBlock, groups: list[tuple[int, int]]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return the group of directions and the number of cells of every row of cells that does not close."""
    shapes = [grid.shape for grid in layout.blocks]
    # Numbers of the rows of each block: first those along xi, then those along eta.
    counts = [count - 1 for ni, nj in shapes for count in (nj, ni)]
    begin = np.cumsum([0, *counts])
    cells = np.repeat([count - 1 for shape in shapes for count in shape], counts)
    group = np.repeat([one for of_block in groups for one in of_block], counts)

    def rows(part: SidePart) -> npt.NDArray[np.intp]:
        """Return the rows that cross a part of a side, edge by edge."""
        return np.asarray(begin[2 * part.block + 1 - part.axis] + np.arange(part.first, part.last), dtype=np.intp)

    none = np.empty(0, dtype=np.intp)
    first = np.concatenate([none, *(rows(bond.one) for bond in layout.bonds)])
    second = np.concatenate([none, *(rows(b.other)[::-1] if b.reversed else rows(b.other) for b in layout.bonds)])
    label = component_numbers(first, second, len(cells))
    count = int(label.max()) + 1
    closed = np.bincount(label[first], minlength=count) == np.bincount(label, minlength=count)
    length = np.bincount(label, cells, minlength=count).astype(np.intp)
    of_row = np.zeros(count, dtype=np.intp)
    of_row[label] = group
    return of_row[~closed], length[~closed]
