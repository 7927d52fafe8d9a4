"""The page of the functionals of the literature: formula, equations and source of each."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gridgen_sym.codegen.derivations import summary
from gridgen_sym.codegen.render import render_page
from gridgen_sym.documentation.functional_page import write_if_changed
from gridgen_sym.functionals import Functional
from gridgen_sym.symbolic.report.latex import latex


def write_literature_page(found: Sequence[Functional], folder: Path) -> Path:
    """Write `literature.md` into a folder and return its path."""
    entries = [
        {"functional": one, "density": latex(one.expression()), "summary": summary(one), "needs": _needs(one)}
        for one in found
    ]
    return write_if_changed(folder / "literature.md", render_page("literature.md.jinja", entries=entries))


def _needs(functional: Functional) -> str:
    """Return what a user gives, parameters with their defaults and fields, and what these must meet."""
    parameters = [f"`{name}` = {value:.4g}" for name, value in functional.parameters.items()]
    fields = [f"the {kind} field `{name}`" for name, kind in functional.fields.items()]
    rules = ", ".join(f"`{rule}`" for rule in functional.constraints)
    return ", ".join((*parameters, *fields)) + (f", with {rules}" if rules else "")
