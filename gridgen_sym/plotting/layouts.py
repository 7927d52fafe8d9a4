"""What a picture of several blocks has more than one of a grid: edges and names of blocks, and named boundaries."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from ..boundary.sides import Sides
from ..grids import Grid, corner_jacobians
from ..topology.connection import SidePart
from ..topology.multiblock import MultiBlock
from .names import as_written

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.text import Text

#: Colors that also those distinguish who see no red or green (Okabe and Ito 2008), without its red: folds have that.
_COLORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#8c6d31")
_STYLES = ("solid", (0, (4, 1.5)), (0, (1, 1)))
_EDGE = "#0b1016"
#: Sizes of names: the largest at which none lies over another, or, down to `_READABLE`, is wider than its block.
_FONTS, _READABLE = (9.0, 8.0, 7.0, 6.0, 5.0, 4.0), 6.0


def draw_blocks(ax: Axes, layout: MultiBlock, width: float) -> None:
    """Draw edges and names of blocks, and boundaries in colors, with their names for the legend.

    Args:
        ax: the axes, with their lines of the grid.
        layout: the blocks.
        width: of the lines of the grid.
    """
    from matplotlib.collections import LineCollection

    edges = [
        SidePart(block, side, 0, grid.shape[0 if side in ("bottom", "top") else 1] - 1).nodes(layout.blocks)
        for block, grid in enumerate(layout.blocks)
        for side in Sides._fields
    ]
    ax.add_collection(LineCollection(edges, colors=_EDGE, linewidths=width + 0.9, zorder=3, capstyle="round"))
    for number, (name, parts) in enumerate(layout.boundaries.items()):
        color, style = boundary_style(number)
        for count, part in enumerate(parts):
            label = as_written(name) if count == 0 else None
            ax.plot(
                *part.nodes(layout.blocks).T,
                color=color,
                linestyle=style,
                linewidth=width + 1.7,
                label=label,
                zorder=3.5,
            )


def boundary_style(number: int) -> tuple[str, Any]:
    """Return the color of a named boundary, and its style as Matplotlib has it."""
    return _COLORS[number % len(_COLORS)], _STYLES[number // len(_COLORS) % len(_STYLES)]


def has_names(layout: MultiBlock) -> bool:
    """Return whether the names of blocks distinguish anything."""
    return len(layout) > 1 or layout.names != ("0",)


def write_names(ax: Axes, layout: MultiBlock) -> None:
    """Write the names of blocks at their middles, over everything else and beside each other."""
    if not has_names(layout):
        return
    box = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "#c9d0d6", "linewidth": 0.6}
    look: dict[str, Any] = {"ha": "center", "va": "center", "color": _EDGE, "bbox": box, "zorder": 10, "clip_on": True}
    texts = []
    for name, grid in zip(layout.names, layout.blocks, strict=True):
        x, y = middle(grid)
        texts.append(ax.text(x, y, as_written(name), **look))
    ax.figure.figure.draw_without_rendering()
    widths = [float(np.ptp(ax.transData.transform(grid.planes.reshape(2, -1).T)[:, 0])) for grid in layout.blocks]
    for size in _FONTS:
        for text in texts:
            text.set_fontsize(size)
        wide = any(text.get_window_extent().width > width for text, width in zip(texts, widths, strict=True))
        if not _overlap(texts) and not (wide and size > _READABLE):
            break


def middle(grid: Grid) -> tuple[float, float]:
    """Return the point whose two lines halve the area of a block: its middle also where lines are clustered."""
    areas = np.abs(corner_jacobians(grid.x, grid.y)).sum(axis=0)
    planes = grid.planes
    for axis in range(2):
        sums = np.concatenate([[0.0], np.cumsum(areas.sum(axis=1 - axis))])
        at = float(np.interp(sums[-1] / 2, sums, np.arange(len(sums)))) if sums[-1] > 0 else (len(sums) - 1) / 2
        before = min(int(at), len(sums) - 2)
        first, second = planes.take(before, axis=1), planes.take(before + 1, axis=1)
        planes = np.asarray(first + (at - before) * (second - first))
    x, y = planes.tolist()
    return x, y


def _overlap(texts: list[Text]) -> bool:
    """Return whether two of the texts lie over each other, with their boxes."""
    boxes = [text.get_window_extent().padded(3.0) for text in texts]
    low, high = np.array([box.min for box in boxes]), np.array([box.max for box in boxes])
    return any(
        bool((low[a] < high[b]).all() and (low[b] < high[a]).all()) for a, b in combinations(range(len(texts)), 2)
    )
