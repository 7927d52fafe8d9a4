"""Pages that show a grid, in a browser: what they report and draw, and how they answer to mouse, touch and keys."""

from __future__ import annotations

import base64
import io
import json

import numpy as np
import pytest
from support_browser import DESKTOP, PHONE, complaints, needs_browser, start_browser
from support_walls import clustered

import gridgen_sym as gg
from gridgen_sym.grids.grid import corner_jacobians

pytestmark = [pytest.mark.extras, needs_browser]
#: Wait until nothing is to be drawn any more.
STILL = """
const done = arguments[0], grid = document.getElementById("grid");
const wait = (before) => setTimeout(() => document.documentElement.dataset.ready && !gridView.options.coarse &&
  grid.dataset.drawn > 0 && grid.dataset.drawn === before ? done(true) : wait(grid.dataset.drawn), 60);
wait(null);
"""
CELL = """
const texts = (row) => [...row.cells].map((one) => one.textContent);
const rows = [...document.querySelectorAll("#cell tbody tr")].map(texts);
return Object.fromEntries([["name", document.getElementById("cell-name").textContent], ...rows]);
"""
EXTREMES = """
const all = (id) => gridView.grid.blocks.flatMap((block) => [...block.values[id]]);
const least = (id) => Math.min(...all(id)), most = (id) => Math.max(...all(id));
const folded = gridView.grid.blocks.reduce((sum, block) => sum + block.folded.reduce((a, b) => a + b), 0);
return [least("jacobian"), least("scaled"), least("smallest"), most("largest"), most("aspect"), most("condition"),
  most("growth"), most("off"), folded]
  .map((value) => Number.isFinite(value) ? value : null);
"""


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    driver = start_browser(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


@pytest.fixture
def show(browser, tmp_path):
    """Open the page of a grid; at the end of the test it must have asked for nothing and complained of nothing."""
    complaints(browser, "file:")

    def opened(grid, size=DESKTOP, **options):
        metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size == PHONE}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": size == PHONE})
        gg.view_grid(grid, tmp_path / "page.html", **options)
        browser.get((tmp_path / "page.html").as_uri())
        assert browser.execute_async_script(STILL)

    yield opened
    assert complaints(browser, (tmp_path / "page.html").as_uri()) == []


def pixel_of(browser, x, y):
    """The place of a point of the plane in the window."""
    script = "const [x, y] = gridView.pixelOf(arguments[0], arguments[1]); return [x + arguments[2], y + arguments[3]];"
    return browser.execute_script(script, x, y, *corner_of(browser, "#grid"))


def corner_of(browser, selector):
    """The upper left corner of an element in its window."""
    script = "const box = document.querySelector(arguments[0]).getBoundingClientRect(); return [box.left, box.top];"
    return browser.execute_script(script, selector)


def mouse(browser, kind, x, y, **more):
    browser.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, **more})


def click(browser, x, y):
    for kind in ("mousePressed", "mouseReleased"):
        mouse(browser, kind, x, y, button="left", clickCount=1)


def press(browser, key, shift=False):
    for kind in ("keyDown", "keyUp"):
        browser.execute_cdp_cmd(
            "Input.dispatchKeyEvent",
            {"type": kind, "key": key, "modifiers": 8 * shift, **({"text": key} if len(key) == 1 else {})},
        )
    browser.execute_async_script(STILL)


def color(browser, measure):
    change = (
        "const s = document.getElementById('measure'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))"
    )
    browser.execute_script(change, measure)
    browser.execute_async_script(STILL)


def picture(browser):
    """The page as pixels (height, width, 3)."""
    from matplotlib.image import imread

    return imread(io.BytesIO(base64.b64decode(browser.get_screenshot_as_base64())))[..., :3] * 255


def red_pixels(browser):
    return int((np.abs(picture(browser)[80:, :900] - (0xD7, 0x19, 0x1C)).max(axis=-1) < 40).sum())


def state(browser):
    return browser.execute_script("const v = gridView.view; return [v.x, v.y, v.scale];")


def number(text):
    return float(text.rstrip("°").replace("−", "-").replace("∞", "inf"))


def measures(grid, i, j):
    """Measures of one cell, from its four nodes."""
    J = corner_jacobians(grid.x[i : i + 2, j : j + 2], grid.y[i : i + 2, j : j + 2]).ravel()
    nodes = grid.xy[[i, i + 1, i + 1, i], [j, j, j + 1, j + 1]]
    after, before = np.roll(nodes, -1, axis=0) - nodes, np.roll(nodes, 1, axis=0) - nodes
    angles = np.degrees(np.arctan2(J, (after * before).sum(axis=1))) % 360
    scaled = J / (np.linalg.norm(after, axis=1) * np.linalg.norm(before, axis=1))
    return J.min(), scaled.min(), angles.min(), angles.max(), nodes.mean(axis=0)


@pytest.mark.parametrize(
    "grid",
    [gg.domain("swan", 15, 13), clustered(1e-6), gg.layout("pipe"), gg.domain("wavy", 13, 9)],
    ids=["folded", "wall", "pipe", "valid"],
)
def test_the_page_measures_as_quality_does(browser, show, grid):
    show(grid)
    q = gg.quality(grid)
    off = q.max_non_orthogonality if isinstance(grid, gg.MultiBlock) else q.non_orthogonality.largest
    expected = [
        *(q.min_jacobian, q.min_scaled_jacobian, q.min_angle, q.max_angle, q.max_aspect_ratio, q.max_condition),
        *(q.max_area_ratio, off, q.folded_cells),
    ]
    found = browser.execute_script(EXTREMES)
    assert [np.inf if one is None else one for one in found] == pytest.approx(expected, rel=1e-12)
    blocks = grid.blocks if isinstance(grid, gg.MultiBlock) else (grid,)
    nodes = "return gridView.grid.blocks.map((block) => [[...block.x], [...block.y]])"
    for planes, block in zip(browser.execute_script(nodes), blocks, strict=True):
        assert np.array_equal(np.array(planes).reshape(block.planes.shape), block.planes)


def test_pointing_at_a_cell_reports_its_measures_also_at_a_wall_after_zooming_in(browser, show):
    grid = clustered(1e-6)
    show(grid)
    for i, j in ((30, 29), (5, 27), (20, 0)):
        J, scaled, smallest, largest, (x, y) = measures(grid, i, j)
        for _ in range(20):
            place = [round(part) for part in pixel_of(browser, x, y)]
            mouse(browser, "mouseMoved", *place)
            if browser.execute_script(CELL)["name"] == f"cell ({i}, {j})":
                break
            mouse(browser, "mouseWheel", *place, deltaX=0, deltaY=-2000)
            browser.execute_async_script(STILL)
        cell = browser.execute_script(CELL)
        assert cell["name"] == f"cell ({i}, {j})"
        assert number(cell["J, smallest"]) == pytest.approx(J, rel=1e-5)
        assert number(cell["scaled Jacobian"]) == pytest.approx(scaled, rel=1e-5)
        assert [number(part) for part in cell["angles"].split(" to ")] == pytest.approx([smallest, largest], rel=1e-4)
    assert state(browser)[2] > 1e5


def test_zoom_keeps_the_point_under_the_pointer_and_dragging_moves_it(browser, show):
    grid = gg.domain("wavy", 9, 9)
    show(grid)
    place = [400, 300]
    left, top = corner_of(browser, "#grid")
    x, y = browser.execute_script("return gridView.view.at(arguments[0], arguments[1])", 400 - left, 300 - top)
    mouse(browser, "mouseWheel", *place, deltaX=0, deltaY=-500)
    browser.execute_async_script(STILL)
    assert pixel_of(browser, x, y) == pytest.approx(place, abs=0.01)
    _, _, scale = state(browser)
    for key, factor in (("+", 1.5), ("-", 1 / 1.5)):
        click(browser, *place)
        press(browser, key)
        assert state(browser)[2] == pytest.approx(scale * factor)
        scale = state(browser)[2]
    place = pixel_of(browser, x, y)
    mouse(browser, "mousePressed", *place, button="left", clickCount=1)
    for part in (0.5, 1.0):
        mouse(browser, "mouseMoved", place[0] + 40 * part, place[1] - 30 * part, button="left", buttons=1)
    mouse(browser, "mouseReleased", place[0] + 40, place[1] - 30, button="left", clickCount=1)
    browser.execute_async_script(STILL)
    assert pixel_of(browser, x, y) == pytest.approx([place[0] + 40, place[1] - 30], abs=0.01)
    press(browser, "ArrowRight")
    assert pixel_of(browser, x, y)[0] < place[0]
    press(browser, "0")
    low = pixel_of(browser, *grid.planes.min(axis=(1, 2)))
    assert low[0] > 0
    assert low[1] < DESKTOP[1]


def test_two_fingers_zoom_on_a_phone(browser, show):
    show(gg.layout("pipe"), PHONE)
    box = browser.execute_script("return document.getElementById('grid').getBoundingClientRect().toJSON()")
    assert box["width"] == PHONE[0]
    assert browser.execute_script("return document.documentElement.scrollWidth") <= PHONE[0]
    x, y = box["left"] + box["width"] / 2, box["top"] + box["height"] / 2
    before = state(browser)[2]
    for kind, apart in (("touchStart", 40), ("touchMove", 60), ("touchMove", 80), ("touchEnd", None)):
        points = [] if apart is None else [{"x": x - apart, "y": y, "id": 0}, {"x": x + apart, "y": y, "id": 1}]
        browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    browser.execute_async_script(STILL)
    assert state(browser)[2] == pytest.approx(2 * before, rel=1e-6)


def test_folded_cells_are_red_whatever_is_shown(browser, show):
    show(gg.domain("swan", 21, 21))
    for measure in ("scaled", "jacobian", "aspect", "none"):
        color(browser, measure)
        assert red_pixels(browser) > 60
    show(gg.domain("wavy", 9, 9))
    assert red_pixels(browser) == 0


def test_one_folded_cell_of_a_million_is_seen_and_found(browser, show):
    xy = gg.domain("square", 1001, 1001).xy
    xy[500, 500] = xy[499, 499] + 0.45 / 1000
    grid = gg.Grid(xy)
    show(grid)
    drawn = "return Number(document.getElementById('grid').dataset.cells)"
    assert 10_000 < browser.execute_script(drawn) < 200_000
    assert 4 < red_pixels(browser) < 400
    assert "1 folded cell" in browser.find_element("id", "kinds").text
    browser.find_element("id", "worst").click()
    browser.execute_async_script(STILL)
    cell = browser.execute_script(CELL)
    assert cell["name"] == "cell (499, 499), kept"
    assert number(cell["scaled Jacobian"]) == pytest.approx(measures(grid, 499, 499)[1], rel=1e-5)
    assert red_pixels(browser) > 1000
    assert browser.execute_script(drawn) < 20_000


def test_names_of_blocks_do_not_lie_over_each_other_and_cells_name_their_block(browser, show):
    layout = gg.layout("pipe")
    show(layout)
    names = json.loads(browser.execute_script("return document.getElementById('grid').dataset.names"))
    assert len(names) == len(layout)
    for k, a in enumerate(names):
        for b in names[:k]:
            assert a["left"] > b["right"] or b["left"] > a["right"] or a["low"] > b["high"] or b["low"] > a["high"]
    for name, block in zip(layout.names, layout.blocks, strict=True):
        mouse(browser, "mouseMoved", *pixel_of(browser, *measures(block, 3, 2)[4]))
        assert browser.execute_script(CELL)["name"] == f"block {name}, cell (3, 2)"
    assert "wall" in browser.find_element("id", "kinds").text


def test_keys_alone_reach_a_cell_and_what_is_chosen_is_spoken(browser, show):
    grid = gg.domain("wavy", 11, 11)
    show(grid)
    browser.execute_script("document.getElementById('worst').focus()")
    press(browser, "Tab")
    assert browser.execute_script("return document.activeElement.id") == "grid"
    press(browser, "c")
    name = browser.execute_script(CELL)["name"]
    i, j = (int(part) for part in name[name.index("(") + 1 : name.index(")")].split(","))
    for key, shift, cell in (("i", False, (i + 1, j)), ("J", True, (i + 1, j - 1)), ("I", True, (i, j - 1))):
        press(browser, key, shift)
        assert browser.execute_script(CELL)["name"] == f"cell ({cell[0]}, {cell[1]}), kept"
    spoken = browser.find_element("id", "spoken").get_attribute("textContent")
    assert spoken.startswith(f"cell ({i}, {j - 1}): ")
    assert "scaled Jacobian" in spoken
    press(browser, "Escape")
    assert browser.execute_script(CELL) == {"name": "Point at a cell"}
    unnamed = """
      const all = [...document.querySelectorAll("button, select, input, canvas:not([aria-hidden])")];
      const named = (one) => one.getAttribute("aria-label") || one.textContent.trim() || one.closest("label");
      return all.filter((one) => !named(one)).map((one) => one.id)"""
    assert browser.execute_script(unnamed) == []


@pytest.mark.parametrize("mode", ["light", "dark"])
def test_text_has_contrast_in_both_modes(browser, show, mode):
    browser.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": mode}]}
    )
    show(gg.domain("swan", 9, 9))
    pairs = browser.execute_script("""
      const clear = "rgba(0, 0, 0, 0)", own = (one) => getComputedStyle(one).backgroundColor;
      const back = (one) => own(one) === clear ? back(one.parentElement) : own(one);
      const names = ["#state", "#cell-name", "details th", "#folds", "button", "#kinds"];
      return names.map((name) => document.querySelector(name)).map((one) => [getComputedStyle(one).color, back(one)]);
    """)

    def luminance(text):
        parts = np.array([float(part) for part in text[text.index("(") + 1 : -1].split(",")[:3]]) / 255
        return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722)

    for pair in pairs:
        low, high = sorted(luminance(one) for one in pair)
        assert (high + 0.05) / (low + 0.05) > 4.5, pair
    assert (picture(browser)[-40:].mean() < 128) == (mode == "dark")
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


@pytest.mark.parametrize(
    ("xy", "center"),
    [
        (np.ones((3, 3, 2)), "1, 1"),
        (gg.domain("square", 5, 5).xy * (1, 0), "0.125, 0"),
        (gg.domain("square", 5, 5).xy * 1e-300, "1.25e−301, 1.25e−301"),
        (gg.domain("square", 5, 5).xy * 1e-3 + 1e6, "1000000.000125, 1000000.000125"),
    ],
    ids=["point", "line", "tiny", "far from the origin"],
)
def test_odd_grids_are_shown_without_an_error(browser, show, xy, center):
    show(gg.Grid(xy))
    for measure in ("jacobian", "growth", "none", "scaled"):
        color(browser, measure)
    browser.find_element("id", "worst").click()
    browser.find_element("id", "in").click()
    browser.execute_async_script(STILL)
    assert browser.execute_script(CELL)["center"] == center


def test_a_field_is_one_more_color(browser, show):
    grid = gg.domain("square", 9, 9)
    show(grid, under="x + 10*y")
    assert browser.execute_script("return document.getElementById('measure').value") == "field"
    mouse(browser, "mouseMoved", *pixel_of(browser, *measures(grid, 2, 3)[4]))
    x, y = measures(grid, 2, 3)[4]
    assert number(browser.execute_script(CELL)["x + 10*y"]) == pytest.approx(x + 10 * y, rel=1e-5)


def test_a_frame_of_a_notebook_shows_a_thinned_grid_with_the_indices_of_the_whole(browser, tmp_path):
    grid = gg.domain("square", 401, 401)
    complaints(browser, "file:")
    (tmp_path / "notebook.html").write_text(f"<body>{grid._repr_html_()}", encoding="utf-8")
    browser.get((tmp_path / "notebook.html").as_uri())
    browser.switch_to.frame(0)
    assert browser.execute_async_script(STILL)
    x, y = browser.execute_script("return gridView.pixelOf(0.5012, 0.2512)")
    browser.switch_to.default_content()
    left, top = corner_of(browser, "iframe")
    browser.switch_to.frame(0)
    inner = corner_of(browser, "#grid")
    mouse(browser, "mouseMoved", x + left + inner[0], y + top + inner[1])
    assert browser.execute_script(CELL)["name"] == "cell (200–204, 100–104)"
    browser.switch_to.default_content()
    assert complaints(browser, tmp_path.as_uri()) == []
