"""Print expressions as LaTeX in the order of the field: x_xi before x_eta, coefficients before derivatives."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any

import sympy
from sympy import Expr, Symbol
from sympy.printing.latex import LatexPrinter

from ..classify.principal_symbol import k1, k2
from ..coordinates import FIRST_DERIVATIVES, METRIC, SECOND_DERIVATIVES, s
from .tidy import common_factor

_GREEK = re.compile(r"xi|eta")
_SPECIAL = {"epsilon": r"\varepsilon", "chi": r"\chi", "root": r"\sqrt{J^2 + \varepsilon^2}"}
#: Names that are Greek letters.
GREEK = frozenset(
    (
        *("alpha", "beta", "gamma", "delta", "zeta", "eta", "theta", "kappa", "lambda", "mu", "nu", "xi", "rho"),
        *("sigma", "tau", "phi", "chi", "psi", "omega"),
    )
)
#: Factors of a product and terms of a sum are in the order of these classes; what is in none of them goes first.
_CLASSES = ((s,), tuple(METRIC), FIRST_DERIVATIVES, (k1, k2), SECOND_DERIVATIVES)
_LAST = len(_CLASSES) + 1
_LEADING = (k1, k2, *SECOND_DERIVATIVES)
_RANKS = {variable: rank for rank, members in enumerate(_CLASSES, 1) for variable in members}
#: Brackets around what holds none of these need not grow.
_TALL = re.compile(r"\\frac|\\sqrt|\\begin")


def latex(expression: Expr | sympy.Matrix) -> str:
    r"""Return an expression or a matrix as LaTeX, with the field's symbols: x_{\xi\xi}, g_{11}, J.

    What the entries of a matrix have in common stands before it.
    """
    if not isinstance(expression, sympy.MatrixBase):
        return _printed(sympy.sympify(expression))
    factor = common_factor(expression)
    inner = r" \\ ".join(" & ".join(latex(entry / factor) for entry in row) for row in expression.tolist())
    matrix = rf"\begin{{bmatrix}} {inner} \end{{bmatrix}}"
    return matrix if factor == 1 else f"{latex(factor)} {matrix}"


@lru_cache(maxsize=4096)
def _printed(expression: Expr) -> str:
    return small_brackets(_Printer().doprint(expression))


def symbol_name(variable: Symbol) -> str:
    r"""Return the LaTeX name of a symbol: `g_{11}`, `x_{\xi \xi}`, `k_{A}`, `M_{11,\xi}`."""
    name = str(variable)
    if name in _SPECIAL:
        return _SPECIAL[name]
    head, _, tail = name.partition("_")
    below = [_GREEK.sub(lambda match: "\\" + match[0] + " ", tail).strip().replace("_", r"\_")] if tail else []
    if match := re.fullmatch(r"([a-zA-Z]+)(\d+)", head):
        head, below = match[1], [match[2], *below]
    if len(head) > 1:
        head = f"\\{head}" if head in GREEK else rf"\mathrm{{{head}}}"
    return f"{head}_{{{','.join(below)}}}" if below else head


def ordered_terms(expression: Expr) -> list[Expr]:
    """Return the terms of a sum in the order in which they are printed: by their powers, those with k1 and xi first."""
    return list(_ordered(expression))


@lru_cache(maxsize=4096)
def _ordered(expression: Expr) -> tuple[Expr, ...]:
    powers = {term: term.as_powers_dict() for term in expression.args}
    bases = {base for found in powers.values() for base in found if not base.is_Number}
    order = sorted(bases, key=lambda base: (base not in _LEADING, _sort_key(base)))
    keys = {term: [-_number(found.get(base)) for base in order] for term, found in powers.items()}
    first, *rest = sorted(expression.args, key=lambda term: (keys[term], sympy.default_sort_key(term)))
    number = expression.as_coeff_Add()[0]
    if number.is_positive and first.could_extract_minus_sign():
        return (number, first, *(term for term in rest if term != number))  # 1 - J, not -J + 1
    return (first, *rest)


def _number(power: Expr | None) -> float:
    return float(power) if power is not None and power.is_number else 0.0


def _sort_key(base: Expr) -> tuple[int, Any]:
    """Return where a factor stands: by its class, and along xi before along eta; sums and functions go last."""
    if not base.is_Symbol:
        return _LAST, sympy.default_sort_key(base)
    name = str(base)
    head, _, tail = name.partition("_")
    if re.fullmatch(r"(xi|eta)+", tail):
        name = f"{head}_{tail.replace('xi', 'a').replace('eta', 'b')}"
    return _RANKS.get(base, 0), name


def split_sign(expression: Expr) -> tuple[str, Expr]:
    """Return `-` and the negative of an expression that is printed with a sign first; else nothing and itself."""
    if latex(expression).startswith("-"):
        return "-", _negative(expression)
    return "", expression


def _negative(expression: Expr) -> Expr:
    """Return the negative; of a product with a sum as a product, which SymPy would multiply out."""
    if not expression.is_Mul:
        return -expression
    first, *rest = expression.args
    if first.is_Number and first < 0:
        return sympy.Mul(*([] if first == -1 else [-first]), *rest, evaluate=False) if len(rest) > 1 else -expression
    turned = next(factor for factor in expression.args if factor.is_Add and latex(factor).startswith("-"))
    return sympy.Mul(*(-factor if factor is turned else factor for factor in expression.args), evaluate=False)


class _Printer(LatexPrinter):  # type: ignore[misc]
    """Prints sums in the order of `ordered_terms`, and products without sums that begin with a minus sign."""

    def __init__(self) -> None:
        super().__init__({"fold_frac_powers": True, "parenthesize_super": False})
        self._texts: dict[Symbol, str] = {}

    def _print_Symbol(self, expr: Symbol, style: str = "plain") -> str:  # noqa: N802 - SymPy's names
        return self._texts.get(expr) or symbol_name(expr)

    def _print_Add(self, expr: Expr, order: Any = None) -> str:  # noqa: ANN401, N802
        first, *rest = (str(self._print(term)) for term in ordered_terms(expr))
        return first + "".join(f" - {term[1:].strip()}" if term.startswith("-") else f" + {term}" for term in rest)

    def _print_Pow(self, expr: Expr) -> str:  # noqa: N802
        turned = (
            expr.base.is_Add and expr.exp.is_Integer and expr.exp % 2 == 0 and self._print(expr.base).startswith("-")
        )
        return str(super()._print_Pow(sympy.Pow(-expr.base, expr.exp) if turned else expr))

    def _print_Mul(self, expr: Expr) -> str:  # noqa: N802
        """Print a product of stand-ins: SymPy would multiply a sum by a number, or turn its sign."""
        if not expr.is_Mul:  # SymPy prints 1/x as a product.
            return str(super()._print_Mul(expr))
        factors, turned = [], False
        for factor in sorted(expr.args, key=lambda factor: _sort_key(factor.base if factor.is_Pow else factor)):
            if factor.is_Number:
                factors.append(factor)
                continue
            base, power = factor.as_base_exp() if factor.is_Pow and factor.exp.is_Rational else (factor, sympy.S.One)
            if not power.is_Integer:
                base, power = base ** abs(power), sympy.sign(power)
            text = self._print(base)
            if base.is_Add:
                if text.startswith("-"):
                    text, turned = self._print(-base), turned != bool(power % 2)
                text = text if _is_alone(expr, factor) else rf"\left({text}\right)"
            elif base.is_Mul:
                text = rf"\left({text}\right)"
            factors.append(self._stand_in(text) ** power)
        product = sympy.Mul(-1 if turned else 1, *factors)
        return str(super()._print_Mul(product) if product.is_Mul else self._print(product))

    def _stand_in(self, text: str) -> Symbol:
        symbol = Symbol(f"stand_in_{len(self._texts):04}")
        self._texts[symbol] = text
        return symbol


def _is_alone(product: Expr, factor: Expr) -> bool:
    """Return whether a factor, with the power 1 or -1, is all that stands above or below the line of a fraction."""
    sides = {1: 0, -1: 0}
    for other in product.args:
        if other.is_Rational:
            sides[1] += abs(other.p) != 1
            sides[-1] += other.q != 1
        else:
            sides[-1 if _is_below(other) else 1] += 1
    side = -1 if _is_below(factor) else 1
    return sides[side] == 1 and (side == -1 or sides[-1] > 0) and (factor.is_Add or factor.exp == -1)


def _is_below(factor: Expr) -> bool:
    return bool(factor.is_Pow and factor.exp.is_negative)


def small_brackets(text: str) -> str:
    r"""Take \left and \right from round brackets around what is not tall."""
    opened: list[int] = []
    spans: list[tuple[int, int]] = []
    for match in re.finditer(r"\\left(?![a-z])|\\right(?![a-z])", text):
        if match[0] == r"\left":
            opened.append(match.end())
            continue
        start = opened.pop()
        if text[start] == "(" and not _TALL.search(text, start, match.start()):
            spans += [(start - len(r"\left"), start), match.span()]
    for start, end in sorted(spans, reverse=True):
        text = text[:start] + text[end:]
    return re.sub(r"(?<!\\)\s+\)", ")", text)
