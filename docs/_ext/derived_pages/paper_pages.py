"""The paper, checked: every printed equation beside the derived one, from the verdicts of `gridgen-sym verify`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from gridgen_sym.codegen.render import render_page
from gridgen_sym.documentation.functional_page import write_if_changed
from gridgen_sym.functionals.paper import PrintedEquation
from gridgen_sym.symbolic import Verdict, verify
from gridgen_sym.symbolic.paper.counterpart import counterpart
from gridgen_sym.symbolic.paper.errata import ERRATA
from gridgen_sym.symbolic.report.latex import latex, latex_formulas
from gridgen_sym.symbolic.report.tidy import tidy


@dataclass(frozen=True, slots=True)
class Shown:
    """A printed equation as a page shows it.

    Attributes:
        verdict: what was found.
        answer: the answer in words, with the erratum where there is one.
        color: `agrees`, `condition` or `differs`.
        derived: LaTeX of the derived equation, nothing where the claim is one in words.
        difference: LaTeX of printed minus derived, where that is an expression.
    """

    verdict: Verdict
    answer: str
    color: str
    derived: tuple[str, ...]
    difference: str

    @property
    def heading(self) -> str:
        """Where it stands, without the number of the section."""
        place = re.sub(r"^Section \d\.\d, ", "", self.verdict.equation.place)
        return place[0].upper() + place[1:]


@dataclass(frozen=True, slots=True)
class Chapter:
    """The equations of one section of the paper."""

    key: str
    title: str
    equations: tuple[Shown, ...]


def write_paper_pages(folder: Path) -> None:
    """Write the pages of the paper and their index into a folder."""
    folder.mkdir(exist_ok=True)
    verdicts = verify()
    parts = chapters(verdicts)
    for part in parts:
        write_if_changed(folder / f"{part.key}.md", render_page("paper_section.md.jinja", chapter=part))
    counts = {
        "all": len(verdicts),
        "agree": sum(verdict.is_plain for verdict in verdicts),
        "errata": sum(verdict.erratum is not None for verdict in verdicts),
        "unknown": sum(verdict.is_discovery for verdict in verdicts),
    }
    counts["condition"] = counts["all"] - counts["agree"] - counts["errata"] - counts["unknown"]
    places = {
        erratum.key: [(part.key, one) for part in parts for one in part.equations if one.verdict.erratum == erratum.key]
        for erratum in ERRATA
    }
    text = render_page("paper_index.md.jinja", chapters=parts, counts=counts, errata=ERRATA, places=places)
    write_if_changed(folder / "index.md", text)


def chapters(verdicts: Iterable[Verdict]) -> tuple[Chapter, ...]:
    """Return the verdicts by section of the paper, in its order."""
    found: dict[str, list[Shown]] = {}
    for verdict in verdicts:
        found.setdefault(_section(verdict.equation), []).append(_shown(verdict))
    return tuple(Chapter(f"section-{key.replace('.', '-')}", _title(key), tuple(found[key])) for key in found)


def _section(equation: PrintedEquation) -> str:
    """Return the section's number: the tables and what stands before them belong to Section 1."""
    number = re.match(r"Section (\d\.\d)", equation.place)
    return number[1] if number else "1"


def _title(key: str) -> str:
    return {
        "1": "Sections 1 and 2: notation, equations, tables",
        "2.1": "Section 2.1: area",
        "2.2": "Section 2.2: length",
        "2.3": "Section 2.3: orthogonality",
        "2.4": "Section 2.4: combinations",
        "2.5": "Section 2.5: Winslow",
        "2.6": "Section 2.6: Liao",
        "2.7": "Section 2.7: modified Liao",
        "3.1": "Section 3.1: adaptive weights",
        "3.2": "Section 3.2: transfinite interpolation",
    }.get(key, f"Section {key}")


def _shown(verdict: Verdict) -> Shown:
    item = counterpart(verdict.equation)
    color = "agrees" if verdict.is_plain else "differs" if not verdict.agrees else "condition"
    answer = verdict.status + (f" ({verdict.erratum})" if verdict.erratum else "")
    expression = bool(verdict.difference.free_symbols) and not verdict.agrees
    return Shown(
        verdict,
        answer,
        color,
        () if item is None else tuple(_without_name(formula) for formula in latex_formulas(item)),
        latex(tidy(verdict.difference)) if expression else "",
    )


def _without_name(formula: str) -> str:
    """Return a formula without the name that stands for the left side of an equality of the paper."""
    return formula.removeprefix("left = ")
