"""Numbered, labeled equations in LaTeX: alone or in groups, broken into lines where they are wide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .breaking import INDENT, Piece, indent, lines
from .widths import LINE, width

#: An equation of more lines than this may go on over the page: `split` keeps its lines together.
_TOGETHER = 16


@dataclass(frozen=True, slots=True)
class Equation:
    """One equation.

    Attributes:
        label: unique in the document.
        left: its left side in LaTeX; nothing for an equation whose right side is 0, which stands in `right`.
        right: the rest, in pieces.
    """

    label: str
    left: str
    right: tuple[Piece, ...]


def one(equation: Equation, end: str = ".") -> str:
    """Return an equation with a number of its own, followed by `end`."""
    rows = _rows(equation, _limit([equation]))
    rows[-1] += end
    if len(rows) == 1:
        return _environment("equation", f"{_label(equation.label)}\n{rows[0].replace('&', '', 1)}")
    if len(rows) > _TOGETHER:
        return _environment("align", _aligned(rows, equation.label))
    body = _environment("split", " \\\\\n".join(rows))
    return _environment("equation", f"{_label(equation.label)}\n{body}")


def group(equations: Sequence[Equation], label: str, end: str = ".") -> str:
    """Return equations under one number, with letters of their own, separated by commas and followed by `end`."""
    limit = _limit(equations)
    blocks = []
    for k, equation in enumerate(equations):
        rows = _rows(equation, limit)
        rows[-1] += end if k == len(equations) - 1 else ","
        blocks.append(_aligned(rows, equation.label))
    return _environment("subequations", f"{_label(label)}\n" + _environment("align", " \\\\\n".join(blocks)))


def _limit(equations: Sequence[Equation]) -> float:
    return LINE - max(width(f"{equation.left} =") if equation.left else 0.0 for equation in equations)


def _rows(equation: Equation, limit: float) -> list[str]:
    first, *rest = lines(equation.right, limit)
    head = f"{equation.left} &= {first.text}" if equation.left else f"& {first.text}"
    return [head, *(f"& {_space(row)} {row.text}" for row in rest)]


def _space(line: Piece) -> str:
    """Return the indentation of a line, and an empty group where a sign begins it: it keeps its spaces."""
    space = r"\quad" * round(indent(line) / INDENT)
    return f"{space} {{}}" if line.text.startswith(("+", "-", r"\times")) else space


def _aligned(rows: Sequence[str], label: str) -> str:
    """Return the lines of an equation within `align`: the last one has the number."""
    return " \\notag \\\\\n".join(rows) + f" {_label(label)}"


def _label(label: str) -> str:
    return rf"\label{{{label}}}"


def _environment(name: str, body: str) -> str:
    return f"\\begin{{{name}}}\n{body}\n\\end{{{name}}}"
