"""Read a formula written as text, against a whitelist: nothing but arithmetic is ever evaluated."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from ..errors import GridgenError

#: Functions that a density or a weight may call, by the name used in text.
FUNCTION_NAMES = ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan", "abs")
#: Bounds on what a text may hold: beyond them SymPy computes without end, or kernels overflow.
DEEPEST = 200
LARGEST = 1e300
LARGEST_EXPONENT = 64

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
        functions: the functions that may be called; those of `FUNCTION_NAMES` take one argument.
        number: makes a value from the text of a number.

    Raises:
        GridgenError: for a syntax error, `^` used for power, an unknown name or function, numbers, powers
            or a nesting beyond all use, or anything that is not arithmetic; the message quotes the
            offending part.
    """
    tree = _parsed(text, "formula", "Write it as Python arithmetic.")
    return _Reader(text, names, functions, number).read(tree, 0)[0]


def holds(condition: str, values: Mapping[str, float]) -> bool:
    """Return whether a comparison such as `"k_A + k_L + k_O == 1"` holds; equality up to round-off.

    Raises:
        GridgenError: if the condition is not one comparison of arithmetic in `values`.
    """
    hint = "Write one comparison of the parameters, for example 'k >= 0'."
    tree = _parsed(condition, "constraint", hint)
    if not (isinstance(tree, ast.Compare) and len(tree.ops) == 1 and type(tree.ops[0]) in _COMPARE):
        raise GridgenError(f"the constraint {condition!r} is not one comparison: write for example 'k >= 0'")
    reader = _Reader(condition, values, {}, float)
    try:
        left, right = (reader.read(side, 0)[0] for side in (tree.left, tree.comparators[0]))
        return _COMPARE[type(tree.ops[0])](left, right)
    except (ArithmeticError, TypeError) as error:  # A division by zero, or a root of a negative number.
        came = ", ".join(f"{name} = {value:g}" for name, value in values.items())
        raise GridgenError(f"the constraint {condition!r} has no value for {came}: {error}. {hint}") from None


def _parsed(text: str, kind: str, hint: str) -> ast.expr:
    """Return the tree of a text that is one Python expression."""
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        detail = error.msg if isinstance(error, SyntaxError) else str(error) or "it is nested too deeply"
        raise GridgenError(f"the {kind} {_short(text)} cannot be read: {detail}. {hint}") from None


@dataclass(frozen=True, slots=True)
class _Reader:
    """What a text is read with."""

    text: str
    names: Mapping[str, Any]
    functions: Mapping[str, Callable[..., Any]]
    number: Callable[[str], Any]

    def read(self, node: ast.AST, depth: int) -> tuple[Any, float]:
        """Return the value of a node, and the product of the nested exponents in it."""
        if depth > DEEPEST:
            raise GridgenError(
                f"the formula {_short(self.text)} nests more than {DEEPEST} operations (a sum of n terms nests n): "
                "shorten it"
            )
        value, degree = self._operation(node, depth + 1)
        if _size(value) > LARGEST:
            raise GridgenError(
                f"the formula {_short(self.text)} contains {_short(self._source(node))}, a number larger than "
                f"{LARGEST:g}: scale the formula"
            )
        return value, degree

    def _operation(self, node: ast.AST, depth: int) -> tuple[Any, float]:
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return self._literal(value, self._source(node)), 1
            case ast.Name(id=name):
                if name not in self.names:
                    raise _unknown(name, "name", self.names, self.text)
                return self.names[name], 1
            case ast.BinOp(op=ast.BitXor()):
                source = self._source(node)
                raise GridgenError(
                    f"the formula {_short(self.text)} uses '^' in {_short(source)}, which is not a power in Python: "
                    f"write {_short(source.replace('^', '**'))}"
                )
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                (one, first), (other, second) = self.read(left, depth), self.read(right, depth)
                degree = max(first, second)
                if isinstance(op, ast.Pow) and _is_number(other):
                    degree = first * _size(other)
                    if not max(degree, _size(other)) <= LARGEST_EXPONENT:
                        raise GridgenError(
                            f"the formula {_short(self.text)} contains {_short(self._source(node))}: exponents, and "
                            f"products of nested ones, may be at most {LARGEST_EXPONENT} in size; lower the power"
                        )
                return _BINARY[type(op)](one, other), degree
            case ast.UnaryOp(op=op, operand=operand) if type(op) in _UNARY:
                value, degree = self.read(operand, depth)
                return _UNARY[type(op)](value), degree
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                if name not in self.functions:
                    raise _unknown(name, "function", self.functions, self.text)
                if name in FUNCTION_NAMES and len(args) != 1:
                    raise GridgenError(
                        f"the formula {_short(self.text)} contains {_short(self._source(node))}: {name} takes exactly "
                        f"one argument, and {len(args)} came; write {name}(...) with one"
                    )
                read = [self.read(argument, depth) for argument in args]
                return self.functions[name](*(value for value, _ in read)), max((n for _, n in read), default=1)
        raise GridgenError(
            f"the formula {_short(self.text)} contains {_short(self._source(node))}, which is not arithmetic: "
            "use only numbers, names, + - * / ** and the functions " + ", ".join(sorted(self.functions))
        )

    def _literal(self, value: float, source: str) -> Any:  # noqa: ANN401
        """Return the value of a number; of a decimal one the text counts, not the nearest float."""
        vanished = value == 0 and any(digit in "123456789" for digit in source.lower().partition("e")[0])
        if vanished or abs(value) > LARGEST:
            raise GridgenError(
                f"the formula {_short(self.text)} contains the number {_short(source)}: numbers must be between "
                f"{1 / LARGEST:g} and {LARGEST:g} in size, or 0; scale the formula"
            )
        return self.number(str(value) if isinstance(value, int) else source.replace("_", ""))

    def _source(self, node: ast.AST) -> str:
        return ast.get_source_segment(self.text.strip(), node) or self.text


def _is_number(value: Any) -> bool:  # noqa: ANN401
    """Return whether a value is a number, of Python or of SymPy; arrays and symbols are not."""
    return isinstance(value, (int, float, complex)) or getattr(value, "is_number", False) is True


def _size(value: Any) -> float:  # noqa: ANN401
    """Return the absolute value of a number as a float, 0 for what is none."""
    if not _is_number(value):
        return 0.0
    try:
        return abs(complex(value))
    except OverflowError:
        return float("inf")
    except (TypeError, ValueError):  # SymPy's infinity in the plane: told where the value is used.
        return float("nan")


def _short(text: str) -> str:
    """Return the text as it would be typed, cut where it is too long to read."""
    return repr(text if len(text) <= 200 else f"{text[:200]}...")


def _unknown(name: str, kind: str, known: Mapping[str, Any], text: str) -> GridgenError:
    """Return the error for an unknown name, with the closest known one."""
    close = get_close_matches(name, known, n=1)
    hint = f" Did you mean {close[0]!r}?" if close else ""
    return GridgenError(
        f"unknown {kind} {name!r} in the formula {_short(text)}; known: {', '.join(sorted(known))}.{hint}"
    )
