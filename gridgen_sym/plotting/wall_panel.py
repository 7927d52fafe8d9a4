"""A panel beside the picture of a grid, with first cells at a wall that are too thin to be seen in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array, Mask
from ..grids.grid import Grid
from ..grids.orthogonality import SIDES
from ..topology.multiblock import MultiBlock
from .names import as_written

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PIXELS = 960  # That the longer side of a grid takes in a file.
_CLUSTERED = (
    5.0  # Cells of a wall are on average so many times as high as its first ones; those of other sides are not.
)
_ALONG, _OFF = 4, 10  # The panel shows so many cells to both sides of a node, and at most so many off the wall.
_FLAT = 3.0  # It is so many times as wide as high: higher, the lines off a curved wall would meet.
_SEEN = 80.0  # It is at most so many times as high as a first cell, which can be seen then.
_COLOR = "#0072b2"


@dataclass(frozen=True, slots=True)
class ThinWall:
    """The first cells of a wall, unrolled: the wall is straight, and lines keep their angles to it.

    Attributes:
        name: of the side, with that of its block.
        point: the node of the wall that the panel is about.
        height: of the first cell there.
        lines: distances along and off the wall, shape (2, nodes along, nodes off); both are 0 at `point`.
    """

    name: str
    point: tuple[float, float]
    height: float
    lines: Array


def thinnest_wall(grid: Grid | MultiBlock) -> ThinWall | None:
    """Return the wall with the thinnest first cells, if these are less than a pixel high and the cells off it grow."""
    blocks, names = (grid.blocks, grid.names) if isinstance(grid, MultiBlock) else ((grid,), ("",))
    size = max(float(np.ptp(np.concatenate([block.planes[k].ravel() for block in blocks]))) for k in range(2))
    best: tuple[float, str, Array, Mask] | None = None
    for number, block in enumerate(blocks):
        for side in SIDES:
            lines, free = _inwards(block.planes, side), np.ones(_along(block, side), dtype=bool)
            if isinstance(grid, MultiBlock):
                _leave_out_connections(free, grid, number, side)
            heights = np.hypot(*np.diff(lines, axis=2))
            clustered = heights.mean(axis=1) > _CLUSTERED * heights[:, 0]
            walls = free & clustered & (heights[:, 0] > 0) & (heights[:, 0] < size / _PIXELS)
            if not walls.any():
                continue
            height = float(np.median(heights[walls, 0]))
            if best is None or height < best[0]:
                # Beside a wake the first cells grow away from the wall.
                near = walls & (heights[:, 0] < 1.5 * height)
                name = f"{names[number]}, {side}" if len(blocks) > 1 else side
                best = height, name, lines, near
    return None if best is None else _unrolled(*best)


def _inwards(planes: Array, side: str) -> Array:
    """Return the lines from a side inwards along the last axis."""
    return {
        "bottom": planes,
        "right": planes[:, ::-1].transpose(0, 2, 1),
        "top": planes[:, :, ::-1],
        "left": planes.transpose(0, 2, 1),
    }[side]


def _along(block: Grid, side: str) -> int:
    return block.shape[0 if side in ("bottom", "top") else 1]


def _leave_out_connections(free: Mask, grid: MultiBlock, block: int, side: str) -> None:
    """Unset the nodes of a side that are connected: no wall is there."""
    for part in (part for bond in grid.bonds for part in (bond.one, bond.other)):
        if (part.block, part.side) == (block, side):
            free[part.first : part.last + 1] = False


def _unrolled(_: float, name: str, lines: Array, near: Mask) -> ThinWall:
    """Return the panel's subject: at the node of the wall next to the middle of the side."""
    count = lines.shape[1]
    candidates = np.flatnonzero(near)
    middle = int(candidates[np.abs(candidates - (count - 1) / 2).argmin()])
    first, last = max(0, middle - _ALONG), min(count - 1, middle + _ALONG)
    wall = lines[:, first : last + 1, 0]
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(wall, axis=1)))])
    heights = np.cumsum(np.hypot(*np.diff(lines[:, middle], axis=1)))
    layers = int(np.clip(np.searchsorted(heights, min(at[-1] / _FLAT, _SEEN * heights[0])), 2, _OFF))
    nodes = lines[:, first : last + 1, : layers + 1]
    tangent = np.gradient(wall, axis=1)
    tangent /= np.maximum(np.hypot(*tangent), np.finfo(float).tiny)
    off = nodes - wall[:, :, np.newaxis]
    normal = np.stack([-tangent[1], tangent[0]])
    # Inwards is to the left of some sides and to the right of others.
    normal *= np.where((normal * off[:, :, 1]).sum(axis=0) < 0, -1.0, 1.0)
    along = (tangent[:, :, np.newaxis] * off).sum(axis=0) + (at - at[middle - first])[:, np.newaxis]
    away = (normal[:, :, np.newaxis] * off).sum(axis=0)
    x, y = wall[:, middle - first].tolist()
    return ThinWall(name, (x, y), float(np.hypot(*off[:, middle - first, 1])), np.stack([along, away]))


def draw_wall_panel(panel: Axes, whole: Axes, wall: ThinWall) -> None:
    """Draw first cells in a panel of their own, stretched off the wall, and mark on the whole where they are."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import ConnectionPatch

    lines = np.moveaxis(wall.lines, 0, -1)
    panel.add_collection(LineCollection([*lines, *lines.transpose(1, 0, 2)], colors="#26323d", linewidths=0.7))
    panel.plot(*wall.lines[:, :, 0], color=_COLOR, linewidth=2.2, solid_capstyle="butt")
    panel.autoscale_view()
    panel.margins(0.04)
    panel.set_box_aspect(1.0)
    wide, high = np.ptp(wall.lines[0]), np.ptp(wall.lines[1])
    times = float(f"{wide / high:.3g}")
    panel.set_title(
        f"at {as_written(wall.name)}: first cells {wall.height:.3g} high,\ndrawn {times:g} times as high",
        fontsize=8,
    )
    # What is written off the wall stands at the right, away from the line to the whole.
    panel.yaxis.tick_right()
    panel.yaxis.set_label_position("right")
    panel.locator_params(axis="x", nbins=4)
    panel.set_xlabel("along the wall", fontsize=8)
    panel.set_ylabel("off the wall", fontsize=8)
    panel.ticklabel_format(style="sci", scilimits=(-3, 4), useMathText=True)
    panel.tick_params(labelsize=7, color="#8a949e", labelcolor="#56616b")
    for text in (panel.xaxis.get_offset_text(), panel.yaxis.get_offset_text()):
        text.set_fontsize(7)
    for spine in panel.spines.values():
        spine.set_color(_COLOR)
    whole.plot(*wall.point, marker="o", markersize=7, markerfacecolor="none", markeredgecolor=_COLOR, zorder=8)
    link = ConnectionPatch(
        wall.point, (0.0, 0.5), "data", panel.transAxes, axesA=whole, axesB=panel, color=_COLOR, linewidth=0.8, zorder=1
    )
    whole.figure.figure.add_artist(link)
