"""Print the items of a report as LaTeX formulas without numbers, as pages show them."""

from __future__ import annotations

import re
import unicodedata

import sympy
from sympy import Expr, Symbol

from .printer import GREEK, small_brackets, split_sign, symbol_name
from .printer import latex as latex
from .sections import Divergence, Quasilinear

#: A matrix of more letters of LaTeX than this does not fit on a page.
_WIDEST = 360
#: What a sentence may contain and LaTeX would misread.
_UNSAFE = {
    **{character: f"\\{character}" for character in "_#$%&{}"},
    **{"\\": r"\textbackslash{}", "^": r"\^{}", "~": r"\textasciitilde{}"},
    **{"½": "$1/2$", "¼": "$1/4$", "<": "$<$", ">": "$>$", "–": "--", "—": "---", "’": "'"},
    **{"√": r"$\surd$", "·": r"$\cdot$", "≥": r"$\ge$", "≤": r"$\le$", "∂": r"$\partial$", "∞": r"$\infty$"},
    **{"ε": r"$\varepsilon$", "×": r"$\times$", "∇": r"$\nabla$", "→": r"$\to$", "±": r"$\pm$"},
}
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ᵗᵀ", "0123456789-+tT")
_WORDS = re.compile(r"[⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ᵗᵀ]+|.", re.DOTALL)


def latex_formulas(item: Divergence | Quasilinear | tuple[str, Expr | sympy.Matrix]) -> list[str]:
    """Return an equation of a report as formulas without breaks; entries of a wide matrix are formulas each."""
    match item:
        case (name, sympy.MatrixBase() as matrix) if len(latex(matrix)) > _WIDEST:
            symmetric = matrix.is_symmetric()
            places = [(i, j) for i in range(matrix.rows) for j in range(matrix.cols) if i <= j or not symmetric]
            return [f"{latex_label(name)}_{{{i + 1}{j + 1}}} = {latex(matrix[i, j])}" for i, j in places]
        case _:
            return [_formula(item)]


def _formula(item: Divergence | Quasilinear | tuple[str, Expr | sympy.Matrix]) -> str:
    match item:
        case Divergence(along_xi, along_eta, source):
            tail = "" if source == 0 else rf" - \left({latex(source)}\right)"
            sign, across = split_sign(along_eta)
            sign = sign or "+"
            flux = rf"\partial_\xi \left({latex(along_xi)}\right) {sign} \partial_\eta \left({latex(across)}\right)"
            return f"{flux}{tail} = 0"
        case Quasilinear():
            return f"{_terms(item)} = 0"
        case (name, expression):
            return f"{latex_label(name)} = {latex(expression)}"


def _terms(equation: Quasilinear) -> str:
    """Return the left side of an equation."""
    text = " ".join(_term(coefficient, second) for coefficient, second in equation.terms).removeprefix("+ ") or "0"
    if equation.factor != 1:
        text = rf"{latex(equation.factor)} \left( {text} \right)"
    return f"{text} {_term(equation.rest)}" if equation.rest != 0 else text


def _term(coefficient: Expr, second: Expr = sympy.S.One) -> str:
    """Return a term with its sign; a sum alone keeps its own."""
    if coefficient.is_Add and second == 1:
        text = latex(coefficient)
        return text if text.startswith("-") else f"+ {text}"
    sign, size = split_sign(coefficient)
    factor = small_brackets(rf"\left({latex(size)}\right)") if size.is_Add else latex(size)
    shown = " ".join(text for text in (factor, latex(second)) if text != "1") or "1"
    return f"{sign or '+'} {shown}"


def latex_label(name: str) -> str:
    """Return the LaTeX of a name such as dE/dx_xi, d²E/dx_xidy_eta, H+/dx_xidx_xi or det A(k)."""
    if "/" in name:
        head, below = name.split("/")
        variables = [symbol_name(Symbol(part)) for part in re.findall(r"[xy]_(?:xi|eta)", below)]
        if head == "H+":
            return "H^{+}_{" + ",\\,".join(variables) + "}"
        order = "^2" if len(variables) == 2 else ""
        return rf"\frac{{\partial{order} E}}{{" + r"\,".join(rf"\partial {variable}" for variable in variables) + "}"
    if name.startswith("det "):
        return r"\det " + name[4:]
    return symbol_name(Symbol(name)) if "_" in name else name


def latex_sentence(text: str) -> str:
    """Return a sentence with its symbols safe for LaTeX."""
    return _WORDS.sub(lambda match: _safe(match[0]), text)


def _safe(part: str) -> str:
    """Return a character, or characters that are raised, as LaTeX."""
    if part.translate(_RAISED) != part:
        return f"$^{{{part.translate(_RAISED)}}}$"
    letter = unicodedata.name(part, "").removeprefix("GREEK SMALL LETTER ").lower() if not part.isascii() else ""
    return f"$\\{letter}$" if letter in GREEK else _UNSAFE.get(part, part)
