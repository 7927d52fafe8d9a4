"""A field under the lines of a grid, such as the depth of water."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError
from ..grids.grid import Grid
from .names import as_written

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

    from ..fields.scalar import ScalarField, Source

_SAMPLES = 400  # Along the longer side of a picture: about two pixels each.
_MARGIN = 0.04
_UNNAMED = "field"
_COLORS, _OPACITY = "YlGnBu", 0.6  # Dark lines are seen on them.


def field_label(field: ScalarField) -> str:
    """Return what a legend calls a field: its formula, or its name."""
    return field.source if isinstance(field.source, str) else field.name.removeprefix("the ")


def draw_under(ax: Axes, blocks: Sequence[Grid], under: ScalarField | Source, bar_at: str = "right") -> None:
    """Draw a field on axes that show grids, with a bar beside them that explains its colors.

    A function of position is drawn in the whole picture, where it has values; numbers of one grid are drawn in it.

    Raises:
        GridgenError: if the field has no value anywhere, or numbers of one grid are given for several blocks.
    """
    from ..fields import as_scalar

    field = as_scalar(under, f"the {_UNNAMED}")
    if field.per_node and len(blocks) > 1:
        raise GridgenError(
            f"the field is an array, which belongs to one grid, and here are {len(blocks)} blocks: give a formula, a "
            "function or samples"
        )
    x, y = (blocks[0].x, blocks[0].y) if field.per_node else _raster(blocks)
    values = np.ma.masked_invalid(field.known(x, y))
    if not values.count():
        raise GridgenError("the field to be drawn has no value in the picture: do its samples cover the grid?")
    look: dict[str, Any] = {"cmap": _COLORS, "alpha": _OPACITY, "zorder": 0}
    image: ScalarMappable
    if field.per_node:
        image = ax.pcolormesh(x, y, values, shading="gouraud", rasterized=True, **look)
    else:
        box = (x[0, 0], x[-1, 0], y[0, 0], y[0, -1])
        image = ax.imshow(values.T, origin="lower", extent=box, interpolation="bilinear", **look)
    bar = ax.figure.colorbar(image, ax=ax, location=bar_at, shrink=0.8, aspect=30, pad=0.02)
    bar.ax.tick_params(labelsize=7, color="#8a949e", labelcolor="#56616b")
    bar.outline.set_edgecolor("#c9d0d6")
    if field_label(field) != _UNNAMED:
        bar.set_label(as_written(field_label(field)), fontsize=8)


def _raster(blocks: Sequence[Grid]) -> tuple[Array, Array]:
    """Return the points of a raster over the box that the grids take, with a margin."""
    corners = np.array([[plane.min(), plane.max()] for block in blocks for plane in block.planes]).reshape(-1, 2, 2)
    low, high = corners[:, :, 0].min(axis=0), corners[:, :, 1].max(axis=0)
    margin, longer = _MARGIN * (high - low), (high - low).max()
    counts = np.maximum(2, np.ceil(_SAMPLES * (high - low) / (longer or 1.0))).astype(int)
    axes = [np.linspace(low[k] - margin[k], high[k] + margin[k], counts[k]) for k in range(2)]
    x, y = np.meshgrid(*axes, indexing="ij")
    return x, y
