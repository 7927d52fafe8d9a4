"""Break long formulas into lines, at signs, outside brackets first and then within."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import sympy
from sympy import Expr

from .printer import latex, ordered_terms, small_brackets, split_sign
from .widths import width

#: Of a sign with its spaces.
_SIGN = 15.0
#: How far lines after the first are indented, for each level of brackets.
INDENT = 10.0
_DEEPEST = 3
#: A sum beside another one is opened where it takes more than this part of a line.
_NARROW = 0.35


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a formula that stays on one line.

    Attributes:
        text: in LaTeX; all but the first of a formula begin with their sign.
        depth: how many brackets are open before it.
    """

    text: str
    depth: int = 0


def pieces(expression: Expr, limit: float) -> list[Piece]:
    """Return a formula in pieces: the terms of a sum, and of sums within products that are wide.

    Args:
        expression: of any size.
        limit: a term that is wider is opened, in points.
    """
    if expression.is_Add:
        found: list[Piece] = []
        for term in ordered_terms(expression):
            found = joined(found, *signed(term, limit))
        return found
    sign, size = signed(expression, limit)
    return _before(sign, size)


def signed(expression: Expr, limit: float) -> tuple[str, list[Piece]]:
    """Return the sign of a term, `-` or nothing, and the rest in pieces."""
    sign, size = split_sign(expression)
    whole = latex(size)
    if width(whole) <= limit - _SIGN or not size.args:
        return sign, [Piece(whole)]
    return sign, _opened(size, limit - _SIGN) or [Piece(whole)]


def joined(before: list[Piece], sign: str, term: list[Piece]) -> list[Piece]:
    """Add a term with its sign to a sum."""
    return [*before, *_before(sign or ("+" if before else ""), term)]


def _before(text: str, parts: list[Piece]) -> list[Piece]:
    """Put a text before the first piece."""
    first, *rest = parts
    return [replace(first, text=f"{text} {first.text}".strip()), *rest]


def after(parts: list[Piece], text: str) -> list[Piece]:
    """Put a text behind the last piece."""
    *rest, last = parts
    return [*rest, replace(last, text=f"{last.text}{text}")]


def _opened(expression: Expr, limit: float) -> list[Piece]:
    """Return a wide product, power or function with the brackets of its wide sums opened; nothing where it has none."""
    if isinstance(expression, sympy.exp):
        return bracketed(pieces(expression.args[0], limit), before=r"\exp")
    factors = sympy.Mul.make_args(expression)
    sums = [factor for factor in factors if _base(factor).is_Add and (factor.is_Add or factor.exp.is_positive)]
    if not sums:
        return []
    turned = [factor for factor in sums if latex(_base(factor)).startswith("-")]
    sign = sympy.Mul(*((-1) ** (1 if factor.is_Add else factor.exp) for factor in turned))
    others = sympy.Mul(sign, *(factor for factor in factors if factor not in sums))
    text = "" if others == 1 else latex(others)
    found: list[Piece] = []
    by_width = sorted(sums, key=lambda factor: (width(latex(factor)), sympy.default_sort_key(factor)))
    for factor in by_width:
        base = -_base(factor) if factor in turned else _base(factor)
        power = f"^{{{latex(factor.exp)}}}" if factor.is_Pow else ""
        whole = small_brackets(rf"\left({latex(base)}\right)") + power
        if width(whole) <= _NARROW * limit and factor is not by_width[-1]:
            text = f"{text} {whole}".strip()
            continue
        opened = bracketed(pieces(base, limit), behind=power)
        found = found or ([Piece(text)] if text else [])  # Narrow factors come first.
        found = _multiplied(found, opened, limit) if found else opened
    return found


def _multiplied(first: list[Piece], second: list[Piece], limit: float) -> list[Piece]:
    """Return a product, with a sign of multiplication between its factors where they are too wide for one line."""
    if width(f"{first[-1].text} {second[0].text}") <= (limit if len(first) == 1 else _NARROW * limit):
        return [*after(first, f" {second[0].text}"), *second[1:]]
    return [*first, *_before(r"\times", second)]


def _base(factor: Expr) -> Expr:
    return factor.base if factor.is_Pow else factor


def bracketed(inner: list[Piece], before: str = "", behind: str = "") -> list[Piece]:
    r"""Put pieces into brackets of a fixed size: those of \left and \right cannot be on different lines."""
    size = "Big" if any(r"\frac" in piece.text for piece in inner) else "big"
    first, *rest = inner
    deeper = [first, *(replace(piece, depth=piece.depth + 1) for piece in rest)]
    return after(_before(rf"{before}\{size}l(", deeper), rf" \{size}r){behind}")


def lines(parts: Sequence[Piece], limit: float) -> list[Piece]:
    """Fill lines with pieces; a term goes to the next line whole, where that is enough.

    Args:
        parts: of a formula.
        limit: the width of a line, in points.

    Returns:
        One piece a line, with the depth of its first one.
    """
    found: list[Piece] = []
    for k, part in enumerate(parts):
        term = " ".join(piece.text for piece in parts[k : _end(parts, k)])
        if found and width(f"{found[-1].text} {term}") <= limit - (indent(found[-1]) if len(found) > 1 else 0):
            found[-1] = replace(found[-1], text=f"{found[-1].text} {part.text}")
        else:
            found.append(part)
    return found


def _end(parts: Sequence[Piece], start: int) -> int:
    """Return where the term that starts with a piece ends: at the next piece that is no deeper."""
    return next((k for k in range(start + 1, len(parts)) if parts[k].depth <= parts[start].depth), len(parts))


def indent(line: Piece) -> float:
    """Return how far a line after the first is indented."""
    return INDENT * (1 + min(line.depth, _DEEPEST))
