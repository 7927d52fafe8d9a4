"""The steps of the logical coordinates in every block, so that a grid is the same however it is cut into blocks."""

from __future__ import annotations

from .directions import direction_groups
from .multiblock import MultiBlock

#: The axis across a side, and the side that is opposite.
_ACROSS = {"left": 0, "right": 0, "bottom": 1, "top": 1}
_OPPOSITE = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
#: The two sides that a line along an axis ends at.
_ENDS = (("left", "right"), ("bottom", "top"))


def unit_steps(layout: MultiBlock) -> list[tuple[float, float]]:
    """Return (h_xi, h_eta) for each block.

    Directions of blocks that continue each other, or run side by side, have one step. It is 1 over the number of cells
    of the longest line of blocks in such a direction, so that one block has the steps of the unit square, and so has
    that block cut into several. A direction in which lines close, round an O-grid or from pitch to pitch, has no length
    of its own and takes the smallest step of the others.
    """
    groups = direction_groups(layout.bonds, len(layout))
    lengths: dict[int, int] = {}
    closed: set[int] = set()
    for block, of_block in enumerate(groups):
        for axis, group in enumerate(of_block):
            cells = _cells_along(layout, block, axis)
            if cells is None:
                closed.add(group)
            else:
                lengths[group] = max(lengths.get(group, 0), cells)
    own = {group: cells for group, cells in lengths.items() if group not in closed}
    most = max(own.values(), default=max(max(grid.shape) - 1 for grid in layout.blocks))
    return [(1 / own.get(along_xi, most), 1 / own.get(along_eta, most)) for along_xi, along_eta in groups]


def _cells_along(layout: MultiBlock, block: int, axis: int) -> int | None:
    """Return the cells of the line of whole blocks through a block along an axis; None where it closes.

    A side that is connected with itself, as at the cut of a C-grid, ends a line.
    """
    partners: dict[tuple[int, str], tuple[int, str]] = {}
    for bond in layout.bonds:
        one, other = (bond.one.block, bond.one.side), (bond.other.block, bond.other.side)
        if one != other:
            partners[one], partners[other] = other, one
    total = layout.blocks[block].shape[axis] - 1
    for side in _ENDS[axis]:
        here, seen = (block, side), {block}
        while here in partners:
            neighbor, entered = partners[here]
            if neighbor in seen:
                return None
            seen.add(neighbor)
            total += layout.blocks[neighbor].shape[_ACROSS[entered]] - 1
            here = (neighbor, _OPPOSITE[entered])
    return total
