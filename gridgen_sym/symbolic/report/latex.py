"""Print the sections of a report as LaTeX, for a document that loads amsmath."""

from __future__ import annotations

import re

import sympy
from sympy import Expr, Symbol

from .sections import Divergence, Item, Quasilinear, Section
from .tidy import common_factor

#: A matrix of more letters of LaTeX than this does not fit on a page.
_WIDEST = 360
_GREEK = re.compile(r"xi|eta")
_SPECIAL = {"epsilon": r"\varepsilon", "chi": r"\chi", "root": r"\sqrt{J^2 + \varepsilon^2}"}
#: What a sentence may contain and LaTeX would misread.
_UNSAFE = {
    **{character: f"\\{character}" for character in "_#$%&{}"},
    **{"\\": r"\textbackslash{}", "^": r"\^{}", "~": r"\textasciitilde{}"},
    **{"²": "$^2$", "³": "$^3$", "½": "$1/2$", "¼": "$1/4$", "<": "$<$", ">": "$>$", "–": "--", "—": "---"},
    **{"√": r"$\surd$", "·": r"$\cdot$", "≥": r"$\ge$", "≤": r"$\le$", "∂": r"$\partial$", "∞": r"$\infty$"},
    **{"ξ": r"$\xi$", "η": r"$\eta$", "σ": r"$\sigma$", "λ": r"$\lambda$", "ε": r"$\varepsilon$", "χ": r"$\chi$"},
}


def latex(expression: Expr | sympy.Matrix) -> str:
    r"""Return an expression or a matrix as LaTeX, with the field's symbols: x_{\xi\xi}, g_{11}, J.

    What the entries of a matrix have in common stands before it.
    """
    names = {variable: symbol_name(variable) for variable in expression.free_symbols}
    if not isinstance(expression, sympy.MatrixBase):
        return str(sympy.latex(expression, symbol_names=names))
    factor = common_factor(expression)
    inner = sympy.latex(expression / factor, symbol_names=names, mat_str="matrix", mat_delim="[")
    return inner if factor == 1 else f"{sympy.latex(factor, symbol_names=names)} {inner}"


def symbol_name(variable: Symbol) -> str:
    """Return the LaTeX name of a symbol."""
    name = str(variable)
    if name in _SPECIAL:
        return _SPECIAL[name]
    head, _, tail = name.partition("_")
    if not tail and (match := re.fullmatch(r"([a-zA-Z]+)(\d+)", head)):
        head, tail = match[1], match[2]
    if len(head) > 1:
        head = rf"\mathrm{{{head}}}"
    if not tail:
        return head
    subscript = _GREEK.sub(lambda match: "\\" + match[0] + " ", tail).strip().replace("_", r"\_")
    return f"{head}_{{{subscript}}}"


def latex_section(section: Section) -> str:
    """Return a section as LaTeX: sentences as paragraphs, everything else as displayed formulas."""
    return "\n".join([rf"\subsection*{{{latex_sentence(section.heading)}}}", *(_item(item) for item in section.items)])


def _item(item: Item) -> str:
    match item:
        case str():
            return latex_sentence(item) + "\n"
        case Quasilinear():
            return "\\begin{multline*}\n" + " \\\\\n".join(_rows(item)) + " = 0\n\\end{multline*}"
        case _:
            return "\n".join(f"\\[\n{formula}\n\\]" for formula in latex_formulas(item))


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
            sign, across = ("-", -along_eta) if along_eta.could_extract_minus_sign() else ("+", along_eta)
            flux = rf"\partial_\xi \left({latex(along_xi)}\right) {sign} \partial_\eta \left({latex(across)}\right)"
            return f"{flux}{tail} = 0"
        case Quasilinear():
            return " ".join(_rows(item)).replace(r"\Bigl", "").replace(r"\Bigr", "") + " = 0"
        case (name, expression):
            return f"{latex_label(name)} = {latex(expression)}"


def _rows(equation: Quasilinear) -> list[str]:
    """Return the terms of an equation, each on a row of its own."""
    rows = [_term(coefficient, second) for coefficient, second in equation.terms] or ["0"]
    rows[0] = rows[0].removeprefix("+ ")
    if equation.factor != 1:
        # Brackets of a fixed size: those of \left and \right cannot be in different rows.
        rows[0] = rf"{latex(equation.factor)} \Bigl( {rows[0]}"
        rows[-1] += r" \Bigr)"
    return rows + ([_term(equation.rest)] if equation.rest != 0 else [])


def _term(coefficient: Expr, second: Expr = sympy.S.One) -> str:
    """Return a term with its sign."""
    sign = "-" if coefficient.could_extract_minus_sign() else "+"
    size = -coefficient if sign == "-" else coefficient
    factor = rf"\left({latex(size)}\right)" if size.is_Add else latex(size)
    return f"{sign} {latex(size * second)}" if 1 in (size, second) else f"{sign} {factor} {latex(second)}"


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
    return "".join(_UNSAFE.get(character, character) for character in text)
