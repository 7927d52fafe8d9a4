"""Pictures of certificates: where on the boundary, and why, no valid grid exists, or none without a sliver."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..certificates.certificate import Certificate
from ..certificates.proofs import certificates
from ..errors import GridgenError
from ..grids.grid import Grid, check_grid
from .grids import ALARM, check_drawable, draw_grid, new_figure, save
from .under import draw_under

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..fields.scalar import ScalarField, Source

MOST_PANELS = 5  # Of more certificates the first are drawn, and the others counted.
_AROUND, _CLOSE = 3.0, 1.3  # A panel shows so many times the extent of what it is about; of cells, if these are that.
_THIN = 2.0  # Cells that extend so many times as far one way as the other are stretched.
_NAMES = {
    "coincident": "two nodes at one point",
    "crossing": "the boundary crosses itself",
    "clockwise": "the boundary runs clockwise",
    "corner": "corner {corner:.0f} has {angle:.4g} degrees",
    "spike": "the boundary runs back",
    "neck": "no feasible position for an inner node",
    "conflict": "{cells:.0f} cells cannot all be valid",
    "sliver": "one of {cells:.0f} cells is a sliver",
}


def plot_certificates(
    grid: Grid,
    path: str | os.PathLike[str] | None = None,
    *,
    found: Sequence[Certificate] | None = None,
    under: ScalarField | Source | None = None,
) -> Figure:
    """Draw a grid with its certificates: the whole with numbered marks, and a panel with the nodes of each.

    Args:
        grid: the grid whose boundary is certified.
        path: where to write the picture (``.png``, ``.pdf`` or ``.svg``), completely or not at all;
            None to write nothing.
        found: the certificates; None for `certificates(grid, search=True)`.
        under: a field that is drawn with the grid, below the whole, as for `plot_grid`.

    Returns:
        The figure, which belongs to no window and no global state.

    Raises:
        GridgenError: if there is no certificate, and as for `plot_grid`.
        MissingExtraError: if Matplotlib is not installed.
    """
    check_grid(grid)
    check_drawable(grid)
    found = certificates(grid, search=True) if found is None else found
    if not found:
        raise GridgenError("a picture of certificates needs one, but the boundary of this grid has none")
    shown = found[:MOST_PANELS]
    figure = new_figure(4.2 * (1 + len(shown)), 4.6)
    whole = figure.add_subplot(1, 1 + len(shown), 1)
    more = f", {len(shown)} of {len(found)} shown" if len(found) > len(shown) else ""
    title = "no valid grid exists" if any(proof.impossible for proof in found) else "every valid grid has a sliver"
    if under is not None:
        draw_under(whole, [grid], under)
    draw_grid(whole, grid, f"{title}{more}")
    for number, certificate in enumerate(shown, start=1):
        _label(whole, certificate.point, str(number))
        axes = figure.add_subplot(1, 1 + len(shown), 1 + number)
        draw_grid(axes, grid, f"{number}: {_NAMES[certificate.kind].format(**certificate.numbers)}")
        legend = axes.get_legend()
        if legend is not None:  # One count of folded cells is enough.
            legend.remove()
        _draw_certificate(axes, grid, certificate)
    if path is not None:
        save(figure, path)
    return figure


def _draw_certificate(axes: Axes, grid: Grid, certificate: Certificate) -> None:
    """Draw the nodes and the edges of one certificate, and show their neighborhood."""
    (ni, nj), nodes = grid.shape, np.array([grid.planes[:, i, j] for i, j in certificate.nodes]).reshape(-1, 2)
    inner = np.array([0 < i < ni - 1 and 0 < j < nj - 1 for i, j in certificate.nodes], dtype=bool)
    fixed = nodes[~inner]
    axes.plot(*fixed.T, linestyle="none", marker="o", markersize=5, color=ALARM, zorder=7)
    if certificate.kind in ("conflict", "sliver"):
        _draw_cells(axes, nodes.reshape(-1, 4, 2))
        return
    for edge in _edges(nodes, certificate.kind):
        axes.plot(*edge.T, color=ALARM, linewidth=2.0, zorder=6)
    if "winding" in certificate.numbers:
        axes.plot(certificate.numbers["x"], certificate.numbers["y"], marker="x", color=ALARM, markersize=7, zorder=7)
    (x, y), reach = certificate.point, _AROUND / 2 * _extent(nodes, fixed, certificate.kind)
    if reach > 0:
        axes.set_xlim(x - reach, x + reach)
        axes.set_ylim(y - reach, y + reach)


def _draw_cells(axes: Axes, cells: Array) -> None:
    """Draw cells (n, 4, 2), and show just them; if they are a thin band, stretched so that it fills the panel."""
    for cell in cells:
        axes.fill(*cell.T, facecolor=ALARM, alpha=0.2, edgecolor=ALARM, linewidth=1.5, zorder=4)
    low, high = cells.min(axis=(0, 1)), cells.max(axis=(0, 1))
    middle, reach = (low + high) / 2, _CLOSE / 2 * (high - low)
    if reach.min() < reach.max() / _THIN:
        axes.set_aspect("auto")
        axes.title.set_text(f"{axes.get_title()} (stretched)")
    else:
        reach[:] = reach.max()
    if reach.min() > 0:
        axes.set_xlim(middle[0] - reach[0], middle[0] + reach[0])
        axes.set_ylim(middle[1] - reach[1], middle[1] + reach[1])


def _extent(nodes: Array, fixed: Array, kind: str) -> float:
    """Return how wide a panel's subject is: its nodes, or the shorter of two edges that cross; 0 to show the whole."""
    if kind in ("clockwise", "coincident"):
        return 0.0
    if kind == "crossing":
        return float(min(np.abs(nodes[1] - nodes[0]).max(), np.abs(nodes[3] - nodes[2]).max()))
    return float(np.ptp(fixed, axis=0).max())


def _edges(nodes: Array, kind: str) -> list[Array]:
    """Return the edges to draw: pairs of ends."""
    if kind in ("corner", "spike"):
        return [nodes]
    ends = nodes[1:] if kind == "neck" else nodes
    return [ends[k : k + 2] for k in range(0, len(ends), 2)]


def _label(axes: Axes, point: tuple[float, float], text: str) -> None:
    """Mark a point with a ring and a number."""
    axes.plot(*point, marker="o", markersize=12, markerfacecolor="none", markeredgecolor=ALARM, zorder=8)
    axes.annotate(text, point, xytext=(9, 7), textcoords="offset points", color=ALARM, fontsize=11, weight="bold")
