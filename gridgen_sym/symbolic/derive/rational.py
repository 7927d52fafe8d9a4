"""Fast exact arithmetic of derived expressions, as quotients of polynomials in many symbols.

What is no quotient of polynomials, such as a root or a logarithm, is a symbol of its own. So an identity that is found
is true, and one that needs a relation between such parts is not found.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy
from sympy import Expr, Symbol

from ..coordinates import FIRST_DERIVATIVES, METRIC, REGULARIZATION, TARGET


class RationalArithmetic:
    """Quotients of polynomials in the first derivatives of the map and in all other symbols of some expressions."""

    def __init__(self, expressions: Iterable[Expr]) -> None:
        """Choose the symbols that these expressions need."""
        self._parts: dict[tuple[Expr, Expr], Symbol] = {}
        self._known: dict[Expr, Any] = {}
        symbols: set[Expr] = {*FIRST_DERIVATIVES}
        for expression in expressions:
            symbols |= self._symbols(expression)
        ordered = sorted(symbols, key=sympy.default_sort_key)
        self._field = sympy.polys.fields.FracField(ordered, sympy.QQ)

    def element(self, expression: Expr) -> Any:  # noqa: ANN401 - a FracElement, with + - * / **
        """Return an expression as a quotient, with the metric written out in the derivatives of the map."""
        if expression not in self._known:
            self._known[expression] = self._element(expression)
        return self._known[expression]

    def expression(self, element: Any) -> Expr:  # noqa: ANN401
        """Return a quotient as an expression."""
        stands_for = {symbol: base**exponent for (base, exponent), symbol in self._parts.items()}
        return element.as_expr().xreplace(stands_for)

    def least_common_multiple(self, polynomials: Iterable[Any]) -> Any:  # noqa: ANN401
        """Return the least common multiple of polynomials, such as the `denom` of quotients, as a quotient."""
        result = self._field.ring(1)
        for polynomial in polynomials:
            result = result.lcm(polynomial)
        return self._field(result)

    def _symbols(self, expression: Expr) -> set[Expr]:
        if expression in _MEANINGS:
            return self._symbols(_MEANINGS[expression])
        if expression.is_Symbol:
            return {expression}
        if expression.is_Rational:
            return set()
        if expression.is_Add or expression.is_Mul:
            return set().union(*map(self._symbols, expression.args))
        base, whole, part = _power(expression)
        return (self._symbols(base) if whole else set()) | ({self._part(base, part)} if part else set())

    def _element(self, expression: Expr) -> Any:  # noqa: ANN401
        if expression in _MEANINGS:
            return self.element(_MEANINGS[expression])
        if expression.is_Symbol:
            return self._field.from_expr(expression)
        if expression.is_Rational:
            return self._field(sympy.QQ(expression.p, expression.q))
        if expression.is_Add:
            return sum((self.element(part) for part in expression.args), self._field(0))
        if expression.is_Mul:
            return sympy.prod((self.element(part) for part in expression.args), start=self._field(1))
        base, whole, part = _power(expression)
        result = self.element(base) ** whole if whole else self._field(1)
        return result * self._field.from_expr(self._part(base, part)) if part else result

    def _part(self, base: Expr, exponent: Expr) -> Symbol:
        """Return the symbol that stands for a power, or for what has no other form."""
        key = (base, exponent)
        if key not in self._parts:
            self._parts[key] = sympy.Dummy(f"part{len(self._parts)}", real=True)
        return self._parts[key]


_MEANINGS: Mapping[Symbol, Expr] = {**METRIC, **REGULARIZATION, **TARGET}


def _power(expression: Expr) -> tuple[Expr, int, Expr]:
    """Return base, n and r of base**(n + r), with a whole n; r = 0 for a whole power, n = 0 for what is none."""
    if not expression.is_Pow or not expression.exp.is_Rational or expression.base.is_number:
        return expression, 0, sympy.S.One
    base, exponent = expression.args
    whole = int(sympy.floor(exponent))
    return base, whole, exponent - whole
