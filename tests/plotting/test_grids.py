"""Pictures of grids."""

from __future__ import annotations

import itertools
import pickle
import subprocess
import sys

import numpy as np
import pytest
from layouts import butterfly, cut

from gridgen_sym.boundary import domain
from gridgen_sym.boundary.sides import Sides
from gridgen_sym.errors import GridgenError, MissingExtraError
from gridgen_sym.fields import as_scalar
from gridgen_sym.grids import Grid, quality
from gridgen_sym.plotting import plot_grid, plot_grids
from gridgen_sym.topology import MultiBlock

pytest.importorskip("matplotlib")
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

RED = np.array([0xD7, 0x19, 0x1C])


def parts(ax):
    """The numbers of line collections' lines, and of filled cells."""
    lines = [len(c.get_segments()) for c in ax.collections if isinstance(c, LineCollection)]
    cells = [len(c.get_paths()) for c in ax.collections if isinstance(c, PolyCollection)]
    return lines, cells


def red_pixels(path):
    """How many pixels of a PNG are nearly the color of folded cells."""
    from matplotlib.image import imread

    pixels = imread(path)[..., :3] * 255
    return int((np.abs(pixels - RED).max(axis=-1) < 25).sum())


def test_a_valid_grid(tmp_path):
    figure = plot_grid(domain("wavy", 9, 7), tmp_path / "wavy.png", title="wavy")
    (ax,) = figure.axes
    assert parts(ax) == ([16, 4], [])
    assert ax.get_title() == "wavy"
    assert ax.get_legend() is None
    assert ax.get_aspect() == 1.0
    assert (tmp_path / "wavy.png").read_bytes().startswith(b"\x89PNG")
    assert red_pixels(tmp_path / "wavy.png") == 0
    assert [p.name for p in tmp_path.iterdir()] == ["wavy.png"]


def test_folded_cells_are_filled_and_counted():
    figure = plot_grid(domain("swan", 41, 41))
    (ax,) = figure.axes
    assert parts(ax) == ([82, 4], [57])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["57 folded cells"]


def test_one_tiny_folded_cell_is_seen(tmp_path):
    xy = domain("square", 601, 601).xy
    xy[300, 300] = xy[299, 299] + 0.45 / 600  # Over the diagonal of one cell that is a pixel wide.
    figure = plot_grid(Grid(xy), tmp_path / "tiny.png")
    (ax,) = figure.axes
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["1 folded cell"]
    assert red_pixels(tmp_path / "tiny.png") > 40  # The marker in the legend has about 35 by itself.


def test_a_large_grid_is_thinned_and_says_so():
    figure = plot_grid(domain("square", 1025, 513), title="large")
    (ax,) = figure.axes
    assert ax.get_title() == "large\none line in 4 is drawn"
    lines, _ = parts(ax)
    assert lines[0] == 257 + 129


def test_panels(tmp_path):
    figure = plot_grids([(name, domain(name, 9, 9)) for name in ("swan", "zee", "naca", "wavy")], tmp_path / "p.png")
    assert [ax.get_title() for ax in figure.axes] == ["swan", "zee", "naca", "wavy"]
    assert (tmp_path / "p.png").stat().st_size > 10_000
    for grids, columns in (([], 3), ([("a", domain("square", 3, 3))], 0)):
        with pytest.raises(GridgenError, match="needs a grid and a column"):
            plot_grids(grids, columns=columns)


def test_panels_have_the_proportions_of_their_grids():
    square = domain("square", 5, 5).xy
    for stretch, slender in (((1, 1), False), ((1, 4), True)):
        width, height = plot_grids([("a", Grid(square * stretch)), ("b", Grid(square * stretch))]).get_size_inches()
        assert (width < 1.5 * height) == slender


def test_names_are_written_as_they_are():
    names = ["$x_{$", "_wall", "a$b"]
    square = domain("square", 5, 5)
    layout = MultiBlock(
        {names[0]: square}, boundaries={n: [(0, s)] for n, s in zip(names, Sides._fields, strict=False)}
    )
    figure = plot_grid(layout, under=as_scalar(lambda x, y: x, names[0]))
    legend = figure.axes[0].get_legend().get_texts()
    assert [text.get_text().strip().replace(r"\$", "$") for text in legend] == names
    figure.draw_without_rendering()


def test_legends_take_as_few_rows_as_there_is_room_for():
    layout = butterfly(4, 3)
    sides = [("south", "bottom"), ("east", "bottom"), ("north", "bottom"), ("west", "bottom")]

    def columns(names):
        named = MultiBlock(
            dict(zip(layout.names, layout.blocks, strict=True)),
            boundaries={name: [side] for name, side in zip(names, sides, strict=True)},
        )
        return plot_grid(named).axes[0].get_legend()._ncols

    assert columns(["a", "b", "c", "d"]) == 4
    assert columns(["a boundary with a long name " + end for end in "abcd"]) == 2


def test_axes_of_the_caller():
    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert plot_grid(domain("square", 4, 4), ax=right) is figure
    assert parts(left) == ([], [])
    assert parts(right) == ([8, 4], [])
    inner = figure.subfigures(1, 1).add_subplot()
    assert plot_grid(domain("square", 4, 4), ax=inner) is figure


def test_what_is_no_grid_is_refused():
    for draw, match in (
        (lambda: plot_grid(domain("square", 4, 4).xy), "expected a Grid, came ndarray"),
        (lambda: plot_grids([("a", domain("square", 4, 4).xy)]), "expected a Grid, came ndarray"),
        (lambda: plot_grids([domain("square", 4, 4)]), "takes pairs of a title and a grid; came Grid"),
    ):
        with pytest.raises(GridgenError, match=match):
            draw()


def test_degenerate_grids_are_drawn_without_warnings(tmp_path):
    for xy in (
        np.ones((3, 3, 2)),
        np.stack(np.meshgrid(np.arange(3.0), np.zeros(3), indexing="ij"), axis=-1),
    ):
        plot_grid(Grid(xy), tmp_path / "degenerate.png")


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_kinds_of_pictures(tmp_path, suffix):
    plot_grid(domain("square", 4, 4), tmp_path / f"picture.{suffix}")
    assert (tmp_path / f"picture.{suffix}").stat().st_size > 1000


def test_bad_places(tmp_path):
    square = domain("square", 4, 4)
    for name in ("picture.xyz", "picture"):
        with pytest.raises(GridgenError, match=r"suffix must be one of .*\.png"):
            plot_grid(square, tmp_path / name)
    with pytest.raises(GridgenError, match="does not exist"):
        plot_grid(square, tmp_path / "none" / "picture.png")
    assert list(tmp_path.iterdir()) == []


def test_pyplot_is_not_loaded():
    code = (
        "import sys, gridgen_sym as g; g.plot_grid(g.domain('square', 4, 4)); print('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_without_matplotlib_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    for draw in (lambda g: plot_grid(g), lambda g: plot_grids([("a", g)])):
        with pytest.raises(MissingExtraError, match=r"gridgen-sym\[plot\]") as caught:
            draw(domain("square", 4, 4))
    back = pickle.loads(pickle.dumps(caught.value))  # As from a worker process, whose pool would break otherwise.
    assert type(back) is MissingExtraError
    assert str(back) == str(caught.value)


@pytest.mark.parametrize("size", [1e-300, 1e300, 1.7e308])
def test_huge_and_tiny_grids_are_drawn_or_refused_without_a_warning(size):
    grid = Grid((domain("square", 5, 5).xy * 2 - 1) * size)
    if size <= 1e300:
        plot_grid(grid)
    else:
        with pytest.raises(GridgenError, match=r"coordinates reach 1.7e\+308, too large to draw: scale them"):
            plot_grid(grid)


@pytest.mark.parametrize("stretch", [(1, 1), (8, 1), (1, 8)])
def test_the_legend_stands_below_the_tick_labels(stretch):
    xy = domain("square", 11, 11).xy
    xy[5, 5] = 0.9
    figure = plot_grid(Grid(xy * stretch))
    figure.draw_without_rendering()
    axes = figure.axes[0]
    legend = axes.get_legend().get_window_extent()
    labels = [label.get_window_extent() for label in axes.get_xticklabels() if label.get_text()]
    assert len(labels) > 1
    assert not any(legend.overlaps(label) for label in labels)
    assert legend.y1 < min(label.y0 for label in labels)


def test_blocks_have_names_edges_and_boundaries(tmp_path):
    layout = butterfly(4, 3)
    named = MultiBlock(
        dict(zip(layout.names, layout.blocks, strict=True)),
        boundaries={"wall": [("south", "bottom"), ("east", "bottom")], "hot": [("north", "bottom", (1, 3))]},
    )
    figure = plot_grid(named, tmp_path / "pipe.png", title="a pipe")
    (ax,) = figure.axes
    assert [text.get_text() for text in ax.texts] == [*layout.names]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["wall", "hot"]
    colors = [line.get_color() for line in ax.lines]
    assert len(colors) == 3
    assert colors[0] == colors[1] != colors[2]
    assert ax.lines[2].get_xydata() == pytest.approx(named["north"].xy[1:4, 0])
    # Edges of blocks are thicker than the lines inside, and nothing lies over the names, nor they over each other.
    inside, edges = ax.collections
    assert len(edges.get_segments()) == 4 * 5
    assert edges.get_linewidth()[0] > inside.get_linewidth()[0]
    assert min(text.get_zorder() for text in ax.texts) > max(one.get_zorder() for one in (*ax.lines, *ax.collections))
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in ax.texts]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))


def test_names_without_room_are_smaller():
    first, second = cut(domain("square", 9, 9), (0, 4, 8), (0, 8)).blocks

    def size(letters):
        figure = plot_grid(MultiBlock({"a" * letters: first, "b" * letters: second}))
        return figure.axes[0].texts[0].get_fontsize()

    assert size(10) == 9
    assert 4 < size(50) < 9


def test_the_name_of_a_block_stands_where_its_area_is():
    clustered = Grid(np.stack(np.meshgrid(np.arange(5.0), np.geomspace(1e-3, 1, 21), indexing="ij"), axis=-1))
    (text,) = plot_grid(MultiBlock({"only": clustered})).axes[0].texts
    assert text.get_position() == pytest.approx((2, (1e-3 + 1) / 2))
    assert not plot_grid(MultiBlock([clustered])).axes[0].texts  # There is nothing to distinguish.


def test_folded_cells_of_all_blocks_are_counted():
    layout = cut(domain("zee", 17, 17), (0, 8, 16), (0, 4, 16))
    (ax,) = plot_grids([("folded", layout)]).axes
    count = sum(quality(block).folded_cells for block in layout.blocks)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [f"{count} folded cells"]
    assert len(ax.lines[-1].get_xydata()) == count
