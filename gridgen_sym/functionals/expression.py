"""Read a formula written as text, against a whitelist: nothing but arithmetic is ever evaluated."""

from __future__ import annotations

import ast
import keyword
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any

from ..errors import GridgenError, quoted

#: Functions of one argument that a density or a weight may call, by the name used in text.
FUNCTIONS_OF_ONE = (
    *("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh"),
    *("asin", "acos", "atan", "abs", "sign"),
)
#: The least and the greatest number of arguments of the other functions.
_COUNTS: dict[str, tuple[int, int]] = {"atan2": (2, 2), "max": (2, 100), "min": (2, 100), "where": (3, 3)}
#: All functions that a density or a weight may call.
FUNCTION_NAMES = (*FUNCTIONS_OF_ONE, *_COUNTS)
#: What these take, and a call of each.
_ARGUMENTS = {
    "atan2": ("two arguments", "atan2(y, x)"),
    "max": ("two arguments or more", "max(a, b)"),
    "min": ("two arguments or more", "min(a, b)"),
    "where": ("a comparison and two values", "where(a < b, p, q)"),
}
CONDITION_HINT = (
    "it must be one comparison of two values by <, <=, > or >=, as in where(a < b, p, q). Instead of a chain or of "
    "'and', nest: where(a < b, where(b < c, p, q), q); instead of ==, give a tolerance: where(abs(a - b) < 1e-9, p, q)"
)
#: Bounds on what a text may hold: beyond them SymPy computes forever, or kernels overflow.
LONGEST = 20_000
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
_SIGNS: dict[type[ast.cmpop], str] = {ast.GtE: ">=", ast.Gt: ">", ast.LtE: "<=", ast.Lt: "<", ast.Eq: "=="}
_COMPARE: dict[str, Callable[[float, float], bool]] = {
    ">=": operator.ge,
    ">": operator.gt,
    "<=": operator.le,
    "<": operator.lt,
    "==": lambda left, right: abs(left - right) <= 1e-12 * max(1.0, abs(left), abs(right)),
}
_COMPARISON_HINT = "Write a comparison of the parameters, for example 'k >= 0'."
_WORD = re.compile(r"[A-Za-z_]\w*")
_LINE_END = re.compile(rb"\r\n|\r|\n")


@dataclass(frozen=True, slots=True)
class Comparison:
    """A comparison of two values: `left` stands before the sign `sign`, one of `>=`, `>`, `<=`, `<` and `==`."""

    left: Any
    sign: str
    right: Any


def evaluate(
    text: str,
    names: Mapping[str, Any],
    functions: Mapping[str, Callable[..., Any]],
    number: Callable[[str], Any] = float,
) -> Any:  # noqa: ANN401 - the value is whatever the names and functions work on: floats, arrays or SymPy
    """Return the value of the arithmetic expression `text`, in time linear in its length.

    Args:
        text: for example `"(g11 + g22)/J"`; operators + - * / **, parentheses, calls of `functions`.
        names: the value of every name that may be in the text.
        functions: the functions that may be called; `where` is given its condition as a `Comparison`.
        number: makes a value from the text of a number.

    Raises:
        GridgenError: for a syntax error, `^` used for power, an unknown name or function, numbers, powers, a
            length or a nesting beyond all use, or anything that is not arithmetic; the message quotes the
            offending part.
    """
    tree = _parsed(text, "formula", "Write it as Python arithmetic.")
    return _Reader(text.strip(), names, functions, number).read(tree, 0)[0]


def holds(condition: str, values: Mapping[str, float]) -> bool:
    """Return whether a condition such as `"0 < k < 1"` holds; equality up to round-off.

    Raises:
        GridgenError: if the condition is not a comparison of arithmetic in `values`, or has no value there.
    """
    try:
        return all(_COMPARE[one.sign](one.left, one.right) for one in comparisons(condition, values))
    except (ArithmeticError, TypeError) as error:  # A division by zero, or a root of a negative number.
        came = ", ".join(f"{name} = {value:g}" for name, value in values.items())
        raise GridgenError(
            f"the constraint {quoted(condition)} has no value for {came}: {error}. {_COMPARISON_HINT}"
        ) from None


def comparisons(
    condition: str, names: Mapping[str, Any], number: Callable[[str], Any] = float
) -> tuple[Comparison, ...]:
    """Return the comparisons of a condition: one of `"k_A + k_L + k_O == 1"`, two of `"0 < k < 1"`.

    Args:
        condition: values compared by >=, >, <=, < or ==.
        names: the value of every name that may be in the condition: floats, arrays or SymPy symbols.
        number: makes a value from the text of a number.

    Raises:
        GridgenError: if the condition is no comparison of arithmetic.
    """
    tree = _parsed(condition, "constraint", _COMPARISON_HINT)
    if not (isinstance(tree, ast.Compare) and all(type(op) in _SIGNS for op in tree.ops)):
        raise GridgenError(f"the constraint {quoted(condition)} is not a comparison: write for example 'k >= 0'")
    reader = _Reader(condition.strip(), names, {}, number)
    sides = [reader.read(side, 0)[0] for side in (tree.left, *tree.comparators)]
    return tuple(
        Comparison(left, _SIGNS[type(op)], right) for left, op, right in zip(sides, tree.ops, sides[1:], strict=False)
    )


def names_in(text: str) -> set[str]:
    """Return the words of a text: the names and functions that it may contain."""
    return set(_WORD.findall(text))


def name_instead_of(word: str) -> str:
    """Return a usable name in the place of a word of Python; the usual letter of a multiplier is one."""
    return "lambda_ or lam" if word == "lambda" else f"{word.lower()}_"


def _parsed(text: str, kind: str, hint: str) -> ast.expr:
    """Return the tree of a text that is one Python expression."""
    if len(text) > LONGEST:
        raise GridgenError(f"the {kind} {quoted(text)} is too long: it may have {LONGEST} characters; shorten it")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        detail = error.msg if isinstance(error, SyntaxError) else str(error) or "it is nested too deeply"
        words = [word for word in _WORD.findall(text) if keyword.iskeyword(word)]
        if words:
            detail = f"{words[0]!r} is a word of Python and cannot be a name; write {name_instead_of(words[0])}"
        raise GridgenError(f"the {kind} {quoted(text)} cannot be read: {detail}. {hint}") from None


@dataclass(frozen=True, slots=True)
class _Reader:
    """What a text, without spaces around it, is read with."""

    text: str
    names: Mapping[str, Any]
    functions: Mapping[str, Callable[..., Any]]
    number: Callable[[str], Any]
    lines: list[bytes] = field(init=False)

    def __post_init__(self) -> None:
        """Split the text into lines once: the places of nodes are given in bytes of a line."""
        object.__setattr__(self, "lines", _LINE_END.split(self.text.encode()))

    def read(self, node: ast.AST, depth: int) -> tuple[Any, float]:
        """Return the value of a node, and the product of the nested exponents in it."""
        if depth > DEEPEST:
            raise GridgenError(
                f"the formula {quoted(self.text)} nests more than {DEEPEST} operations (a sum of n terms nests n): "
                "shorten it"
            )
        value, degree = self._operation(node, depth + 1)
        if _size(value) > LARGEST:
            raise GridgenError(
                f"the formula {quoted(self.text)} contains {quoted(self._source(node))}, a number larger than "
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
                    f"the formula {quoted(self.text)} uses '^' in {quoted(source)}, which is not a power in Python: "
                    f"write {quoted(source.replace('^', '**'))}"
                )
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                (one, first), (other, second) = self.read(left, depth), self.read(right, depth)
                degree = max(first, second)
                if isinstance(op, ast.Pow) and _is_number(other):
                    degree = first * _size(other)
                    if not max(degree, _size(other)) <= LARGEST_EXPONENT:
                        raise GridgenError(
                            f"the formula {quoted(self.text)} contains {quoted(self._source(node))}: exponents, and "
                            f"products of nested ones, may be at most {LARGEST_EXPONENT} in size; lower the power"
                        )
                return _BINARY[type(op)](one, other), degree
            case ast.UnaryOp(op=op, operand=operand) if type(op) in _UNARY:
                value, degree = self.read(operand, depth)
                return _UNARY[type(op)](value), degree
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                if name not in self.functions:
                    raise _unknown(name, "function", self.functions, self.text)
                self._check_count(node, name, len(args))
                readers = [self._condition if name == "where" and k == 0 else self.read for k in range(len(args))]
                read = [reader(argument, depth) for reader, argument in zip(readers, args, strict=True)]
                return self.functions[name](*(value for value, _ in read)), max((n for _, n in read), default=1)
            case ast.Compare():
                raise GridgenError(
                    f"the formula {quoted(self.text)} contains the comparison {quoted(self._source(node))}: a "
                    "comparison is no value; write where(condition, p, q), as in where(a < b, p, q)"
                )
        raise GridgenError(
            f"the formula {quoted(self.text)} contains {quoted(self._source(node))}, which is not arithmetic: "
            "use only numbers, names, + - * / ** and the functions " + ", ".join(sorted(self.functions))
        )

    def _check_count(self, node: ast.AST, name: str, count: int) -> None:
        """Refuse a call of a function of formulas with too few arguments or too many."""
        least, most = _COUNTS.get(name, (1, 1))
        if name in FUNCTION_NAMES and not least <= count <= most:
            expected, example = _ARGUMENTS.get(name, ("exactly one argument", f"{name}(...) with one"))
            raise GridgenError(
                f"the formula {quoted(self.text)} contains {quoted(self._source(node))}: {name} takes {expected}, "
                f"and {count} came; write {example}"
            )

    def _condition(self, node: ast.AST, depth: int) -> tuple[Comparison, float]:
        """Return the condition of `where`, and the larger degree of its sides."""
        match node:
            case ast.Compare(left=left, ops=[op], comparators=[right]) if _SIGNS.get(type(op), "==") != "==":
                (one, first), (other, second) = self.read(left, depth), self.read(right, depth)
                return Comparison(one, _SIGNS[type(op)], other), max(first, second)
        raise GridgenError(
            f"the formula {quoted(self.text)} contains where(...) with the condition {quoted(self._source(node))}: "
            f"{CONDITION_HINT}"
        )

    def _literal(self, value: float, source: str) -> Any:  # noqa: ANN401
        """Return the value of a number; of a decimal one the text counts, not the nearest float."""
        vanished = value == 0 and any(digit in "123456789" for digit in source.lower().partition("e")[0])
        if vanished or abs(value) > LARGEST:
            raise GridgenError(
                f"the formula {quoted(self.text)} contains the number {quoted(source)}: numbers must be between "
                f"{1 / LARGEST:g} and {LARGEST:g} in size, or 0; scale the formula"
            )
        return self.number(str(value) if isinstance(value, int) else source.replace("_", ""))

    def _source(self, node: ast.AST) -> str:
        """Return the text of a node; `ast.get_source_segment` would split the whole text for each."""
        assert isinstance(node, ast.expr)
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        lines = self.lines[first : last + 1]
        lines[-1] = lines[-1][: node.end_col_offset]
        lines[0] = lines[0][node.col_offset :]
        return b" ".join(lines).decode()


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
    except (TypeError, ValueError):  # SymPy's infinity in the plane: reported where the value is used.
        return float("nan")


def _unknown(name: str, kind: str, known: Mapping[str, Any], text: str) -> GridgenError:
    """Return the error for an unknown name, with the closest known one."""
    close = get_close_matches(name, known, n=1)
    hint = f" Did you mean {close[0]!r}?" if close else ""
    return GridgenError(
        f"unknown {kind} {quoted(name)} in the formula {quoted(text)}; known: {', '.join(sorted(known))}.{hint}"
    )
