"""Print the expressions of a `Program` in the language of a back end; terms and factors in SymPy's canonical order."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import sympy
from sympy import Expr

from ..functionals.choices import choice
from .kernel import Program, reciprocal
from .lower import LARGEST_PRODUCT


class Printer(ABC):
    """Prints the nodes that most languages write alike; subclasses define what differs."""

    #: Names of functions in the language, by SymPy's name.
    functions: Mapping[str, str] = {}

    def program(self, program: Program) -> list[tuple[str, str]]:
        """Return the program as (name, text of the value) pairs."""
        self._parameters = {name: f"parameters[{k}]" for k, name in enumerate(program.parameters)}
        return [(assignment.name, self.expression(assignment.value)) for assignment in program.assignments]

    def expression(self, node: Expr) -> str:
        """Return the text of an expression."""
        if isinstance(node, sympy.Symbol):
            name: str = node.name
            return self._parameters.get(name, name)
        if isinstance(node, sympy.Rational):
            return f"{node.p}.0" if node.q == 1 else f"({node.p}.0/{node.q}.0)"
        if node in (sympy.pi, sympy.E):
            return repr(float(node))
        if isinstance(node, sympy.Add):
            return self._sum(node)
        if isinstance(node, sympy.Mul):
            return self._product(node)
        if isinstance(node, reciprocal):
            return f"1.0/{self._factor(node.args[0])}"
        if isinstance(node, sympy.Pow):
            return self._power(node)
        arguments = [self.expression(argument) for argument in node.args]
        if isinstance(node, choice):
            left, right, first, second = arguments
            test = f"{right} > {left}" if node.args[0].is_number else f"{left} < {right}"
            return self._choice(test, first, second)
        return f"{self.functions[type(node).__name__]}({', '.join(arguments)})"

    def _sum(self, node: sympy.Add) -> str:
        # A positive term goes first where there is one: a - b reads and computes better than -b + a.
        terms = sorted(node.as_ordered_terms(), key=lambda term: term.could_extract_minus_sign())
        text = self._term(terms[0])
        for term in terms[1:]:
            text += f" - {self._term(-term)}" if term.could_extract_minus_sign() else f" + {self._term(term)}"
        return text

    def _term(self, node: Expr) -> str:
        return self._factor(node) if isinstance(node, (sympy.Add, choice)) else self.expression(node)

    def _product(self, node: sympy.Mul) -> str:
        coefficient, rest = node.as_coeff_Mul()
        if coefficient == -1:
            return f"-{self._factor(rest)}"
        factors = [] if coefficient == 1 else [self.expression(coefficient)]
        return "*".join(factors + [self._factor(factor) for factor in rest.as_ordered_factors()])

    def _power(self, node: sympy.Pow) -> str:
        base, exponent = node.args
        if exponent == sympy.Rational(1, 2):
            return f"{self.functions['sqrt']}({self.expression(base)})"
        if exponent.is_Integer and 2 <= exponent <= LARGEST_PRODUCT:
            return "*".join([self._factor(base)] * int(exponent))
        return self._general_power(self.expression(base), self.expression(exponent))

    def _factor(self, node: Expr) -> str:
        text = self.expression(node)
        atomic = isinstance(node, (sympy.Symbol, sympy.Function))
        atomic = atomic and not isinstance(node, (reciprocal, choice))
        return text if atomic or node in (sympy.pi, sympy.E) or (node.is_Integer and node > 0) else f"({text})"

    @abstractmethod
    def _general_power(self, base: str, exponent: str) -> str:
        """Return a power that is not a small whole one."""

    @abstractmethod
    def _choice(self, test: str, first: str, second: str) -> str:
        """Return the first value where the test holds, else the second."""
