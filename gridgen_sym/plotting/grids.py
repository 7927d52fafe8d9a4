"""Pictures of grids, drawn with Matplotlib, which is loaded only here and only when a picture is wanted."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..atomic import write_bytes
from ..errors import GridgenError, MissingExtraError, quoted
from ..grids.grid import Grid, check_grid
from ..grids.quality import quality
from ..topology.multiblock import MultiBlock
from .layouts import draw_blocks, write_names
from .legend import write_legend
from .under import draw_under
from .wall_panel import draw_wall_panel, thinnest_wall

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..fields.scalar import ScalarField, Source

MOST_LINES = 260  # Along each axis: more would run together to a black area, and make huge vector files.
_LARGEST = 1e300  # Extents of larger coordinates overflow.
MOST_FOLDS = 20_000  # Of more folded cells every n-th is drawn; all are counted.
_SQUARE = 3.6  # Inches of each side of a panel with a square grid.
_TITLE = 0.7  # A panel with a slender grid is so much of that wide, for its title.
_WRITTEN = 0.9  # Inches of the height that go to the title, the ticks and the legend.
_PANEL = 3.2  # Inches that the panel of a wall takes beside the picture.
_INK, _EDGE, ALARM = "#26323d", "#0b1016", "#d7191c"


def plot_grid(
    grid: Grid | MultiBlock,
    path: str | os.PathLike[str] | None = None,
    *,
    title: str | None = None,
    ax: Axes | None = None,
    under: ScalarField | Source | None = None,
) -> Figure:
    """Draw a grid: its lines, its boundary a little thicker, its folded cells red and counted.

    Of several blocks the edges are thicker, their names stand at their middles, and named boundaries have colors, which
    the legend explains. Where the first cells of a wall are too thin to be seen, a panel beside the picture shows some.

    Args:
        grid: the grid; with more than 260 lines along an axis only every n-th is drawn, and the title says so.
        path: where to write the picture (``.png``, ``.pdf`` or ``.svg``), completely or not at all; None to write
            nothing.
        title: the text above the picture.
        ax: axes to draw on, without a panel for walls; None to make a figure for it.
        under: a field that is drawn with the grid, below its lines, such as the depth of water: a formula in x and y, a
            function of two arrays, samples (`raster_field`, `scattered_field`), or an array at the nodes or in the
            cells. Where it has no value nothing is drawn.

    Returns:
        The figure, which belongs to no window and no global state.

    Raises:
        MissingExtraError: if Matplotlib is not installed.
        GridgenError: if the picture's suffix is unknown or it cannot be written.
    """
    check_drawable(grid)
    wall = thinnest_wall(grid) if ax is None else None
    panel = None
    if ax is None:
        ax, panel = _axes(grid, wall is not None)
    if under is not None:
        draw_under(ax, _blocks(grid), under, "right" if panel is None else "left")
    draw_grid(ax, grid, title)
    if wall is not None and panel is not None:
        draw_wall_panel(panel, ax, wall)
    figure = ax.figure.figure  # The axes may be in a subfigure: take the whole figure.
    if path is not None:
        save(figure, path)
    return figure


def plot_grids(
    grids: Sequence[tuple[str, Grid | MultiBlock]], path: str | os.PathLike[str] | None = None, *, columns: int = 3
) -> Figure:
    """Draw several grids side by side, each with its title; otherwise as `plot_grid`.

    Args:
        grids: pairs of a title and a grid, at least one.
        path: where to write the picture; None to write nothing.
        columns: how many panels are in a row.

    Raises:
        GridgenError: if there are no grids or no columns, and as for `plot_grid`.
        MissingExtraError: if Matplotlib is not installed.
    """
    if not isinstance(grids, Sequence):
        raise GridgenError(f"a picture in panels takes a list of pairs of a title and a grid; came {quoted(grids)}")
    if not grids or columns < 1:
        raise GridgenError(f"a picture in panels needs a grid and a column, but has {len(grids)} and {columns}")
    for pair in grids:
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise GridgenError(f"a picture in panels takes pairs of a title and a grid; came {quoted(pair)}")
        check_drawable(pair[1])
    across = min(columns, len(grids))
    down = -(-len(grids) // across)
    width, height = np.max([_proportions(grid) for _, grid in grids], axis=0)
    figure = new_figure(_SQUARE * max(width, _TITLE) * across, (_WRITTEN + (_SQUARE - _WRITTEN) * height) * down)
    for k, (title, grid) in enumerate(grids):
        draw_grid(figure.add_subplot(down, across, k + 1), grid, title, ink=0.6)
    if path is not None:
        save(figure, path)
    return figure


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure, made without pyplot and so without its global state."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("drawing a picture", "plot", "matplotlib") from error
    return Figure(figsize=(width, height), layout="constrained")


def check_drawable(grid: Grid | MultiBlock) -> None:
    """Raise a `GridgenError` unless this is a grid of one or several blocks that can be drawn."""
    if not isinstance(grid, MultiBlock):
        check_grid(grid)
    largest = max(float(np.abs(block.planes).max()) for block in _blocks(grid))
    if largest > _LARGEST:
        raise GridgenError(f"the grid's coordinates reach {largest:.3g}, too large to draw: scale them")


def _blocks(grid: Grid | MultiBlock) -> Sequence[Grid]:
    return grid.blocks if isinstance(grid, MultiBlock) else (grid,)


def _proportions(grid: Grid | MultiBlock) -> tuple[float, float]:
    """Return the width and the height of a grid, of which the larger one is 1."""
    halves = np.concatenate([block.planes.reshape(2, -1) / 2 for block in _blocks(grid)], axis=1)
    width, height = np.ptp(halves, axis=1).tolist()
    largest = max(width, height)
    return (width / largest, height / largest) if largest > 0 else (1.0, 1.0)


def _axes(grid: Grid | MultiBlock, with_panel: bool) -> tuple[Axes, Axes | None]:
    """Return axes of a new figure with about the proportions of the grid, and a panel at their right."""
    inches = [1.0 + 6.0 * max(side, 0.3) for side in _proportions(grid)]
    if not with_panel:
        return new_figure(*inches).add_subplot(), None
    figure = new_figure(inches[0] + _PANEL, max(inches[1], _PANEL))
    columns = figure.add_gridspec(1, 2, width_ratios=(inches[0], _PANEL))
    return figure.add_subplot(columns[0]), figure.add_subplot(columns[1])


def draw_grid(ax: Axes, grid: Grid | MultiBlock, title: str | None, ink: float = 1.0) -> None:
    """Draw one grid on axes; `ink` scales the widths of its lines, for small panels."""
    from matplotlib.collections import LineCollection

    blocks = _blocks(grid)
    most = max(max(block.shape) for block in blocks)
    step = max(1, -(-most // MOST_LINES))
    # With fewer lines each can be thicker; in the thinnest the cells can still be distinguished.
    width = ink * float(np.clip(30.0 / most, 0.25, 0.8))
    lines = [line for block in blocks for line in _lines(block, step)]
    ax.add_collection(LineCollection(lines, colors=_INK, linewidths=width, zorder=2))
    if isinstance(grid, Grid):
        xy = grid.xy
        sides = [xy[:, 0], xy[-1], xy[:, -1], xy[0]]
        ax.add_collection(LineCollection(sides, colors=_EDGE, linewidths=width + 0.6 * ink, zorder=3, capstyle="round"))
    else:
        draw_blocks(ax, grid, width)
    scale = _mark_folds(ax, blocks)
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.margins(0.04)
    ax.tick_params(labelsize=7, color="#8a949e", labelcolor="#56616b")
    for spine in ax.spines.values():
        spine.set_color("#c9d0d6")
    thinned = f"one line in {step} is drawn" if step > 1 else ""
    text = "\n".join(part for part in (title, thinned) if part)
    if text:
        ax.set_title(text, fontsize=10)
    write_legend(ax, scale)
    if isinstance(grid, MultiBlock):
        write_names(ax, grid)


def _lines(grid: Grid, step: int) -> list[Array]:
    """Return every `step`-th grid line of either family; the boundary is drawn separately."""
    xy = grid.xy
    return [*xy[::step], *(xy[:, j] for j in range(0, xy.shape[1], step))]


def _mark_folds(ax: Axes, blocks: Sequence[Grid]) -> float:
    """Fill the folded cells, and mark their centers with dots that stay visible in any grid.

    Returns:
        How many times larger the dots are to be in the legend.
    """
    from matplotlib.collections import PolyCollection

    reports = [quality(block) for block in blocks]
    count = sum(report.folded_cells for report in reports)
    if count == 0:
        return 1.0
    every = -(-count // MOST_FOLDS)
    cells, centers = [], []
    for block, report in zip(blocks, reports, strict=True):
        i, j = report.folded[::every].T
        cells.append(block.planes[:, [i, i + 1, i + 1, i], [j, j, j + 1, j + 1]].transpose(2, 1, 0))
        centers.append(report.folded_centers[::every])
    corners = list(np.concatenate(cells))
    ax.add_collection(PolyCollection(corners, facecolors=ALARM, edgecolors="none", alpha=0.5, zorder=4))
    x, y = np.concatenate(centers).T
    ax.plot(
        x,
        y,
        linestyle="none",
        marker="o",
        markersize=3 if count <= 200 else 1.5,
        markeredgewidth=0,
        color=ALARM,
        zorder=5,
        label=f"{count} folded cell{'s' if count > 1 else ''}",
    )
    return 1.0 if count <= 200 else 2.0


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write the picture, completely or not at all."""
    suffix = Path(path).suffix.lower().removeprefix(".")
    known = figure.canvas.get_supported_filetypes()
    if suffix not in known:
        raise GridgenError(
            f"cannot write the picture {path}: its suffix must be one of "
            f"{', '.join('.' + key for key in sorted(known))}"
        )
    stream = io.BytesIO()
    # The first pass of the layout does not yet know the panels of equal scales, and cuts their titles off.
    figure.draw_without_rendering()
    figure.savefig(stream, format=suffix, dpi=160, bbox_inches="tight", pad_inches=0.06)
    write_bytes(path, stream.getvalue())
