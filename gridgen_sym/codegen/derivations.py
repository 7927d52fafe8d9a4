"""The texts that are derived from a functional: kernels, the report on it, what lists say of it. Each is kept."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..functionals.definition import Functional
from ..functionals.variant import Variant
from ..messages import report
from ..resources import is_checkout, resource_folder
from .backend import Backend
from .kept_texts import (
    is_newer,
    is_the_builtin,
    kept,
    key_of_contents,
    key_of_files,
    key_of_process,
    report_files,
    texts_in,
)
from .source import Source

if TYPE_CHECKING:
    from .kernel import Kernel

#: The file of `generated/` with a key of all that its reports were derived from.
_STATE = "derived_from.txt"

# ---- kernels ----


def kernel_files(functional: Functional, variant: Variant, backend: Backend) -> tuple[Path, Path]:
    """Return the files of the facts of a kernel, and of its source in the language of a back end."""
    return (
        kept(functional, variant, ".json", lambda: _kernel(functional, variant).facts.to_json()),
        kept(
            functional,
            f"{variant} {backend.name}",
            backend.suffix,
            lambda: backend.render(_kernel(functional, variant)),
            _printer(backend),
        ),
    )


@lru_cache(maxsize=4)
def _kernel(functional: Functional, variant: Variant) -> Kernel:
    """Derive a kernel, once for its facts and for every back end."""
    from .programs import kernel

    report(f"deriving the kernels of {functional.name} ({variant}) ...")
    return kernel(functional, variant)


def _printer(backend: Backend) -> str:
    """Return a key of what prints a back end's kernels: the package that it is in, or its file if it is in none."""
    module = sys.modules[type(backend).__module__]
    file = getattr(module, "__file__", None)
    if file is None:  # It was typed in: it may be another one in the next process.
        return key_of_process()
    return key_of_files(texts_in(Path(file).parent) if module.__package__ else [Path(file)])


# ---- reports ----


def report_text(functional: Functional) -> str:
    """Return every derived equation of a functional as plain text."""

    def derive() -> str:
        from ..symbolic.report import derive_text

        return derive_text(functional)

    return _text(functional, "report", ".txt", derive)


def report_latex(functional: Functional, *, complete: bool = False) -> str:
    r"""Return every derived equation of a functional as LaTeX: a section for \input, or a complete document."""

    def derive() -> str:
        from ..symbolic.report import derive_latex

        return derive_latex(functional, complete=complete)

    return _text(functional, "document" if complete else "report", ".tex", derive)


def known_report(functional: Functional) -> str:
    """Return the same; for a built-in functional from its page in `generated/`, if that is up to date.

    In an installed package it is; in a checkout as long as nothing has changed that it was derived from.
    """
    generated = resource_folder("generated")
    page = generated / "docs" / f"{functional.name}.md"
    if not is_the_builtin(functional) or not page.exists() or (is_checkout() and not _is_current(generated)):
        return report_text(functional)
    found = re.search(r"^```text\n(.*?)\n```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return found[1] if found else report_text(functional)


def state() -> Source | None:
    """Return the file of `generated/` that has a key of all that reports are derived from, as it is now.

    Nothing, if some of that has changed since this process began: what was derived may be older.
    """
    files = report_files()
    return None if any(map(is_newer, files)) else Source(_STATE, f"{key_of_contents(files)}\n")


def _is_current(generated: Path) -> bool:
    now, path = state(), generated / _STATE
    return now is not None and path.exists() and path.read_text(encoding="utf-8") == now.text


# ---- lists ----


@dataclass(frozen=True, slots=True)
class Summary:
    """What a list of functionals says of one, and which kernels it needs.

    Attributes:
        density: the formula, as text.
        equations: the Euler-Lagrange equations in the words of the field, as random points show them.
        barrier: whether the energy is infinite where J = 0.
        names: what the density names, in alphabetical order.
    """

    density: str
    equations: tuple[str, ...]
    barrier: bool
    names: tuple[str, ...]


def summary(functional: Functional) -> Summary:
    """Return what a list says of a functional; nothing is proved for it."""
    found: dict[str, Any] = json.loads(_text(functional, "summary", ".json", lambda: _summarize(functional)))
    return Summary(**(found | {key: tuple(found[key]) for key in ("equations", "names")}))


def _summarize(functional: Functional) -> str:
    from ..symbolic import equation_words, has_barrier

    density = functional.expression()
    names = tuple(sorted(symbol.name for symbol in density.free_symbols))
    return json.dumps(asdict(Summary(str(density), equation_words(functional), has_barrier(functional), names)))


def _text(functional: Functional, part: str, suffix: str, make: Callable[[], str]) -> str:
    return kept(functional, part, suffix, make).read_text(encoding="utf-8")
