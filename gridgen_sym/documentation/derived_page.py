"""What is derived for the page of a functional, and kept: equations, classification, consequences, arithmetic."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..backends.c.printer import CPrinter
from ..backends.numpy.printer import NumpyPrinter
from ..codegen.backend import find_backend
from ..codegen.kept_texts import kept, key_of_files, texts_in
from ..codegen.kernel import Kernel
from ..codegen.printer import Printer
from ..codegen.programs import kernel
from ..functionals import Functional
from ..symbolic import Classification, classify
from ..symbolic.report.fields import declarations
from ..symbolic.report.latex import latex, latex_formulas
from ..symbolic.report.sections import Section, sections
from .advice import consequences

#: A formula of more letters of LaTeX than this goes behind a fold.
_LONGEST = 450
_MEANING: Mapping[str, str] = {
    "corner_energy": "energy of a corner",
    "corner_slopes": "and its slopes in the metric",
    "corner_hessian": "and its Hessian",
    "corner_hessian_vector": "its Hessian times a vector",
    "corner_semidefinite": "a positive semidefinite Hessian",
    "corner_semidefinite_vector": "and that Hessian times a vector",
    "residual": "Euler–Lagrange residual at a node",
    "residual_slopes": "and its derivatives, for Newton's method",
    "residual_coefficients": "and its coefficients, for relaxation",
}


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a page.

    Attributes:
        heading: its heading in Markdown, or nothing where it belongs to the one before.
        fold: what the fold says that hides it, or nothing where it is shown.
        blocks: (`text` or `formula`, content) in their order.
    """

    heading: str
    fold: str
    blocks: tuple[tuple[str, str], ...]


def derived_page(functional: Functional) -> dict[str, Any]:
    """Return what is derived for the page of a functional, by the names of its template, kept earlier or made now."""
    package = Path(__file__).parent.parent
    printers = key_of_files(path for part in ("backends", "documentation") for path in texts_in(package / part))
    path = kept(functional, "page", ".json", lambda: json.dumps(_derive(functional)), printers)
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def _derive(functional: Functional) -> dict[str, Any]:
    """Derive the same, as text, numbers, lists and dictionaries alone."""
    found, derived = classify(functional), kernel(functional, "plain")
    return {
        "density": f"F = {latex(functional.expression())}",
        "facts": list(_facts(found)),
        "consequences": list(consequences(found)),
        "parts": [asdict(part) for part in _parts(functional)],
        "programs": [
            {
                "name": name,
                "meaning": _MEANING.get(name, name.replace("_", " ")),
                "operations": dict(program.operations),
            }
            for name, program in derived.programs.items()
        ],
        "sources": list(_sources(derived)),
    }


def _facts(found: Classification) -> Iterator[tuple[str, str]]:
    """Yield the main facts."""
    linear, coupled, kind = found.words()
    yield "Equations", f"{linear}, {coupled}, {kind} where $J > 0$ ({found.ellipticity.how_known})"
    yield "Barrier at $J = 0$", "yes" if found.barrier else "no"
    invariant = {"translation": found.translation, "rotation": found.rotation, "exchange of ξ and η": found.exchange}
    kept = [name for name, holds in invariant.items() if holds]
    yield "Invariant under", ", ".join(kept) or "none of translation, rotation, exchange of ξ and η"
    degree = found.scaling_degree
    yield "Scaling", "not homogeneous" if degree is None else f"of degree ${latex(degree)}$"
    bound = found.lower_bound
    yield "Lower bound", "none known" if bound.value is None else f"${latex(bound.value)}$ ({bound.proof})"
    how = "refuted at a point" if found.polyconvex.proof == "refuted" else found.polyconvex.proof
    yield "Polyconvex", f"{'yes, where $J > 0$' if found.polyconvex.holds else 'no'} ({how})"
    if found.kinks:
        zeros = ", ".join(f"${latex(kink)} = 0$" for kink in found.kinks)
        yield "First derivatives jump", f"where {zeros}"
    if found.functional.fields:
        yield "Fields", " ".join(declarations(found.functional))
    if found.functional.parameters:
        values = ", ".join(f"`{name}` = {value:g}" for name, value in found.functional.parameters.items())
        rules = ", ".join(f"`{rule}`" for rule in found.functional.constraints)
        yield "Parameters", values + (f", with {rules}" if rules else "")


def _parts(functional: Functional) -> Iterator[Part]:
    """Yield the sections of the report, those for reference and those with long formulas behind a fold."""
    title = ""
    for section in sections(functional):
        if section.title == "Density":
            continue
        blocks = tuple(_blocks(section))
        if section.detail:
            yield Part("", section.heading, blocks)
            continue
        if section.subtitle and section.title != title:
            yield Part(f"## {section.title}", "", ())
        title = section.title
        heading = f"### {section.subtitle[0].upper()}{section.subtitle[1:]}" if section.subtitle else f"## {title}"
        short = tuple(block for block in blocks if len(block[1]) <= _LONGEST)
        yield Part(heading, "", short)
        if short != blocks:
            yield Part("", "The long formulas of this section", tuple(block for block in blocks if block not in short))


def _blocks(section: Section) -> Iterator[tuple[str, str]]:
    for item in section.items:
        if isinstance(item, str):
            yield "text", item
        else:
            yield from (("formula", formula) for formula in latex_formulas(item))


def _sources(derived: Kernel) -> Iterator[tuple[str, str, str, str]]:
    """Yield for each language its name, that for a fence, the arithmetic, and the name of the kernel's file."""
    printers: tuple[tuple[str, str, str, Printer, str], ...] = (
        ("C", "c", "c", CPrinter(), "const double {} = {};"),
        ("NumPy", "python", "numpy", NumpyPrinter(), "{} = {}"),
    )
    for language, fence, key, printer, line in printers:
        remark = "/* {} */" if key == "c" else "# {}"
        programs = [
            "\n".join([remark.format(name), *(line.format(*pair) for pair in printer.program(program))])
            for name, program in derived.programs.items()
        ]
        yield language, fence, "\n\n".join(programs), f"{derived.facts.name}{find_backend(key).suffix}"
