"""The page of one functional as HTML in a folder of its own, with its mathematics, pictures and kernels."""

from __future__ import annotations

import io
import shutil
import tempfile
from pathlib import Path

from ..errors import GridgenError, MissingExtraError
from ..functionals import Functional
from .functional_page import write_functional_page
from .settings import settings


def write_html(functional: Functional, folder: Path) -> Path:
    """Write the HTML page of a functional, which opens without a network, and return its path.

    Args:
        functional: built in or a user's own.
        folder: made where it is missing; files of the same names are replaced.

    Raises:
        MissingExtraError: if Sphinx or one of its extensions is not installed.
        GridgenError: if the folder cannot be made, or the page cannot be built.
    """
    try:
        import furo  # noqa: F401
        import myst_parser  # noqa: F401
        import sphinx_copybutton  # noqa: F401
        from sphinx.application import Sphinx
        from sphinx.util.docutils import docutils_namespace
    except ImportError as error:
        raise MissingExtraError("a page of a functional", "docs", error.name or "sphinx") from error
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise GridgenError(f"cannot make the folder {folder}: {error.strerror or error}; name another one") from error
    with tempfile.TemporaryDirectory() as scratch:
        source, built, told = Path(scratch) / "source", Path(scratch) / "built", io.StringIO()
        source.mkdir()
        write_functional_page(functional, source)
        chosen = settings() | {"root_doc": functional.name, "html_title": functional.name}
        with docutils_namespace():
            app = Sphinx(source, None, built, built, "html", chosen, io.StringIO(), told, freshenv=True)
            app.build()
        if app.statuscode or told.getvalue().strip():
            raise GridgenError(f"Sphinx could not build the page of {functional.name!r}: {told.getvalue()}")
        unwanted = shutil.ignore_patterns("*.pickle", "*.doctree", ".buildinfo", "_sources", "objects.inv")
        shutil.copytree(built, folder, dirs_exist_ok=True, ignore=unwanted)
    return folder / f"{functional.name}.html"
