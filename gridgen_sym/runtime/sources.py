"""Find the sources of a functional's kernels: in `generated/`, in the cache, or by deriving them now."""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from ..functionals import is_builtin
from ..functionals.definition import Functional
from ..messages import say
from ..resources import resource_folder
from . import cache

if TYPE_CHECKING:
    from ..symbolic.coordinates import Variant


def find_sources(functional: Functional, variant: Variant) -> tuple[Path, Path]:
    """Return the paths of the C source and of the NumPy source.

    Those of built-in functionals are committed; others are derived once and kept in the cache. Deriving loads SymPy.
    """
    name = functional.name if variant == "plain" else f"{functional.name}_{variant}"
    committed = resource_folder("generated")
    paths = committed / "c" / f"{name}.c", committed / "numpy" / f"{name}.py"
    if is_builtin(functional.name) and all(path.exists() for path in paths):
        return paths
    stem = f"sources/{name}-{_key(functional, variant)}"
    c_source, numpy_source = cache.find(stem, ".c"), cache.find(stem, ".py")
    return (c_source, numpy_source) if c_source and numpy_source else _derive(functional, variant, stem)


def _derive(functional: Functional, variant: Variant, stem: str) -> tuple[Path, Path]:
    from ..codegen.programs import kernel
    from ..codegen.render import render

    say(f"deriving the kernels of {functional.name} ({variant}) ...")
    derived = kernel(functional, variant)
    return (
        cache.keep(stem, ".c", render(derived, "c").text.encode()),
        cache.keep(stem, ".py", render(derived, "numpy").text.encode()),
    )


def _key(functional: Functional, variant: Variant) -> str:
    """Return a key that changes with the definition and with everything that derives and prints."""
    # The definition of a built-in functional is part of the package's text, so SymPy need not be loaded to know it.
    definition = functional.name
    if not is_builtin(functional.name):
        import sympy

        definition += sympy.srepr(functional.expression()) + repr(
            (functional.corner_factor, tuple(functional.parameters))
        )
    return hashlib.sha256(f"{definition}\0{variant}\0{_generator_digest()}".encode()).hexdigest()[:16]


@lru_cache(maxsize=1)
def _generator_digest() -> str:
    package = Path(__file__).parent.parent
    texts = [*sorted(resource_folder("templates").rglob("*.jinja"))]
    for part in ("functionals", "symbolic", "codegen"):
        texts += sorted((package / part).glob("*.py"))
    digest = hashlib.sha256()
    for path in texts:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
