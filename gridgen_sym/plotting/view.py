"""Pages that show a grid in a browser: one file each, with everything in it."""

from __future__ import annotations

import html
import json
import os
from string import Template
from typing import TYPE_CHECKING, Any

from ..arrays import Array
from ..atomic import write_bytes
from ..errors import GridgenError
from ..grids.grid import Grid
from ..resources import resource_folder
from ..topology.multiblock import MultiBlock
from ..topology.quality import LayoutQuality, quality
from ..version import __version__
from .grids import check_drawable
from .under import field_label
from .view_data import view_data

if TYPE_CHECKING:
    from ..fields.scalar import ScalarField, Source
    from ..grids import Quality

_LABELS = 30  # Columns that the labels of a report of quality take.
#: The parts of the page's program, in the order in which they use each other.
_SCRIPTS = ("decode", "measures", "tiles", "paint", "draw", "page")


def view_grid(
    grid: Grid | MultiBlock,
    path: str | os.PathLike[str] | None = None,
    *,
    title: str | None = None,
    under: ScalarField | Source | None = None,
) -> str:
    """Make a page that shows a grid in a browser: it zooms, pans, and reports the measures of the cell pointed at.

    The page is one file without any reference to others, and works offline. It holds the coordinates bit by bit; of
    large grids it draws as many lines as can be distinguished.

    Args:
        grid: the grid.
        path: where to write the page (``.html``), completely or not at all; None to write nothing.
        title: what the page is called.
        under: a field that is drawn with the grid, as for `plot_grid`: here its values are one more color of cells.

    Returns:
        The page.

    Raises:
        GridgenError: if it is no grid, the suffix is another one, or the page cannot be written.
    """
    check_drawable(grid)
    if path is not None and not os.fspath(path).lower().endswith((".html", ".htm")):
        raise GridgenError(f"cannot write the page {path}: its suffix must be .html")
    text = page(grid, title or repr(grid), quality(grid), under=under)
    if path is not None:
        write_bytes(path, text.encode("utf-8"))
    return text


def page(
    grid: Grid | MultiBlock,
    title: str,
    measured: Quality | LayoutQuality,
    *,
    under: ScalarField | Source | None = None,
    most: int | None = None,
) -> str:
    """Return the page of a grid; see `view_grid`, and `view_data` for `most`."""
    folder = resource_folder("templates") / "view"
    data = view_data(grid, None if under is None else _field(grid, under), most)
    data["folded"] = measured.folded_cells
    thinned = data["blocks"][0]["steps"][0]
    texts = {
        "version": __version__,
        "title": html.escape(title),
        "state": html.escape(measured.describe_folds(0)),
        "note": f"One line in {thinned} is shown, and measures are those of the cells between." if thinned > 1 else "",
        "quality": "".join(map(_row, measured.summary().removesuffix(measured.describe_folds()).splitlines())),
        "folds": "" if measured.valid else html.escape(measured.describe_folds()),
        "style": (folder / "page.css").read_text(encoding="utf-8"),
        "script": "\n".join((folder / f"{name}.js").read_text(encoding="utf-8") for name in _SCRIPTS),
        "data": _json(data),
    }
    return Template((folder / "page.html").read_text(encoding="utf-8")).substitute(texts)


def _row(line: str) -> str:
    """Return a line of a report as the row of a table."""
    label, value = line[:_LABELS].rstrip(), line[_LABELS:]
    return f'<tr><th scope="row">{html.escape(label)}: </th><td>{html.escape(value)}</td></tr>'


def _json(data: dict[str, Any]) -> str:
    """Return JSON that ends no element of the page."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _field(grid: Grid | MultiBlock, under: ScalarField | Source) -> dict[str, list[Array]]:
    """Return the values of a field at the nodes of each block, by its name; NaN where it has none."""
    from ..fields import as_scalar

    field = as_scalar(under, "the field")
    blocks = grid.blocks if isinstance(grid, MultiBlock) else (grid,)
    return {field_label(field): [field.known(block.x, block.y) for block in blocks]}
