"""The built site in a browser, without a network: mathematics, pictures, search, narrow screens, links.

Needs Chromium and its driver (Debian's packages chromium and chromium-driver), Selenium, and the site, built by the
command in README.md; skipped where one of them is missing.
"""

from __future__ import annotations

import functools
import http.server
import threading
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urljoin

import pytest
from support_browser import DESKTOP, PHONE, complaints, needs_browser, start_browser

SITE = Path(__file__).resolve().parents[2] / "docs" / "_build" / "html"
#: A page of every kind.
PAGES = (
    "index.html",
    "functionals/index.html",
    "functionals/winslow.html",
    "functionals/modified_liao.html",
    "functionals/area.html",
    "paper/index.html",
    "paper/section-2-1.html",
    "paper/section-2-5.html",
    "gallery/index.html",
    "gallery/plot_8_every_solver.html",
    "tutorials/first_grid.html",
    "tutorials/look.html",
    "explanations/two_sides.html",
    "pipeline.html",
    "reference/api.html",
    "reference/command_line.html",
    "benchmarks.html",
)
READY = """
const done = arguments[0], math = [...document.querySelectorAll('.math')];
const wait = () => math.length === 0 || (window.MathJax && MathJax.startup && MathJax.startup.promise)
  ? Promise.resolve(math.length && MathJax.startup.promise).then(() => done(true)) : setTimeout(wait, 20);
wait();
"""
STATE = """
const images = [...document.images], wide = document.documentElement.scrollWidth - window.innerWidth;
return {
  math: document.querySelectorAll('.math').length,
  typeset: document.querySelectorAll('.math mjx-container').length,
  errors: document.querySelectorAll('mjx-merror, [data-mjx-error]').length,
  broken: images.filter(image => image.complete && image.naturalWidth === 0).map(image => image.src),
  images: images.length, wide: wide, title: document.title,
};
"""

pytestmark = [
    pytest.mark.skipif(not (SITE / "index.html").exists(), reason=f"no site in {SITE}: build it first (README.md)"),
]


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def address():
    """Serve the site on this machine alone."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=SITE))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    driver = start_browser(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


def show(browser, url, size):
    """Open a page at a size, wait for its mathematics, and return what it holds."""
    metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size == PHONE}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    browser.get(url)
    assert browser.execute_async_script(READY)
    return browser.execute_script(STATE)


@needs_browser
@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_whole_without_a_network(browser, address, page):
    complaints(browser, address)
    for size in (DESKTOP, PHONE):
        state = show(browser, address + page, size)
        assert state["typeset"] == state["math"]
        assert state["errors"] == 0
        assert state["broken"] == []
        assert state["wide"] <= 0, f"{page} is {state['wide']} pixels too wide at {size}"
    assert complaints(browser, address) == []
    if page.startswith(("functionals/w", "paper/s")):
        assert state["math"] > 10
    if page in ("functionals/winslow.html", "index.html", "gallery/index.html"):
        assert state["images"] > 0


@needs_browser
def test_tables_of_numbers_are_not_cut_on_a_desktop(browser, address):
    show(browser, address + "benchmarks.html", DESKTOP)
    cut = "return [...document.querySelectorAll('.table-wrapper')].filter(t => t.scrollWidth > t.clientWidth).length"
    assert browser.execute_script(cut) == 0


@needs_browser
def test_a_fold_opens_and_its_mathematics_fit(browser, address):
    show(browser, address + "functionals/modified_liao.html", PHONE)
    browser.execute_script("document.querySelectorAll('details').forEach(fold => fold.open = true)")
    state = browser.execute_script(STATE)
    assert state["typeset"] == state["math"] > 30
    assert state["wide"] <= 0


@needs_browser
def test_search_finds_a_page(browser, address):
    show(browser, address + "search.html?q=polyconvex", DESKTOP)
    wait = (
        "const done = arguments[0]; const look = () => { const hits = [...document.querySelectorAll('ul.search li a')];"
    )
    hits = browser.execute_async_script(
        wait + "hits.length ? done(hits.map(a => a.href)) : setTimeout(look, 50); }; look();"
    )
    assert any("glossary" in hit or "functionals/" in hit for hit in hits)


@needs_browser
def test_a_request_to_another_host_would_be_found(browser, address):
    complaints(browser, address)
    show(browser, address + "index.html", DESKTOP)
    browser.execute_script("new Image().src = 'http://127.0.0.2:9/outside.png'")
    browser.execute_async_script("setTimeout(arguments[0], 200)")
    assert any("outside" in complaint for complaint in complaints(browser, address))


class Links(HTMLParser):
    """The targets and the anchors of a page."""

    def __init__(self):
        super().__init__()
        self.targets, self.anchors = [], set()

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.anchors |= {named[key] for key in ("id", "name") if named.get(key)}
        wanted = {"a": "href", "link": "href", "script": "src", "img": "src"}.get(tag)
        if wanted and named.get(wanted) and named.get("rel") not in ("canonical",):
            self.targets.append((tag, named[wanted]))


@functools.cache
def read_links(path):
    parser = Links()
    parser.feed(path.read_text(encoding="utf-8"))
    return parser


def test_every_link_leads_somewhere():
    dead, loaded_from_outside = [], []
    pages = [path for path in SITE.rglob("*.html") if "_static" not in path.parts]
    assert len(pages) > 40
    for path in pages:
        for tag, target in read_links(path).targets:
            if target.startswith(("http://", "https://", "//")):
                loaded_from_outside += [(path.name, target)] if tag != "a" else []
                continue
            if target.startswith(("mailto:", "data:", "javascript:")):
                continue
            file, anchor = urldefrag(urljoin(path.relative_to(SITE).as_posix(), target))
            aim = SITE / unquote(file).partition("?")[0]
            aim = aim / "index.html" if aim.is_dir() else aim
            if not aim.exists() or (
                anchor and aim.suffix == ".html" and unquote(anchor) not in read_links(aim).anchors
            ):
                dead.append((path.relative_to(SITE).as_posix(), target))
    assert dead == []
    assert loaded_from_outside == []
