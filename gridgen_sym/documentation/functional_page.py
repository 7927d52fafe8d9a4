"""The page of one functional: Markdown, its picture and its kernels, made when it is written."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..atomic import write_bytes
from ..codegen.backend import BUILTIN, find_backend
from ..codegen.derivations import kernel_files
from ..codegen.render import render_page
from ..functionals import Functional
from .derived_page import derived_page
from .pictures import draw, example_fields, trials


def write_functional_page(functional: Functional, folder: Path) -> Path:
    """Write `NAME.md` with its pictures and its kernels into a folder, and return its path.

    Raises:
        MissingExtraError: if Matplotlib is not installed.
    """
    tried = trials(functional)
    pictures = draw(functional, tried, folder)
    for backend in map(find_backend, BUILTIN):
        _, source = kernel_files(functional, "plain", backend)
        write_if_changed(folder / f"{functional.name}{backend.suffix}", source.read_text(encoding="utf-8"))
    text = render_page(
        "functional_page.md.jinja",
        functional=functional,
        pictures=pictures,
        cells=tried[0].start.shape[0] - 1,
        trials=tried,
        fields=tuple(_example_values(functional)),
        **derived_page(functional),
    )
    return write_if_changed(folder / f"{functional.name}.md", text)


def _example_values(functional: Functional) -> Iterator[str]:
    """Yield the fields with which the trials were made, as Markdown."""
    for name, field in example_fields(functional).items():
        parts = field.source if isinstance(field.source, tuple) else (field.source,)
        yield f"{name} = {', '.join(f'`{part}`' for part in parts)}"


def write_if_changed(path: Path, text: str) -> Path:
    """Write a page unless it is unchanged: Sphinx reads again what has a new date."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        write_bytes(path, text.encode())
    return path
