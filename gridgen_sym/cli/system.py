"""Commands about the program itself: `info` and `paper`."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from ..errors import GridgenError

if TYPE_CHECKING:
    from ..runtime.toolchain import Compiler

_Found = TypeVar("_Found")
_PACKAGES = ("numpy", "scipy", "sympy", "matplotlib")


@click.command()
def info() -> None:
    """Report which back end, compiler, cache and versions are used, and why."""
    from ..resources import resource_folder
    from ..runtime import cache_folder, find_compiler, thread_count
    from ..version import __version__

    threads = thread_count()
    compiler = _found(find_compiler)
    folder = _found(cache_folder)
    rows = [
        ("gridgen_sym", f"{__version__}, in {Path(__file__).parent.parent}"),
        ("backend", _backend(compiler)),
        ("compiler", _compiler(compiler)),
        ("OpenMP", "yes" if compiler and not isinstance(compiler, GridgenError) and compiler.openmp else "no"),
        ("threads", f"{threads} ({'OMP_NUM_THREADS' if os.environ.get('OMP_NUM_THREADS') else 'processors'})"),
        ("cache", f"{folder} ({_size(folder)})" if isinstance(folder, Path) else str(folder)),
        ("generated", str(resource_folder("generated"))),
        ("python", f"{platform.python_version()} on {platform.system()} {platform.machine()}"),
        *((name, _version(name)) for name in _PACKAGES),
    ]
    for label, text in rows:
        click.echo(f"{label:<12}{text}")


def _found(search: Callable[[], _Found]) -> _Found | GridgenError:
    """Return what a search finds, or why it cannot be used."""
    try:
        return search()
    except GridgenError as error:
        return error


def _compiler(compiler: Compiler | GridgenError | None) -> str:
    if isinstance(compiler, GridgenError):
        return str(compiler)
    return f"{compiler.words}: {compiler.version}" if compiler else "none found (CC, cc, gcc, clang)"


def _backend(compiler: Compiler | GridgenError | None) -> str:
    """Return the name of the backend in use and why it is that one, or why none is."""
    from ..runtime import choose_backend

    forced = os.environ.get("GRIDGEN_SYM_BACKEND")
    if isinstance(compiler, GridgenError) and forced != "numpy":
        return "none (see the next line)"
    if forced:
        chosen = _found(choose_backend)
        return f"none: {chosen}" if isinstance(chosen, GridgenError) else f"{chosen.name} (GRIDGEN_SYM_BACKEND)"
    return "c (a compiler was found)" if compiler else "numpy (no C compiler was found)"


def _size(folder: Path) -> str:
    """Return the number of files in a folder and their size; files may vanish meanwhile."""
    sizes = []
    for path in folder.rglob("*"):
        try:
            sizes += [path.stat().st_size] if path.is_file() else []
        except OSError:
            continue
    return f"{len(sizes)} files, {sum(sizes) / 1e6:.1f} MB"


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


@click.command()
@click.option(
    "-o", "--output", "folder", default="out", show_default=True, metavar="DIR", help="Where pictures and table go."
)
def paper(folder: str) -> None:
    """Make every example of the paper: pictures and a table."""
    from ..paper_examples import run

    run(Path(folder), click.echo)
