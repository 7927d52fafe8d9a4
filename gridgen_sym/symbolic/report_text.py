"""Print the sections of a report as plain text."""

from __future__ import annotations

import sympy

from .report_sections import Divergence, Item, Quasilinear, Section


def text_section(section: Section) -> str:
    """Return a section as plain text, underlined title first."""
    lines = [section.title, "-" * len(section.title)]
    for item in section.items:
        lines += _lines(item)
    return "\n".join(lines)


def _lines(item: Item) -> list[str]:
    match item:
        case str():
            return [item]
        case Divergence(along_xi, along_eta, source):
            tail = "" if source == 0 else f" - ({source})"
            return [f"d/dxi({along_xi}) + d/deta({along_eta}){tail} = 0"]
        case Quasilinear():
            return _quasilinear(item)
        case (name, sympy.MatrixBase() as matrix):
            rows = ["[" + ", ".join(str(entry) for entry in matrix.row(i)) + "]" for i in range(matrix.shape[0])]
            return [f"{name} = {rows[0]}", *(" " * (len(name) + 3) + row for row in rows[1:])]
        case (name, expression):
            return [f"{name} = {expression}"]


def _quasilinear(equation: Quasilinear) -> list[str]:
    parts = [f"({coefficient})*{second}" for coefficient, second in equation.terms if coefficient != 0]
    if equation.rest != 0:
        parts.append(f"({equation.rest})")
    return ["  " + "\n+ ".join(parts or ["0"]) + "\n= 0"]
