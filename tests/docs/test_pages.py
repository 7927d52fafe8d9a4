"""Pages say what is derived now: a changed derivation changes them, and prose quotes what the program holds."""

from __future__ import annotations

import dataclasses
import functools
import re
from pathlib import Path

import pytest
from derived_pages.paper_pages import chapters
from derived_pages.reference_pages import command_helps, public_names
from support import BUILTIN

import gridgen_sym
from gridgen_sym import selfcheck
from gridgen_sym.backends.c.printer import CPrinter
from gridgen_sym.codegen.backend import find_backend
from gridgen_sym.codegen.programs import kernel
from gridgen_sym.codegen.render import render_document
from gridgen_sym.documentation.advice import consequences
from gridgen_sym.documentation.derived_page import _parts
from gridgen_sym.functionals import functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.functionals.expression import FUNCTION_NAMES
from gridgen_sym.functionals.metric import DENSITY_NAMES
from gridgen_sym.resources import resource_folder
from gridgen_sym.symbolic import classify, derive_text, euler_lagrange
from gridgen_sym.symbolic.paper.errata import ERRATA
from gridgen_sym.symbolic.paper.verify import verify
from gridgen_sym.symbolic.report import sections as report_sections

ROOT = Path(__file__).resolve().parents[2]


@functools.cache
def verified():
    """Return the verdicts on the paper, decided once for the tests of this file."""
    return verify()


def formulas(name):
    return [text for part in _parts(functional(name)) for kind, text in part.blocks if kind == "formula"]


@pytest.mark.slow
def test_a_changed_equation_changes_the_page_and_the_committed_text(monkeypatch):
    before = formulas("winslow")
    committed = (resource_folder("generated") / "docs" / "winslow.md").read_text(encoding="utf-8")
    winslow = functional("winslow")
    assert render_document(winslow, derive_text(winslow)).text == committed

    def flipped(definition, variant="plain"):
        derived = euler_lagrange(definition, variant)
        (second, (first, other)), *rest = derived.coefficients.items()
        return dataclasses.replace(derived, coefficients=dict([(second, (-first, other)), *rest]))

    monkeypatch.setattr(report_sections, "euler_lagrange", flipped)
    assert sum(one != two for one, two in zip(before, formulas("winslow"), strict=True)) == 1
    assert render_document(winslow, derive_text(winslow)).text != committed


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILTIN)
def test_a_page_has_every_part(name):
    parts = list(_parts(functional(name)))
    headings = [part.heading for part in parts if part.heading]
    for wanted in ("## Corner energy and gradient", "## Euler-Lagrange", "### Divergence", "### Expanded", "## Class"):
        assert any(heading.startswith(wanted) for heading in headings), wanted
    assert {"Corner Hessian", "Semidefinite part of the Hessian"} <= {part.fold for part in parts}
    shown = [text for part in parts if not part.fold for kind, text in part.blocks if kind == "formula"]
    assert 8 <= len(shown) <= 25
    for text in shown:
        assert text.count("{") == text.count("}")
    assert functional(name).use_when
    assert functional(name).avoid_when


def test_advice_follows_from_properties_alone():
    told = "\n".join(consequences(classify(Functional("mine", "(g11 + g22)/J"))))
    assert "It has a barrier" in told
    assert "elliptic (proved)" in told
    assert told == "\n".join(consequences(classify(functional("winslow"))))
    assert "null Lagrangian" in "".join(consequences(classify(Functional("mine", "J"))))
    assert "not invariant under rotation" in "".join(consequences(classify(Functional("mine", "x_xi**2 + J**2"))))


@pytest.mark.slow
def test_the_papers_pages_show_every_equation_and_erratum():
    verdicts = verified()
    parts = chapters(verdicts)
    assert [one.verdict for part in parts for one in part.equations] == list(verdicts)
    assert {one.verdict.erratum for part in parts for one in part.equations} == {None, *(e.key for e in ERRATA)}
    by_key = {one.verdict.equation.key: one for part in parts for one in part.equations}
    assert by_key["area-expanded-2"].difference == r"y_{\xi} x_{\eta \eta} (x_{\xi} - y_{\xi})"
    assert by_key["area-divergence-1"].derived == (
        r"\partial_\xi \left(J y_{\eta}\right) - \partial_\eta \left(J y_{\xi}\right) = 0",
    )
    assert by_key["length-expanded-1"].derived == (r"x_{\xi \xi} + x_{\eta \eta} = 0",)
    assert {one.color for part in parts for one in part.equations} == {"agrees", "condition", "differs"}


def test_the_pipeline_page_quotes_what_the_program_holds():
    text = (ROOT / "docs" / "pipeline.md").read_text(encoding="utf-8")
    blocks = [block.split("\n", 1) for block in text.split("```")[1::2]]
    library = (ROOT / "gridgen_sym" / "functionals" / "library.py").read_text(encoding="utf-8")
    derived = kernel(functional("winslow"))
    printed = CPrinter().program(derived.programs["corner_slopes"])
    program = [f"{one.name} = {one.value}" for one in derived.programs["corner_slopes"].assignments]
    source = find_backend("c").render(derived)
    real = "\n".join([derive_text(functional("winslow")), *program, source, library])
    quoted = [line for language, body in blocks if language in ("python", "c") for line in body.splitlines()]
    quoted += [
        line for _, body in blocks for line in body.splitlines() if re.match(r"d?E|d/dx|det M|w_|t\d|slope_\w+ =", line)
    ]
    known = {line.strip() for line in real.splitlines()}
    assert len(printed) == len(program)
    # The decorator is quoted in part, and what silences a tool is left out.
    starts = [line.strip() for line in quoted if not line.startswith("@")]
    assert [start for start in starts if not any(line.startswith(start) for line in known)] == []
    assert len(quoted) > 25


def test_the_pages_quote_the_checks_as_they_come():
    told = [check.text for check in selfcheck.checks(functional("winslow"))]
    number = re.compile(r"\d\.\d+(?:e-?\d+)?")
    for page in ("pipeline.md", "explanations/two_sides.md"):
        text = (ROOT / "docs" / page).read_text(encoding="utf-8")
        quoted = re.findall(r"^ok      (.*)$", text, re.MULTILINE)
        assert len(quoted) in (1, len(told))
        for line, real in zip(quoted, told[-len(quoted) :], strict=True):
            # Round-off differs from one machine to the next, and no more than that.
            assert number.sub("#", line) == number.sub("#", real)
            for one, two in zip(number.findall(line), number.findall(real), strict=True):
                assert 0.03 < float(one) / float(two) < 30


@pytest.mark.slow
def test_what_the_home_page_and_the_readme_claim():
    table = (ROOT / "docs" / "validity.md").read_text(encoding="utf-8").split("## Summary")[1].split("## ")[0]
    rows = [
        [int(cell) for cell in row.split("|")[2:-1]] for row in re.findall(r"^\| [A-Z].*\d \|$", table, re.MULTILINE)
    ]
    cases, impossible, valid = (sum(row[column] for row in rows) for column in (0, 1, 5))
    assert len(rows) == 4
    assert cases == impossible + valid
    home, readme = (
        " ".join((ROOT / file).read_text(encoding="utf-8").split()) for file in ("docs/index.md", "README.md")
    )
    for text in (home, readme):
        assert f"{cases} hard boundaries {valid} grids are valid; for the other {impossible} a certificate" in text
    verdicts = verified()
    agree, errata = (sum(verdict.is_plain for verdict in verdicts), sum(bool(one.erratum) for one in verdicts))
    condition = len(verdicts) - agree - errata
    assert f"{agree} agree, {condition} hold under a condition, {errata} are errata" in home
    assert f"{len(verdicts)} equations and claims" in home


def test_the_reference_has_every_public_name_and_command():
    named = {name for names in public_names().values() for _, name in names}
    assert {"optimize", "Grid", "define", "Result", "Weight"} <= named
    assert [name for name in named if not hasattr(gridgen_sym, name)] == []
    helps = dict(command_helps())
    assert "--functional" in helps["gridgen-sym grid"]
    assert "gridgen-sym docs" in helps


def test_the_page_of_the_language_lists_all_functions_and_names():
    page = (ROOT / "docs" / "reference" / "language.md").read_text(encoding="utf-8")
    assert not [name for name in FUNCTION_NAMES if f"`{name}(" not in page]
    assert not [name for name in DENSITY_NAMES if f"`{name}`" not in page]
    refused = re.findall(r"^\| `(.*?)` \|.*\|.*\|$", page.partition("| refused |")[2], flags=re.MULTILINE)
    assert len(refused) == 3
    for density in refused:
        with pytest.raises(gridgen_sym.GridgenError):
            gridgen_sym.define("refused", density)
    for density in re.findall(r"`(where\(J > 1, .*?\))`", page):
        gridgen_sym.define("written", density, replace=True)
