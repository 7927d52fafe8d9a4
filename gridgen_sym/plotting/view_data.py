"""What a page shows of a grid, as JSON has it: nodes as packed doubles, names, boundaries."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..grids.grid import Grid, corner_jacobians, folded_corners
from ..topology.multiblock import MultiBlock
from .layouts import boundary_style, has_names, middle

#: Of zlib: more takes twice the time for 3 % of the size.
_LEVEL = 4


def view_data(
    grid: Grid | MultiBlock, field: Mapping[str, list[Array]] | None = None, most: int | None = None
) -> dict[str, Any]:
    """Return what the page is given.

    Args:
        grid: the grid.
        field: values at the nodes of each block, by the name of what they are; or None.
        most: how many nodes are kept, about, of a larger grid every n-th; None to keep all.
    """
    blocks, names = (grid.blocks, grid.names) if isinstance(grid, MultiBlock) else ((grid,), ("0",))
    nodes = sum(block.planes[0].size for block in blocks)
    step = 1 if most is None else max(1, int(np.ceil(np.sqrt(nodes / most))))
    (label, values) = next(iter(field.items())) if field else (None, [None] * len(blocks))
    named = isinstance(grid, MultiBlock) and has_names(grid)
    shown = [_block(block, name, step, plane) for block, name, plane in zip(blocks, names, values, strict=True)]
    if named:
        for block, one in zip(blocks, shown, strict=True):
            one["middle"] = middle(block)
    boundaries = grid.boundaries if isinstance(grid, MultiBlock) and step == 1 else {}
    styles = (boundary_style(number) for number in range(len(boundaries)))
    return {
        "named": named,
        "field": label,
        "blocks": shown,
        "boundaries": [
            {
                "name": name,
                "color": color,
                "dash": [] if style == "solid" else list(style[1]),
                "parts": [[part.block, part.side, part.first, part.last] for part in parts],
            }
            for (name, parts), (color, style) in zip(boundaries.items(), styles, strict=True)
        ],
    }


def _block(grid: Grid, name: str, step: int, values: Array | None) -> dict[str, Any]:
    """Return a block with every `step`-th of its nodes, and the last ones."""
    kept = [np.unique(np.append(np.arange(0, count, step), count - 1)) for count in grid.shape]
    planes = grid.planes[:, kept[0]][:, :, kept[1]]
    return {
        "name": name,
        "shape": planes.shape[1:],
        "full": grid.shape,
        "steps": [step, step],
        "nodes": packed(planes),
        "field": None if values is None else packed(values[kept[0]][:, kept[1]]),
        "folded": None if step == 1 else _folded(grid, kept),
    }


def packed(values: Array) -> str:
    """Return doubles (..., n) as text, bit by bit: nodes that vary smoothly take about half of their bytes.

    Their bits, as whole numbers, are replaced by second differences along the last axis, modulo 2^64; of these the
    first bytes of all numbers follow each other, then the second ones, and so on; all is deflated and written in
    base64. `templates/view/decode.js` undoes it.
    """
    bits = np.ascontiguousarray(values, dtype="<f8").view("<u8")
    for _ in range(2):
        bits = np.concatenate([bits[..., :1], np.diff(bits, axis=-1)], axis=-1)
    planes = np.ascontiguousarray(bits).reshape(-1).view(np.uint8).reshape(-1, 8).T
    return base64.b64encode(zlib.compress(planes.tobytes(), _LEVEL)).decode("ascii")


def _folded(grid: Grid, kept: list[NDArray[np.intp]]) -> list[int]:
    """Return the numbers of the cells between the kept lines in which a cell of the grid is folded."""
    folds = folded_corners(corner_jacobians(grid.x, grid.y)).any(axis=0)
    for axis, lines in enumerate(kept):
        folds = np.logical_or.reduceat(folds, lines[:-1], axis=axis)
    return [int(cell) for cell in np.flatnonzero(folds)]
