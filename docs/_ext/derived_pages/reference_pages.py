"""The reference pages that the program itself knows: its public names, and its command line."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from pathlib import Path

import click

import gridgen_sym
from gridgen_sym.cli import main
from gridgen_sym.codegen.render import render_page
from gridgen_sym.documentation.functional_page import write_if_changed

#: What fits on a page.
_COLUMNS = 86
#: Packages of the public names, as a reader looks for them.
_GROUPS: Mapping[str, str] = {
    "solvers": "Solvers",
    "fields": "Weights, fields and targets",
    "boundary": "Boundaries and domains",
    "grids": "Grids",
    "io": "Files",
    "plotting": "Pictures",
    "certificates": "Certificates",
    "adaptation": "Adaptation",
    "functionals": "Functionals",
    "errors": "Errors",
}


def write_reference_pages(folder: Path) -> None:
    """Write the pages of the Python interface and of the command line into a folder."""
    folder.mkdir(exist_ok=True)
    write_if_changed(folder / "api.md", render_page("api.md.jinja", groups=public_names()))
    write_if_changed(folder / "command_line.md", render_page("command_line.md.jinja", commands=command_helps()))


def public_names() -> dict[str, list[tuple[str, str]]]:
    """Return (kind of autodoc, name) of everything that `import gridgen_sym` offers, by group."""
    groups: dict[str, list[tuple[str, str]]] = {title: [] for title in _GROUPS.values()}
    for name in gridgen_sym.__all__:
        value = getattr(gridgen_sym, name)
        if name.startswith("_"):
            continue
        package = value.__module__.split(".")[1]
        kind = "autoexception" if _is_error(value) else "autoclass" if inspect.isclass(value) else "autofunction"
        groups.setdefault(_GROUPS.get(package, package), []).append((kind, name))
    # What a reader calls comes before what comes back; both in the order of the interface.
    return {
        title: sorted(names, key=lambda pair: pair[0] != "autofunction") for title, names in groups.items() if names
    }


def _is_error(value: object) -> bool:
    return inspect.isclass(value) and issubclass(value, Exception)


def command_helps() -> list[tuple[str, str]]:
    """Return the name and the help of every command, the program's own first."""
    program = "gridgen-sym"
    context = click.Context(main, info_name=program, terminal_width=_COLUMNS)
    pages = [(program, main.get_help(context))]
    for name, command in main.commands.items():
        inner = click.Context(command, info_name=name, parent=context, terminal_width=_COLUMNS)
        pages.append((f"{program} {name}", command.get_help(inner)))
    return pages
