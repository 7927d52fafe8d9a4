"""What notebooks show of a grid."""

from __future__ import annotations

import html

from ..grids.grid import Grid
from ..topology.multiblock import MultiBlock
from ..topology.quality import quality
from .view import page

MOST_NODES = 10_000  # About 100 kB of a notebook; of a larger grid every n-th line is shown.
_HEIGHT = 460  # In pixels.


def html_of(grid: Grid | MultiBlock, caption: str | None = None) -> str:
    """Return a grid's page in a frame of its own, below its name and state, which stay where frames are removed.

    Args:
        grid: the grid.
        caption: how it was made.
    """
    measured = quality(grid)
    lines = [repr(grid), *filter(None, [caption]), measured.describe_folds(0)]
    text = page(grid, repr(grid), measured, most=MOST_NODES)
    return (
        f"<p>{'<br>'.join(map(html.escape, lines))}</p>"
        f'<iframe title="{html.escape(repr(grid))}" srcdoc="{html.escape(text)}" sandbox="allow-scripts" '
        f'style="width: 100%; height: {_HEIGHT}px; border: 0"></iframe>'
    )
