"""Find the source of a functional's kernels: in `generated/`, or among those that were derived when first used."""

from __future__ import annotations

from pathlib import Path

from ..codegen.backend import Backend
from ..codegen.derivations import kernel_files
from ..codegen.kept_texts import is_the_builtin
from ..functionals.definition import Functional
from ..functionals.variant import Variant, kernel_name
from ..resources import resource_folder


def find_sources(functional: Functional, variant: Variant, backend: Backend) -> tuple[Path, Path]:
    """Return the paths of the facts of a kernel, and of its source in the language of a back end.

    Those of built-in functionals are committed; others are derived once and kept in the cache. Deriving loads SymPy.
    """
    name = kernel_name(functional.name, variant)
    committed = resource_folder("generated")
    paths = committed / "facts" / f"{name}.json", committed / backend.name / f"{name}{backend.suffix}"
    if is_the_builtin(functional) and all(path.exists() for path in paths):
        return paths
    return kernel_files(functional, variant, backend)
