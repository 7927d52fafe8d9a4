"""Write the pages of the site that derive themselves; an extension of Sphinx, named in `docs/conf.py`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gridgen_sym.codegen.render import render_page
from gridgen_sym.documentation.functional_page import write_functional_page, write_if_changed
from gridgen_sym.functionals import functional, functionals, is_builtin, is_literature
from gridgen_sym.plotting import view_grid
from gridgen_sym.symbolic import classify
from gridgen_sym.symbolic.report.latex import latex
from gridgen_sym.topology.shapes import layout

from .files_page import write_files_page
from .literature_page import write_literature_page
from .paper_pages import write_paper_pages
from .reference_pages import write_reference_pages

#: Files of the repository that other pages link to, and the pages of the site that show them.
_PAGES_OF_FILES = {
    "../benchmarks/README.md": "benchmarks_method.md",
    "../CHANGELOG.md": "reference/changelog.md",
    "../CONTRIBUTING.md": "reference/contributing.md",
}


def setup(app: Any) -> dict[str, bool]:  # noqa: ANN401 - Sphinx may be missing where this is read
    """Have the pages written before Sphinx looks for its sources."""
    app.connect("builder-inited", lambda app: write_pages(Path(app.srcdir)))
    app.connect("source-read", _stay_on_the_site)
    app.connect("build-finished", _write_views)
    app.connect("autodoc-process-docstring", _keep_bars)
    return {"parallel_read_safe": True}


def _stay_on_the_site(app: Any, page: str, source: list[str]) -> None:  # noqa: ANN401
    """Lead links to files of the repository to the pages that show them."""
    for file, shown in _PAGES_OF_FILES.items():
        source[0] = source[0].replace(f"]({file})", f"]({shown})")


def _write_views(app: Any, failed: Exception | None) -> None:  # noqa: ANN401
    """Write the page of a grid that the tutorial on looking at grids shows."""
    if failed is None and app.builder.format == "html":
        folder = Path(app.outdir) / "view"
        folder.mkdir(exist_ok=True)
        view_grid(layout("pipe", across=16), folder / "pipe.html", title="A pipe of five blocks")


def _keep_bars(app: Any, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:  # noqa: ANN401
    """Show a norm such as |g1| of a docstring as it is: to reStructuredText it is a name to be replaced."""
    lines[:] = [line.replace("|", r"\|") for line in lines]


def write_pages(docs: Path) -> None:
    """Write every derived page below the folder of the site's sources."""
    _write_functionals(docs / "functionals")
    write_paper_pages(docs / "paper")
    write_reference_pages(docs / "reference")
    write_files_page(docs / "reference")


def _write_functionals(folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    # A script of the gallery may have defined one of its own by now.
    known = [functional(name) for name in functionals() if is_builtin(name)]
    found = [classify(one) for one in known if not is_literature(one.name)]
    pages = {write_functional_page(one.functional, folder) for one in found}
    pages.add(write_literature_page([one for one in known if is_literature(one.name)], folder))
    for page in set(folder.glob("*.md")) - pages:
        page.unlink()
    densities = {one.functional.name: latex(one.functional.expression()) for one in found}
    write_if_changed(folder / "index.md", render_page("functionals_index.md.jinja", found=found, densities=densities))
