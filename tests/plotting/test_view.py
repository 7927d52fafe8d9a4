"""Pages that show a grid, without a browser: what they hold."""

from __future__ import annotations

import base64
import html
import json
import re
import zlib

import numpy as np
import pytest
from click.testing import CliRunner
from layouts import butterfly

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.plotting.notebook import MOST_NODES
from gridgen_sym.plotting.view_data import packed, view_data

REFERENCES = re.compile(r"""(?:src|href)\s*=\s*["'](?!data:)|url\(|@import|fetch\(|XMLHttpRequest|import\(""")


def unpacked(text, shape):
    """The doubles of a packed text, by another way than the page's: cumulative sums of whole numbers."""
    raw = zlib.decompress(base64.b64decode(text))
    bits = np.frombuffer(raw, np.uint8).reshape(8, -1).T.copy().view("<u8").reshape(shape)
    for _ in range(2):
        bits = np.cumsum(bits, axis=-1, dtype=np.uint64)
    return bits.view("<f8")


def data_of(page):
    (text,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page)
    return json.loads(text)


@pytest.mark.parametrize("scale", [1.0, 1e-300, -1e300])
def test_nodes_are_packed_bit_by_bit(scale):
    values = np.random.default_rng(1).standard_normal((2, 7, 5)) * scale
    values[0, 0, :3] = 0.0, -0.0, np.nan
    assert unpacked(packed(values), values.shape).tobytes() == values.tobytes()


def test_a_page_of_a_large_grid_takes_half_of_its_bytes():
    grid = gg.domain("swan", 201, 201)
    assert len(gg.view_grid(grid)) < grid.planes.nbytes / 2


def test_a_page_refers_to_nothing_else(tmp_path):
    page = gg.view_grid(gg.domain("swan", 9, 9), tmp_path / "swan.html", title="a <b> & c")
    assert (tmp_path / "swan.html").read_text(encoding="utf-8") == page
    assert "<title>a &lt;b&gt; &amp; c</title>" in page
    assert REFERENCES.search(page) is None
    assert REFERENCES.search('<img src="x.png">') is not None
    assert "$" not in re.sub(r"<script>.*?</script>", "", page, flags=re.DOTALL)


def test_a_name_cannot_end_the_data():
    names = ("</script><script>alert(1)</script>", "b", "c", "d", "e")
    layout = gg.MultiBlock(dict(zip(names, butterfly(4, 3).blocks, strict=True)))
    page = gg.view_grid(layout)
    assert "alert(1)</script>" not in page
    assert [block["name"] for block in data_of(page)["blocks"]] == [*names]


def test_blocks_boundaries_and_fields_are_there():
    layout = gg.layout("pipe")
    data = data_of(gg.view_grid(layout, under="x + 2*y"))
    assert data["named"] is True
    assert data["field"] == "x + 2*y"
    assert [part["name"] for part in data["boundaries"]] == [*layout.boundaries]
    for block, grid in zip(data["blocks"], layout.blocks, strict=True):
        assert np.array_equal(unpacked(block["nodes"], (2, *block["shape"])), grid.planes)
        assert np.array_equal(unpacked(block["field"], block["shape"]), grid.x + 2 * grid.y)


def test_a_field_has_no_value_outside_its_samples():
    field = gg.raster_field(np.linspace(0, 0.5, 5), np.linspace(0, 1, 5), np.ones((5, 5)))
    (block,) = data_of(gg.view_grid(gg.domain("square", 5, 5), under=field))["blocks"]
    assert np.array_equal(np.isnan(unpacked(block["field"], (5, 5))), gg.domain("square", 5, 5).x > 0.5)


def test_a_thinned_grid_keeps_its_last_lines_and_its_folds():
    grid = gg.domain("swan", 32, 38)
    (block,) = view_data(grid, most=100)["blocks"]
    step = block["steps"][0]
    assert step == 4
    rows, columns = ([*range(0, count, step), count - 1] for count in grid.shape)
    rows = sorted({*rows})
    assert np.array_equal(unpacked(block["nodes"], (2, *block["shape"])), grid.planes[:, rows][:, :, columns])
    i, j = gg.quality(grid).folded.T
    expected = {(np.searchsorted(rows, a, "right") - 1, np.searchsorted(columns, b, "right") - 1) for a, b in zip(i, j)}  # noqa: B905
    assert {divmod(cell, block["shape"][1] - 1) for cell in block["folded"]} == expected
    assert expected


@pytest.mark.parametrize("made", [gg.domain("swan", 9, 9), gg.layout("pipe")], ids=["grid", "layout"])
def test_notebooks_show_a_page_in_a_frame(made):
    shown = made._repr_html_()
    assert html.escape(repr(made)) in shown
    (frame,) = re.findall(r'srcdoc="([^"]*)"', shown)
    assert data_of(html.unescape(frame))["blocks"][0]["steps"] == [1, 1]
    assert 'sandbox="allow-scripts"' in shown


def test_notebooks_show_results_and_thin_large_grids():
    result = gg.optimize(gg.domain("wavy", 9, 9), "winslow")
    assert html.escape(str(result)) in result._repr_html_()
    adapted = gg.adapt(gg.domain("square", 9, 9), "tanh(9*(x + y - 1))", max_iterations=1)
    assert html.escape(str(adapted)) in adapted._repr_html_()
    large = gg.domain("square", 1025, 513)
    shown = large._repr_html_()
    assert len(shown) < 20 * MOST_NODES
    assert "One line in 8 is shown" in shown


def test_the_command_writes_a_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    gg.domain("swan", 9, 9).write("swan.vts")
    opened = []
    monkeypatch.setattr("click.launch", opened.append)
    told = CliRunner().invoke(main, ["view", "swan.vts", "--under", "x*y"])
    assert told.output == "wrote swan.vts.html\n"
    assert data_of((tmp_path / "swan.vts.html").read_text(encoding="utf-8"))["field"] == "x*y"
    assert opened == []
    told = CliRunner().invoke(main, ["view", "swan.vts", "-o", "page.html", "--open"])
    assert told.exit_code == 0
    assert opened == [str(tmp_path / "page.html")]
    for arguments, match in ((["-o", "page.png"], "suffix of a page is .html"), (["--under", "x*"], "x\\*")):
        told = CliRunner().invoke(main, ["view", "swan.vts", *arguments])
        assert told.exit_code == 2
        assert re.search(match, told.output)


def test_what_is_no_grid_or_no_page_is_refused(tmp_path):
    square = gg.domain("square", 4, 4)
    for grid, name, match in (
        (square.xy, None, "expected a Grid"),
        (square, "page.png", "must be .html"),
        (square, "none/page.html", "does not exist"),
        (gg.Grid((square.xy - 0.5) * 1e301), None, "too large to draw"),
    ):
        with pytest.raises(gg.GridgenError, match=match):
            gg.view_grid(grid, None if name is None else tmp_path / name)
