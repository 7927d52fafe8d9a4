"""Keep what is derived from a functional; it is derived again when the definition or the generator changes.

The key of a text covers all that it depends on: the definition, the files that derive and print, and the versions of
the packages that they use. The formulas of other functionals are no part of it: a new one invalidates no other.
"""

from __future__ import annotations

import json
import platform
import secrets
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from ..cache import digest, find_kept, keep
from ..functionals import functional as find_functional
from ..functionals import functionals, is_builtin
from ..functionals.definition import Functional
from ..functionals.registry import literature_sources
from ..resources import resource_folder

_PACKAGE = Path(__file__).parent.parent
#: What derives and prints, below the package.
_GENERATOR = ("functionals", "symbolic", "codegen")
#: Packages whose releases may print an expression in another way, or decide a sign differently.
_PACKAGES = ("sympy", "mpmath", "numpy", "jinja2")
#: When this process began to load the generator: what is newer on the disk may not be what runs here.
_LOADED = time.time()


def kept(functional: Functional, part: str, suffix: str, make: Callable[[], str], printer: str = "") -> Path:
    """Return the file of a text that is derived from a functional: kept earlier, or made now.

    Args:
        functional: what it is derived from.
        part: what it is, for example `report`, or the name of a variant.
        suffix: of the file, with the dot.
        make: derives the text; called only if it is not kept.
        printer: a key of what prints it, if that is no part of the generator.
    """
    key = digest(_definition_key(functional), part, _generator_key(), printer)
    stem = f"sources/{functional.name}-{key}"
    return find_kept(stem, suffix) or keep(stem, suffix, make().encode())


# ---- the generator ----


@lru_cache(maxsize=1)
def _generator_key() -> str:
    return digest(_versions(), key_of_files(generator_files()))


def generator_files() -> list[Path]:
    """Return the files of everything that derives and prints, but for back ends and the built-in definitions."""
    definitions = definition_files()
    folders = (*(_PACKAGE / part for part in _GENERATOR), resource_folder("templates"))
    texts = [path for folder in folders for path in texts_in(folder) if path not in definitions]
    return [*texts, _PACKAGE / "version.py"]


def report_files() -> list[Path]:
    """Return the files of all that reports on built-in functionals are derived from."""
    return [path for part in ("functionals", "symbolic") for path in texts_in(_PACKAGE / part)]


def definition_files() -> list[Path]:
    """Return the files in which built-in functionals are defined."""
    files = {sys.modules[functional.density.__module__].__file__ for functional in _builtins()}
    return sorted(Path(file) for file in files if file)


def texts_in(folder: Path) -> list[Path]:
    """Return the modules and templates in a folder."""
    return sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".jinja"))


def key_of_files(paths: Iterable[Path]) -> str:
    """Return a key of the names and the contents of files; one of this process alone, if one is newer than that."""
    paths = tuple(paths)
    return digest(key_of_contents(paths), key_of_process() if any(map(is_newer, paths)) else "")


def key_of_contents(paths: Iterable[Path]) -> str:
    """Return a key of the names and the contents of files."""
    return digest(*(part for path in paths for part in (path.name, path.read_text(encoding="utf-8"))))


def is_newer(path: Path) -> bool:
    """Return whether a file is newer than this process, so that it may not be what runs here."""
    return path.stat().st_mtime > _LOADED


@lru_cache(maxsize=1)
def key_of_process() -> str:
    """Return a key that no other process has, for what may differ in the next one."""
    return secrets.token_hex(8)


@lru_cache(maxsize=1)
def _versions() -> str:
    try:
        return " ".join((platform.python_version(), *map(version, _PACKAGES)))
    except PackageNotFoundError:  # One was copied, not installed: it may be another one next time.
        return key_of_process()


# ---- definitions ----


def is_the_builtin(functional: Functional) -> bool:
    """Return whether this is a functional of the package, and not another one of the same name."""
    return is_builtin(functional.name) and find_functional(functional.name) is functional


def _builtins() -> list[Functional]:
    return [find_functional(name) for name in functionals() if is_builtin(name)]


def _definition_key(functional: Functional) -> str:
    """Return a key of a definition. For a functional of a user this loads SymPy, as `define` has done already."""
    return _builtin_keys()[functional.name] if is_the_builtin(functional) else _key_of_formula(functional)


@lru_cache(maxsize=64)
def _key_of_formula(functional: Functional) -> str:
    import sympy

    formula = sympy.srepr(functional.expression())
    others = (field.name for field in fields(functional) if field.name != "density")
    cited = literature_sources(functional.name)
    return digest(formula, *(f"{name} {getattr(functional, name)!r}" for name in others), *cited)


@lru_cache(maxsize=1)
def _builtin_keys() -> Mapping[str, str]:
    """Return the keys of the built-in definitions, by name; without SymPy, as long as their files are the same."""
    stem = f"sources/definitions-{digest(_versions(), key_of_files(texts_in(_PACKAGE / 'functionals')))}"
    found = find_kept(stem, ".json")
    if found is None:
        keys = {functional.name: _key_of_formula(functional) for functional in _builtins()}
        found = keep(stem, ".json", json.dumps(keys).encode())
    known: dict[str, str] = json.loads(found.read_text(encoding="utf-8"))
    return known
