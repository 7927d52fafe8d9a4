"""Write `generated/`, or check that it is what would be written."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..functionals import functional as find_functional
from ..functionals import functionals, is_builtin
from ..functionals.definition import Functional
from ..functionals.metric import WEIGHT_NAME
from ..functionals.variant import Variant, kernel_name
from ..resources import resource_folder
from .backend import BUILTIN, find_backend
from .derivations import kernel_files, report_text, state, summary
from .files import difference, write_sources
from .render import render_document, render_shared
from .source import Source

#: What is the same in all kernels of a language, written once.
SHARED = ("c/common.h", "c/loops.h", "numpy/loops.py")
#: Functionals whose barrier untangling follows relative to a target.
TARGETED = ("winslow",)
#: Files below `generated/` that nothing generates.
_KEPT = ("README.md",)


def committed_variants(functional: Functional) -> tuple[Variant, ...]:
    """Return the variants whose kernels are in `generated/`; others are generated when first used.

    The weighted ones where the density itself names the weight, the regularized one where there is a barrier, and for
    some relative to a target.
    """
    found = summary(functional)
    weighted: tuple[Variant, ...] = ("frozen", "differentiated") if WEIGHT_NAME in found.names else ()
    regularized: tuple[Variant, ...] = ("regularized",) if found.barrier else ()
    targeted: tuple[Variant, ...] = ("target+regularized",) if functional.name in TARGETED else ()
    return ("plain", *weighted, *regularized, *targeted)


def sources(functional: Functional, variants: tuple[Variant, ...]) -> Iterator[Source]:
    """Yield the facts and the sources of a functional's kernels, for every built-in back end."""
    for variant in variants:
        name = kernel_name(functional.name, variant)
        for backend in map(find_backend, BUILTIN):
            facts, source = kernel_files(functional, variant, backend)
            yield Source(f"{backend.name}/{name}{backend.suffix}", source.read_text(encoding="utf-8"))
        yield Source(f"facts/{name}.json", facts.read_text(encoding="utf-8"))


def all_sources() -> Iterator[Source]:
    """Yield every file of `generated/`: what kernels share, those of all built-in functionals, and their equations."""
    yield from map(render_shared, SHARED)
    for name in functionals(literature=False):
        if is_builtin(name):
            functional = find_functional(name)
            yield from sources(functional, committed_variants(functional))
            yield render_document(functional, report_text(functional))


def write_generated(folder: Path | None = None) -> list[Path]:
    """Write all files, remove those that nothing generates any more, and return the paths that changed."""
    folder = folder or resource_folder("generated")
    wanted = list(all_sources())
    known = state()
    changed = write_sources(folder, [*wanted, *([known] if known else [])])
    for path in _stale(folder, {folder / source.path for source in wanted}):
        path.unlink()
        changed.append(path)
    return changed


def check_generated(folder: Path | None = None) -> str:
    """Return a unified diff from what is in `generated/` to what would be written; empty where they agree."""
    folder = folder or resource_folder("generated")
    wanted = {source.path: source.text for source in all_sources()}
    stale = [path.relative_to(folder).as_posix() for path in _stale(folder, {folder / path for path in wanted})]
    parts: list[str] = []
    for path in sorted([*wanted, *stale]):
        if path in stale:
            parts.append(f"generated/{path} is stale: nothing generates it any more\n")
        parts += difference(folder, "generated", path, wanted.get(path, ""), known="committed")
    return "".join(parts)


def _stale(folder: Path, wanted: set[Path]) -> list[Path]:
    return [
        path
        for part in (*BUILTIN, "facts", "docs")
        for path in sorted((folder / part).glob("*"))
        if path.is_file() and path not in wanted and path.name not in _KEPT
    ]
