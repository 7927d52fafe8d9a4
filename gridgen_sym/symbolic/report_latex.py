"""Print the sections of a report as LaTeX, for a document that loads amsmath."""

from __future__ import annotations

import re

import sympy
from sympy import Expr, Symbol

from .report_sections import Divergence, Item, Quasilinear, Section

_GREEK = re.compile(r"xi|eta")
_SPECIAL = {"epsilon": r"\varepsilon", "chi": r"\chi", "root": r"\sqrt{J^2 + \varepsilon^2}"}


def latex(expression: Expr | sympy.Matrix) -> str:
    r"""Return an expression or a matrix as LaTeX, with the field's symbols: x_{\xi\xi}, g_{11}, J."""
    names = {variable: symbol_name(variable) for variable in expression.free_symbols}
    return str(sympy.latex(expression, symbol_names=names, mat_str="matrix", mat_delim="["))


def symbol_name(variable: Symbol) -> str:
    """Return the LaTeX name of a symbol."""
    name = str(variable)
    if name in _SPECIAL:
        return _SPECIAL[name]
    head, _, tail = name.partition("_")
    if not tail and (match := re.fullmatch(r"([a-zA-Z]+)(\d+)", head)):
        head, tail = match[1], match[2]
    if not tail:
        return head if len(head) == 1 else rf"\mathrm{{{head}}}"
    subscript = _GREEK.sub(lambda match: "\\" + match[0] + " ", tail).strip().replace("_", r"\_")
    return f"{head}_{{{subscript}}}"


def latex_section(section: Section) -> str:
    """Return a section as LaTeX: sentences as paragraphs, everything else as displayed formulas."""
    return "\n".join([rf"\subsection*{{{_sentence(section.title)}}}", *(_item(item) for item in section.items)])


def _item(item: Item) -> str:
    match item:
        case str():
            return _sentence(item) + "\n"
        case Divergence(along_xi, along_eta, source):
            tail = "" if source == 0 else rf" - \left({latex(source)}\right)"
            flux = rf"\partial_\xi \left({latex(along_xi)}\right) + \partial_\eta \left({latex(along_eta)}\right)"
            return _display(f"{flux}{tail} = 0")
        case Quasilinear(terms, rest):
            parts = [rf"\left({latex(factor)}\right) {latex(second)}" for factor, second in terms if factor != 0]
            parts += [latex(rest)] if rest != 0 else []
            return "\\begin{multline*}\n" + " \\\\\n + ".join(parts or ["0"]) + " = 0\n\\end{multline*}"
        case (name, expression):
            return _display(rf"{_label(name)} = {latex(expression)}")


def _display(formula: str) -> str:
    return f"\\[\n{formula}\n\\]"


def _label(name: str) -> str:
    """Return the LaTeX of a name such as dE/dx_xi, d²E/dx_xidy_eta, H+/dx_xidx_xi or det A(k)."""
    if "/" in name:
        head, below = name.split("/")
        variables = [symbol_name(Symbol(part)) for part in re.findall(r"[xy]_(?:xi|eta)", below)]
        if head == "H+":
            return "H^{+}_{" + ",\\,".join(variables) + "}"
        order = "^2" if len(variables) == 2 else ""
        return rf"\frac{{\partial{order} E}}{{" + " ".join(rf"\partial {variable}" for variable in variables) + "}"
    if name.startswith("det "):
        return r"\det " + name[4:]
    return symbol_name(Symbol(name)) if "_" in name else name


def _sentence(text: str) -> str:
    """Return a sentence with its symbols safe for LaTeX."""
    replacements = {"²": "$^2$", "_": r"\_", "^": r"\^{}", "<": "$<$", ">": "$>$"}
    return "".join(replacements.get(character, character) for character in text)
