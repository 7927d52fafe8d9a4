"""Write the choices in derivatives with indicators: symbols that are 1 where a comparison holds, and 0 elsewhere."""

from __future__ import annotations

from typing import Any

import sympy
from sympy import Expr, Symbol

from ...functionals.choices import CHOICES
from ...functionals.metric import symbol
from .printer import latex, symbol_name
from .tidy import tidy


class Indicators:
    """The indicators of a report, in the order of their first use."""

    def __init__(self) -> None:
        """Begin without any."""
        self._symbols: dict[tuple[Expr, Expr], Symbol] = {}

    def write(self, expression: Any) -> Any:  # noqa: ANN401 - an expression, or a matrix of them
        """Return an expression with every choice as theta*first + (1 - theta)*second."""
        if isinstance(expression, sympy.MatrixBase):
            return expression.applyfunc(self.write)
        written = self._written(expression)
        names = tuple(name for name in self._symbols.values() if name in written.free_symbols)
        if not names or not written.is_polynomial(*names):
            return written
        total = sympy.S.Zero
        for powers, part in sympy.Poly(written, *names).terms():
            # An indicator is its own square.
            total += sympy.prod(name for name, power in zip(names, powers, strict=True) if power) * tidy(part)
        return total

    def _written(self, expression: Expr) -> Expr:
        if not expression.has(*CHOICES):
            return expression
        if not isinstance(expression, CHOICES):
            return expression.func(*map(self._written, expression.args))
        left, right, first, second = expression.as_choice().args
        name = self._symbols.setdefault((left, right), symbol(f"theta{len(self._symbols) + 1}"))
        return name * self._written(first) + (1 - name) * self._written(second)

    def sentence(self) -> str:
        """Return the definitions of the indicators; nothing where there are none."""
        if not self._symbols:
            return ""
        holds = [f"${symbol_name(name)} = 1$ where ${_comparison(*sides)}$" for sides, name in self._symbols.items()]
        each = "and 0 elsewhere" if len(holds) == 1 else "and each is 0 elsewhere"
        return f"Derivatives are those of the branch that holds; in them, {', '.join(holds)}, {each}."


def _comparison(left: Expr, right: Expr) -> str:
    return f"{latex(right)} > {latex(left)}" if left.is_number else f"{latex(left)} < {latex(right)}"
