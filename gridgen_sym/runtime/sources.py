"""Find the source of a functional's kernels: in `generated/`, in the cache, or by deriving it now."""

from __future__ import annotations

import hashlib
import secrets
import sys
from functools import lru_cache
from pathlib import Path

from ..codegen.backend import Backend
from ..codegen.facts import definition_digest, kernel_name
from ..functionals import is_builtin
from ..functionals.definition import Functional
from ..functionals.variant import Variant
from ..messages import report
from ..resources import resource_folder
from . import cache


def find_sources(functional: Functional, variant: Variant, backend: Backend) -> tuple[Path, Path]:
    """Return the paths of the facts of a kernel, and of its source in the language of a back end.

    Those of built-in functionals are committed; others are derived once and kept in the cache. Deriving loads SymPy.
    """
    name = kernel_name(functional.name, variant)
    committed = resource_folder("generated")
    paths = committed / "facts" / f"{name}.json", committed / backend.name / f"{name}{backend.suffix}"
    if is_builtin(functional.name) and all(path.exists() for path in paths):
        return paths
    stem = f"sources/{name}-{_key(functional, variant, backend)}"
    facts, source = cache.find(stem, ".json"), cache.find(stem, backend.suffix)
    return (facts, source) if facts and source else _derive(functional, variant, backend, stem)


def _derive(functional: Functional, variant: Variant, backend: Backend, stem: str) -> tuple[Path, Path]:
    from ..codegen.programs import kernel

    report(f"deriving the kernels of {functional.name} ({variant}) ...")
    derived = kernel(functional, variant)
    return (
        cache.keep(stem, ".json", derived.facts.to_json().encode()),
        cache.keep(stem, backend.suffix, backend.render(derived).encode()),
    )


def _key(functional: Functional, variant: Variant, backend: Backend) -> str:
    """Return a key that changes with the definition and with everything that derives and prints."""
    # The definition of a built-in functional is part of the package's text, so SymPy need not be loaded to know it.
    definition = "" if is_builtin(functional.name) else definition_digest(functional)
    return cache.digest(functional.name, definition, variant, backend.name, _digest(_generator()), _printer(backend))


def _generator() -> tuple[Path, ...]:
    """Return the files that derive kernels, and all templates."""
    package = Path(__file__).parent.parent
    folders = (*(package / part for part in ("functionals", "symbolic", "codegen")), resource_folder("templates"))
    return tuple(path for folder in folders for path in _texts(folder))


def _printer(backend: Backend) -> str:
    """Return a key of what prints a back end's kernels: the package that it is in, or its file if it is in none."""
    module = sys.modules[type(backend).__module__]
    file = getattr(module, "__file__", None)
    if file is None:  # It was typed in: it may be another one in the next process.
        return _token()
    return _digest(tuple(_texts(Path(file).parent)) if module.__package__ else (Path(file),))


def _texts(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".jinja"))


@lru_cache(maxsize=1)
def _token() -> str:
    return secrets.token_hex(8)


@lru_cache(maxsize=8)
def _digest(paths: tuple[Path, ...]) -> str:
    """Return a key of the names and contents of some files."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
