"""Print the sections of a report as plain text."""

from __future__ import annotations

import sympy
from sympy import Expr

from .sections import Divergence, Item, Quasilinear, Section


def text_section(section: Section) -> str:
    """Return a section as plain text, underlined title first."""
    lines = [section.heading, "-" * len(section.heading)]
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
    lines = [_term(coefficient, second) for coefficient, second in equation.terms] or ["+ 0"]
    if equation.factor != 1:
        lines = [f"  ({equation.factor})*(", *lines, "  )"]
    rest = [f"+ ({equation.rest})"] if equation.rest != 0 else []
    return [*lines, *rest, "= 0"]


def _term(coefficient: Expr, second: Expr) -> str:
    sign = "-" if coefficient.could_extract_minus_sign() else "+"
    size = -coefficient if sign == "-" else coefficient
    return f"{sign} {second}" if size == 1 else f"{sign} {_factor(size)}*{second}"


def _factor(expression: Expr) -> str:
    return f"({expression})" if expression.is_Add else str(expression)
