"""No text of a picture lies over another one, and legends explain what is drawn beside the grid."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from click.testing import CliRunner
from support_walls import clustered

import gridgen_sym as gg
from gridgen_sym.cli import main

pytest.importorskip("matplotlib")
from matplotlib.text import Text


def overlaps(figure):
    """Pairs of texts that lie over each other: titles, ticks, legends, labels, names of blocks."""
    figure.draw_without_rendering()
    boxes = []
    for text in figure.findobj(Text):
        if text.get_visible() and text.get_text().strip() and shown(text):
            box = text.get_window_extent()
            boxes.append((text.get_text(), box.x0 + 0.5, box.x1 - 0.5, box.y0 + 0.5, box.y1 - 0.5))
    return [
        (a[0], b[0])
        for a, b in itertools.combinations(boxes, 2)
        if a[1] < b[2] and b[1] < a[2] and a[3] < b[4] and b[3] < a[4]
    ]


def shown(text):
    """Whether a text is drawn: labels of ticks outside of their axis are kept, and not drawn."""
    for axes in text.figure.axes:
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if text is tick.label1 or text is tick.label2:
                    return low <= tick.get_loc() <= high
    return True


def many_names(layout):
    """The layout with its boundaries named by long names, many of them."""
    sides = ("bottom", "right", "top", "left")
    parts = [(name, side) for name in layout.names for side in sides]
    outer = {}
    for name, side in parts:
        block = layout.names.index(name)
        mask = layout.outer[block]
        edge = {"bottom": mask[:, 0], "top": mask[:, -1], "left": mask[0], "right": mask[-1]}[side]
        if edge.all():
            outer[f"a boundary named {name} {side}"] = [(name, side)]
    return gg.MultiBlock(dict(zip(layout.names, layout.blocks, strict=True)), boundaries=outer)


PICTURES = {
    "folded": (gg.domain("swan", 31, 31), {}),
    "wide": (gg.Grid(gg.domain("swan", 21, 21).xy * (9, 1)), {"title": "a title over a wide grid"}),
    "tall": (gg.Grid(gg.domain("swan", 21, 21).xy * (1, 9)), {"under": "x*y"}),
    "pipe": (gg.layout("pipe"), {"under": "x + y", "title": "pipe"}),
    "hole": (gg.layout("channel_with_hole"), {}),
    "names": (many_names(gg.layout("square_with_hole")), {"under": "x*y"}),
    "wye": (gg.layout("wye"), {}),
    "wall": (clustered(1e-6), {"title": "a wall"}),
    "wall, field": (clustered(1e-6), {"under": "1000*x", "title": "a wall"}),
}


#: One of each kind; the others are for the slow tier.
QUICK = ("folded", "names", "wall, field")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in PICTURES]
)
def test_no_text_lies_over_another(name):
    grid, options = PICTURES[name]
    assert overlaps(gg.plot_grid(grid, **options)) == []


def test_texts_over_each_other_are_found():
    figure = gg.plot_grid(gg.domain("square", 5, 5), title="a title")
    figure.axes[0].set_xticks([0.5, 0.52])
    assert overlaps(figure) != []


@pytest.mark.parametrize("side", ["bottom", "right", "top", "left"])
def test_first_cells_too_thin_to_be_seen_are_shown_beside(side):
    grid = clustered(1e-6)
    turned = {
        "bottom": grid.planes,
        "top": grid.planes[:, ::-1, ::-1],
        "left": grid.planes.transpose(0, 2, 1)[:, :, ::-1],
        "right": grid.planes.transpose(0, 2, 1)[:, ::-1],
    }[side]
    whole, panel = gg.plot_grid(gg.Grid.from_planes(*turned)).axes
    assert panel.get_title().startswith(f"at {side}: first cells 1.0")
    (lines,) = panel.collections
    segments = np.array(lines.get_segments()[9:])
    # The lines along the wall follow the nine off it: straight at the wall, and as far off it as the cells are high.
    assert np.abs(segments[0, :, 1]).max() < 1e-12
    heights = segments[1:3, 4, 1]
    expected = np.hypot(*(grid.planes[:, 20, 1:3] - grid.planes[:, 20, :1]))
    assert heights == pytest.approx(expected, rel=0.05)
    marked = whole.lines[-1].get_xydata()[0]
    assert np.abs(marked - grid.xy[20, 0]).max() < 0.03


def test_grids_whose_first_cells_are_seen_have_no_panel():
    for grid in (clustered(1e-2), gg.domain("square", 1201, 21), gg.layout("pipe"), gg.domain("swan", 21, 21)):
        assert len(gg.plot_grid(grid).axes) == 1


def test_connections_are_no_walls():
    grid = clustered(1e-6)
    mirror = gg.Grid(np.stack([grid.x[::-1], 2 * grid.y[::-1, :1] - grid.y[::-1]], axis=-1))
    assert len(gg.plot_grid(gg.MultiBlock({"above": grid, "below": mirror})).axes) == 1
    assert len(gg.plot_grid(gg.MultiBlock({"above": grid, "below": mirror}, connections=[])).axes) == 2


def test_a_field_is_drawn_under_the_lines_where_it_has_values(tmp_path):
    square = gg.domain("square", 9, 9)
    half = gg.raster_field(np.linspace(0, 0.5, 5), np.linspace(0, 1, 5), np.ones((5, 5)))
    for under, covered in (
        ("x + y", 1.0),
        (half, 0.5),
        (square.x, 1.0),
        (np.ones((8, 8)), 1.0),
        ("sqrt(x - 0.5)", 0.5),
    ):
        ax, bar = gg.plot_grid(square, under=under).axes
        (mesh,) = (one for one in (*ax.images, *ax.collections) if one.get_array() is not None)
        assert mesh.get_zorder() < min(one.get_zorder() for one in ax.collections if one is not mesh)
        assert ax.get_aspect() == 1.0
        values = np.ma.masked_invalid(mesh.get_array())
        assert values.count() / values.size == pytest.approx(covered, abs=0.1)
        assert bar.get_ylabel() == (under if isinstance(under, str) else "")
    gg.plot_grid(square, tmp_path / "under.png", under="x")
    for grid, under, match in (
        (gg.layout("pipe"), np.ones((3, 3)), "belongs to one grid"),
        (square, "sqrt(-1 - x**2)", "no value in the picture"),
        (square, "x +", "the field"),
    ):
        with pytest.raises(gg.GridgenError, match=match):
            gg.plot_grid(grid, under=under)


def test_commands_draw_a_field_under_the_grid(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    gg.domain("wavy", 9, 9).write("wavy.vts")
    x = np.linspace(-1, 2, 9)
    np.savez("depth.npz", x=x, y=x, values=np.add.outer(x, x))
    told = CliRunner().invoke(main, ["quality", "wavy.vts", "--plot", "a.png", "--under", "depth.npz"])
    assert told.exit_code == 0, told.output
    told = CliRunner().invoke(main, ["quality", "wavy.vts", "--plot", "b.png"])
    assert (tmp_path / "a.png").stat().st_size > 1.5 * (tmp_path / "b.png").stat().st_size
    told = CliRunner().invoke(main, ["quality", "wavy.vts", "--under", "depth.npz"])
    assert told.exit_code == 2
    assert "give --plot PNG" in told.output
