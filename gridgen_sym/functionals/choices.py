"""Choices between two values by a comparison, as SymPy functions: `max`, `min` and `where` of a formula.

A derivative is that of the branch that holds, term by term: a branch that does not hold may be infinite, or have no
value at all, and contributes nothing. Where both sides of a comparison are equal, the derivative is that of one branch:
of `max` and `min`, of the argument that stands first; of `where`, of the branch that its condition names. Jumps at a
comparison have no impulses.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import reduce
from itertools import islice
from typing import Any

import sympy
from sympy import Expr

from ..errors import GridgenError, quoted
from .expression import CONDITION_HINT, Comparison

#: More ways than this to decide all comparisons of an expression are not looked at one by one.
_MOST_BRANCHES = 32


class choice(sympy.Function):  # type: ignore[misc] # noqa: N801 - a SymPy function is named in lower case
    """`choice(left, right, first, second)`: first where left < right, else second."""

    nargs = 4
    is_real = True

    @classmethod
    def eval(cls, left: Expr, right: Expr, first: Expr, second: Expr) -> Expr | None:
        """Return the branch that holds wherever the arguments have a value."""
        if first == second:
            return first
        below = _is_below(left, right)
        return None if below is None else first if below else second

    def as_choice(self) -> Expr:
        """Return the choice itself."""
        return self

    def _eval_derivative(self, variable: sympy.Symbol) -> Expr:
        left, right, first, second = self.args
        return choice(left, right, first.diff(variable), second.diff(variable))

    def _eval_evalf(self, precision: int) -> Expr | None:
        return _evaluated(self, precision)

    def _sympystr(self, printer: Any) -> str:  # noqa: ANN401 - printers of SymPy have no common type
        first, second = map(printer._print, self.args[2:])
        return f"where({self._test(printer)}, {first}, {second})"

    def _latex(self, printer: Any, exp: str | None = None) -> str:  # noqa: ANN401
        first, second = map(printer._print, self.args[2:])
        rows = rf"{first} & \text{{if }} {self._test(printer)} \\ {second} & \text{{otherwise}}"
        text = rf"\left(\begin{{cases}} {rows} \end{{cases}}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _test(self, printer: Any) -> str:  # noqa: ANN401
        """Return the comparison for readers: a number stands by itself on the right."""
        left, right = self.args[:2]
        if not (left.is_number or right.is_number):
            return f"{printer._print(left)} < {printer._print(right)}"
        number, rest = (left - right).as_coeff_Add()
        if rest.could_extract_minus_sign():
            return f"{printer._print(-rest)} > {printer._print(number)}"
        return f"{printer._print(rest)} < {printer._print(-number)}"

    def _pythoncode(self, printer: Any) -> str:  # noqa: ANN401
        # The real parts: numbers of mpmath and of checks may be complex. The other branch is not evaluated.
        left, right, first, second = map(printer._print, self.args)
        return f"(({first}) if ({left}).real < ({right}).real else ({second}))"

    _mpmathcode = _pythoncode

    def _numpycode(self, printer: Any) -> str:  # noqa: ANN401
        left, right, first, second = map(printer._print, self.args)
        return f"{printer._module_format('numpy.where')}(({left}) < ({right}), {first}, {second})"

    _scipycode = _numpycode


class _Extreme(sympy.Function):  # type: ignore[misc]
    """One of two values; subclasses say which."""

    nargs = 2
    is_real = True
    #: The name in formulas.
    word = ""

    def as_choice(self) -> Expr:
        """Return the same as a choice."""
        raise NotImplementedError

    def _eval_derivative(self, variable: sympy.Symbol) -> Expr:
        return self.as_choice().diff(variable)

    def _eval_evalf(self, precision: int) -> Expr | None:
        return _evaluated(self, precision)

    def _sympystr(self, printer: Any) -> str:  # noqa: ANN401
        return f"{self.word}({', '.join(map(printer._print, self._all()))})"

    def _latex(self, printer: Any, exp: str | None = None) -> str:  # noqa: ANN401
        power = "" if exp is None else f"^{{{exp}}}"
        return rf"\{self.word}{power}\left({', '.join(map(printer._print, self._all()))}\right)"

    def _all(self) -> tuple[Expr, ...]:
        """Return the arguments, those of a nested one of the same kind as well."""
        first, second = self.args
        return (*first._all(), second) if isinstance(first, type(self)) else (first, second)

    def _pythoncode(self, printer: Any) -> str:  # noqa: ANN401
        return str(printer._print(self.as_choice()))

    _mpmathcode = _numpycode = _scipycode = _pythoncode


class maximum(_Extreme):  # noqa: N801
    """The larger of two values; at a tie its derivative is that of the first."""

    word = "max"

    @classmethod
    def eval(cls, first: Expr, second: Expr) -> Expr | None:
        """Return the larger one where that is known."""
        below = _is_below(first, second)
        return None if below is None else second if below else first

    def as_choice(self) -> Expr:
        """Return the second where the first is below it, else the first."""
        first, second = self.args
        return choice(first, second, second, first)


class minimum(_Extreme):  # noqa: N801
    """The smaller of two values; at a tie its derivative is that of the first."""

    word = "min"

    @classmethod
    def eval(cls, first: Expr, second: Expr) -> Expr | None:
        """Return the smaller one where that is known."""
        below = _is_below(second, first)
        return None if below is None else second if below else first

    def as_choice(self) -> Expr:
        """Return the second where it is below the first, else the first."""
        first, second = self.args
        return choice(second, first, second, first)


CHOICES = (choice, maximum, minimum)


def _evaluated(part: Expr, precision: int) -> Expr | None:
    """Return a choice between numbers as a number, None where there are symbols or sides that are not real."""
    if not part.is_number:
        return None
    found = part.func(*(argument._evalf(precision) for argument in part.args))
    return None if isinstance(found, part.func) else found


def _is_below(left: Expr, right: Expr) -> bool | None:
    """Return whether left < right, or None where that depends on the symbols."""
    difference = left - right
    if difference.is_negative:
        return True
    return False if difference.is_nonnegative else None


def largest(first: Any, second: Any, /, *others: Any) -> Expr:  # noqa: ANN401 - symbols and numbers
    """Return the largest of some values; at a tie the derivative is that of the one that stands first."""
    return reduce(maximum, map(sympy.sympify, (first, second, *others)))


def smallest(first: Any, second: Any, /, *others: Any) -> Expr:  # noqa: ANN401
    """Return the smallest of some values; at a tie the derivative is that of the one that stands first."""
    return reduce(minimum, map(sympy.sympify, (first, second, *others)))


def where(condition: Any, first: Any, second: Any) -> Expr:  # noqa: ANN401
    """Return `first` where the condition holds, else `second`.

    Args:
        condition: one comparison by <, <=, > or >=: of SymPy, or as it was read from a text.
        first: value where it holds, at a tie for <= and >= too.
        second: value elsewhere.

    Raises:
        GridgenError: for another condition.
    """
    first, second = sympy.sympify(first), sympy.sympify(second)
    if condition in (sympy.true, sympy.false) and isinstance(condition, sympy.Basic):
        return first if condition == sympy.true else second
    if isinstance(condition, sympy.core.relational.Relational):
        condition = Comparison(condition.lhs, condition.rel_op, condition.rhs)
    if not isinstance(condition, Comparison) or condition.sign not in ("<", "<=", ">", ">="):
        raise GridgenError(f"where(condition, a, b) came with the condition {quoted(condition)}: {CONDITION_HINT}")
    left, right = sympy.sympify(condition.left), sympy.sympify(condition.right)
    if condition.sign in (">", "<="):
        left, right = right, left
    return choice(left, right, *((first, second) if condition.sign in ("<", ">") else (second, first)))


def with_choices(expression: Expr) -> Expr:
    """Return an expression with SymPy's `Max`, `Min` and `Piecewise` as choices, so that derivatives are of a branch.

    A `Piecewise` with another condition than one comparison, or without a last value for all else, stays as it is.
    """
    return (
        expression.replace(sympy.Max, lambda *values: largest(*values))
        .replace(sympy.Min, lambda *values: smallest(*values))
        .replace(sympy.Piecewise, lambda *pairs: _nested(sympy.Piecewise(*pairs)))
    )


def _nested(pieces: Expr) -> Expr:
    """Return a `Piecewise` as nested choices."""
    relations = (sympy.StrictLessThan, sympy.LessThan, sympy.StrictGreaterThan, sympy.GreaterThan)
    *conditional, (value, condition) = pieces.args if pieces.is_Piecewise else ((pieces, sympy.true),)
    if condition != sympy.true or not all(isinstance(test, relations) for _, test in conditional):
        return pieces
    for piece, test in reversed(conditional):
        value = where(test, piece, value)
    return value


def as_choices(expression: Any) -> Any:  # noqa: ANN401 - an expression, or a matrix of them
    """Return an expression with maxima and minima written as choices."""
    return expression.replace(lambda part: isinstance(part, _Extreme), lambda part: part.as_choice())


def decided_at(expression: Expr, values: Mapping[sympy.Symbol, Expr]) -> Expr:
    """Return an expression with every choice replaced by the branch that holds at values of all symbols."""

    def chosen(left: Expr, right: Expr, first: Expr, second: Expr) -> Expr:
        return first if _is_below(left.subs(values), right.subs(values)) else second

    return as_choices(expression).replace(choice, chosen)


def branches(expression: Any) -> list[Any] | None:  # noqa: ANN401
    """Return an expression, or a matrix, with all its comparisons decided, in every way; None where these are many."""
    found = list(islice(_branches(as_choices(expression)), _MOST_BRANCHES + 1))
    return found if len(found) <= _MOST_BRANCHES else None


def _branches(expression: Any) -> Iterator[Any]:  # noqa: ANN401
    """Yield the ways to decide the comparisons, those first that contain no other."""
    found = [part for part in expression.atoms(choice) if not any(side.has(choice) for side in part.args[:2])]
    if not found:
        yield expression
        return
    sides = min((part.args[:2] for part in found), key=sympy.default_sort_key)
    for below in (True, False):

        def decided(*arguments: Expr, below: bool = below) -> Expr:
            """Decide this comparison, and the turned one with it: ties are left out."""
            if arguments[:2] not in (sides, sides[::-1]):
                return choice(*arguments)
            return arguments[2] if below == (arguments[:2] == sides) else arguments[3]

        yield from _branches(expression.replace(choice, decided))
