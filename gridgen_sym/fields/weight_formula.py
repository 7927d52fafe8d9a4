"""Weights given as formulas: text or SymPy expressions, and their exact derivatives, as functions of arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeGuard

import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError
from ..functionals.expression import evaluate

Compiled = Callable[[Array, Array], npt.ArrayLike]

_compiled: dict[tuple[Any, str], Compiled] = {}


def is_expression(source: object) -> TypeGuard[Any]:
    """Return whether a source is a SymPy expression; does not load SymPy."""
    return hasattr(source, "free_symbols") and hasattr(source, "subs")


def compiled_formula(formula: Any, along: str) -> Compiled:  # noqa: ANN401 - text or a SymPy expression
    """Return a formula's derivative as a function of two arrays; loads SymPy.

    Args:
        formula: text, or a SymPy expression in symbols named x and y.
        along: the variables to differentiate by, such as `""`, `"x"` or `"xy"`.

    Raises:
        GridgenError: for text that is no formula, or an expression in other symbols.
    """
    if (formula, along) not in _compiled:
        import sympy

        from ..functionals.metric import symbol, sympy_functions

        variables = {name: symbol(name) for name in "xy"}
        if isinstance(formula, str):
            expression = evaluate(formula, variables | {"pi": sympy.pi}, sympy_functions(), sympy.Rational)
        else:
            expression = _in_our_symbols(formula, variables)
        derivative = sympy.diff(expression, *(variables[name] for name in along)) if along else expression
        # Second derivatives of abs() are zero but on a line that no node need meet.
        derivative = sympy.sympify(derivative).replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
        _compiled[formula, along] = sympy.lambdify(list(variables.values()), derivative, "numpy")
    return _compiled[formula, along]


def _in_our_symbols(formula: Any, variables: dict[str, Any]) -> Any:  # noqa: ANN401
    """Return the expression with the user's x and y, whatever was assumed of them, as ours."""
    unknown = sorted(str(one) for one in formula.free_symbols if str(one) not in variables)
    if unknown:
        raise GridgenError(f"the weight {formula} contains {', '.join(unknown)}: use only the symbols x and y")
    return formula.xreplace({one: variables[str(one)] for one in formula.free_symbols})
