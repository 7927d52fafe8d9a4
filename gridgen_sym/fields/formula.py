"""Formulas in x and y: read once, as text against a whitelist or from SymPy, and evaluated on arrays."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..functionals.expression import Comparison, evaluate
from .choices import angle, chosen, largest, smallest
from .jets import FUNCTIONS, Jet, applied, variables

_Values = Mapping[Any, Any]


def is_expression(source: object) -> TypeGuard[Any]:
    """Return whether a source is a SymPy expression; does not load SymPy."""
    return hasattr(source, "free_symbols") and hasattr(source, "subs")


class Formula:
    """A formula given as text, as a program: its values on arrays, and its exact derivatives on jets.

    SymPy is not loaded.
    """

    __slots__ = ("_result", "_steps", "text")

    def __init__(self, text: str, variables: tuple[str, str] = ("x", "y")) -> None:
        """Read the text, a formula in two variables.

        Raises:
            GridgenError: for text that is no formula in them; the message quotes the offending part.
        """
        self.text, self._steps = text, list[_Step]()
        terms = (_Term(name, self._steps) for name in "xy")
        names: dict[str, Any] = dict(zip(variables, terms, strict=True)) | {"pi": np.pi}
        try:
            with np.errstate(all="ignore"):
                self._result = evaluate(text, names, _FUNCTIONS)
        except ArithmeticError as error:
            raise GridgenError(f"the formula {quoted(text)} has no value: {error}. Correct its numbers") from error

    def values(self, x: Array, y: Array) -> npt.ArrayLike:
        """Return the values at points; a single number if the formula names neither x nor y."""
        return self._run({"x": x, "y": y})  # type: ignore[no-any-return]

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        """Return the derivatives along `x`, `y`, `xx`, `xy` or `yy`; the second one of a kink is zero."""
        found = self._run(variables(x, y, max(len(key) for key in along)))
        return [found.planes.get(key, 0.0) if isinstance(found, Jet) else 0.0 for key in along]

    def _run(self, values: _Values) -> Any:  # noqa: ANN401
        """Return the value of the formula; the steps are in order, and each uses up its arguments."""
        held: dict[str | int, Any] = {**values}

        def value(of: Any) -> Any:  # noqa: ANN401
            if not isinstance(of, _Term):
                return of
            return held[of.key] if isinstance(of.key, str) else held.pop(of.key)

        with np.errstate(all="ignore"):
            for number, (operate, arguments) in enumerate(self._steps):
                held[number] = operate(*map(value, arguments))
            return value(self._result)


_Step = tuple[Callable[..., Any], tuple[Any, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class _Term:
    """A name or the result of a step, while a formula is read: every operation on it becomes a step.

    Attributes:
        key: the name, or the number of the step.
        steps: the steps of the formula.
    """

    key: str | int
    steps: list[_Step]

    __array_ufunc__ = None

    def __pos__(self) -> _Term:
        return self

    def __neg__(self) -> _Term:
        return self._step(operator.neg, self)

    def __add__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.add, self, other)

    def __radd__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.add, other, self)

    def __sub__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.sub, self, other)

    def __rsub__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.sub, other, self)

    def __mul__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.mul, self, other)

    def __rmul__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.mul, other, self)

    def __truediv__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.truediv, self, other)

    def __rtruediv__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.truediv, other, self)

    def __pow__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.pow, self, other)

    def __rpow__(self, other: Any) -> _Term:  # noqa: ANN401
        return self._step(operator.pow, other, self)

    def _step(self, operate: Callable[..., Any], *arguments: Any) -> _Term:  # noqa: ANN401
        """Append a step; return its term."""
        self.steps.append((operate, arguments))
        return _Term(len(self.steps) - 1, self.steps)


def _called(call: Callable[..., Any], *arguments: Any) -> Any:  # noqa: ANN401
    """Return what a function gives while a formula is read: of a term a step, of numbers the value."""
    term = next((argument for argument in arguments if isinstance(argument, _Term)), None)
    return call(*arguments) if term is None else term._step(call, *arguments)


def _where(condition: Comparison, first: Any, second: Any) -> Any:  # noqa: ANN401
    return _called(partial(chosen, condition.sign), condition.left, condition.right, first, second)


_SEVERAL: Mapping[str, Callable[..., Any]] = {"atan2": angle, "max": largest, "min": smallest}
_FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    **{name: partial(_called, partial(applied, name)) for name in FUNCTIONS},
    **{name: partial(_called, call) for name, call in _SEVERAL.items()},
    "where": _where,
}


@dataclass(frozen=True, slots=True, eq=False)
class SymbolicFormula:
    """A formula given as a SymPy expression in x and y.

    Attributes:
        expression: what was given, with real symbols.
        variables: names of the two coordinates.
    """

    expression: Any
    variables: tuple[str, str] = ("x", "y")
    _compiled: dict[str, Callable[..., Any]] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        """Replace the user's x and y, whatever was assumed of them, by real ones.

        Raises:
            GridgenError: for an expression in other symbols.
        """
        given = self.expression
        unknown = sorted(str(one) for one in given.free_symbols if str(one) not in self.variables)
        if unknown:
            known = " and ".join(self.variables)
            raise GridgenError(f"the formula {given} contains {', '.join(unknown)}: use only the symbols {known}")
        from ..functionals.choices import with_choices
        from ..functionals.metric import symbol

        real = given.xreplace({one: symbol(str(one)) for one in given.free_symbols})
        object.__setattr__(self, "expression", with_choices(real))

    def values(self, x: Array, y: Array) -> npt.ArrayLike:
        """Return the values at points; a single number if the expression is one."""
        return self.derivatives(x, y, ("",))[0]

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        """Return the derivatives along `x`, `y`, `xx`, `xy` or `yy`; the second one of a kink is zero."""
        with np.errstate(all="ignore"):  # The branch that does not hold may have no value.
            return [self._along(key)(x, y) for key in along]

    def _along(self, key: str) -> Callable[..., Any]:
        """Return a derivative as a function of two arrays, compiled once."""
        if key not in self._compiled:
            import sympy

            from ..functionals.metric import symbol

            own = dict(zip("xy", map(symbol, self.variables), strict=True))
            found = sympy.diff(self.expression, *(own[name] for name in key)) if key else self.expression
            found = sympy.sympify(found).replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
            self._compiled[key] = sympy.lambdify(list(own.values()), found, "numpy")
        return self._compiled[key]
