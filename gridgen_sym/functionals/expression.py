"""Read a formula written as text, against a whitelist: nothing but arithmetic is ever evaluated."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from typing import Any

from ..errors import GridgenError

#: Functions that a density or a weight may call, by the name used in text.
FUNCTION_NAMES = ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan", "abs")

_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {ast.UAdd: operator.pos, ast.USub: operator.neg}
_COMPARE: dict[type[ast.cmpop], Callable[[float, float], bool]] = {
    ast.GtE: operator.ge,
    ast.Gt: operator.gt,
    ast.LtE: operator.le,
    ast.Lt: operator.lt,
    ast.Eq: lambda left, right: abs(left - right) <= 1e-12 * max(1.0, abs(left), abs(right)),
}


def evaluate(
    text: str,
    names: Mapping[str, Any],
    functions: Mapping[str, Callable[..., Any]],
    number: Callable[[str], Any] = float,
) -> Any:  # noqa: ANN401 - the value is whatever the names and functions work on: floats, arrays or SymPy
    """Return the value of the arithmetic expression `text`.

    Args:
        text: for example `"(g11 + g22)/J"`; operators + - * / **, parentheses, calls of `functions`.
        names: the value of every name that may stand in the text.
        functions: the functions that may be called.
        number: makes a value from the text of a number.

    Raises:
        GridgenError: for a syntax error, `^` used for power, an unknown name or function, or
            anything that is not arithmetic; the message quotes the offending part.
    """
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError) as error:
        detail = error.msg if isinstance(error, SyntaxError) else str(error)
        raise GridgenError(f"the formula {text!r} cannot be read: {detail}. Write it as Python arithmetic.") from None

    def value(node: ast.AST) -> Any:  # noqa: ANN401
        source = ast.get_source_segment(text.strip(), node) or text
        match node:
            case ast.Expression(body=body):
                return value(body)
            case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
                return number(source)
            case ast.Name(id=name):
                if name not in names:
                    raise _unknown(name, "name", names, text)
                return names[name]
            case ast.BinOp(op=ast.BitXor()):
                raise GridgenError(
                    f"the formula {text!r} uses '^' in {source!r}, which is not a power in Python: "
                    f"write {source.replace('^', '**')!r}"
                )
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return _BINARY[type(op)](value(left), value(right))
            case ast.UnaryOp(op=op, operand=operand) if type(op) in _UNARY:
                return _UNARY[type(op)](value(operand))
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                if name not in functions:
                    raise _unknown(name, "function", functions, text)
                return functions[name](*[value(argument) for argument in args])
        raise GridgenError(
            f"the formula {text!r} contains {source!r}, which is not arithmetic: "
            "use only numbers, names, + - * / ** and the functions " + ", ".join(sorted(functions))
        )

    return value(tree)


def holds(condition: str, values: Mapping[str, float]) -> bool:
    """Return whether a comparison such as `"k_A + k_L + k_O == 1"` holds; equality up to round-off."""
    tree = ast.parse(condition, mode="eval").body
    if not (isinstance(tree, ast.Compare) and len(tree.ops) == 1 and type(tree.ops[0]) in _COMPARE):
        raise GridgenError(f"the constraint {condition!r} is not one comparison: write for example 'k >= 0'")
    left, right = (evaluate(ast.unparse(side), values, {}) for side in (tree.left, tree.comparators[0]))
    return _COMPARE[type(tree.ops[0])](left, right)


def _unknown(name: str, kind: str, known: Mapping[str, Any], text: str) -> GridgenError:
    """Return the error for an unknown name, with the closest known one."""
    close = get_close_matches(name, known, n=1)
    hint = f" Did you mean {close[0]!r}?" if close else ""
    return GridgenError(f"unknown {kind} {name!r} in the formula {text!r}; known: {', '.join(sorted(known))}.{hint}")
