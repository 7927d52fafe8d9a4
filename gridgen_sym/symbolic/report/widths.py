"""The width of a formula as LaTeX sets it, estimated from its text: enough to break lines by."""

from __future__ import annotations

import re
from collections.abc import Iterator

#: The width of the text in the class `article`, less the number of an equation, in points of a font of 10 points.
LINE = 300.0
_TOKEN = re.compile(r"\\[a-zA-Z]+\*?|\\.|[{}^_&]|\s+|.", re.DOTALL)
_SCRIPT = 0.7
_LETTER, _DIGIT, _BRACKET, _SIGN, _RELATION = 5.6, 5.0, 4.4, 12.3, 13.4
_WIDTHS = {"+": _SIGN, "-": _SIGN, "=": _RELATION, "<": _RELATION, ">": _RELATION, ",": 4.5, "/": 5.0, "|": 3.0}
_WIDTHS |= dict.fromkeys("()[]", _BRACKET) | {"&": 10.0}
_COMMANDS = {r"\left": 2.0, r"\right": 2.0, r"\,": 1.7, r"\!": -1.7, r"\;": 2.8, r"\quad": 10.0, r"\qquad": 20.0}
_COMMANDS |= {r"\ge": _RELATION, r"\le": _RELATION, r"\neq": _RELATION, r"\\": 0.0, r"\cdot": 7.2, r"\sqrt": 9.0}
_COMMANDS |= dict.fromkeys((r"\Bigl", r"\Bigr"), 2.5) | dict.fromkeys((r"\bigl", r"\bigr"), 1.0)
#: Commands whose arguments are text, or that change nothing of the width.
_PLAIN = (r"\mathrm", r"\operatorname", r"\text", r"\mathbf", r"\mathit", r"\begin", r"\end", r"\label", r"\limits")


def width(latex: str) -> float:
    """Return about how wide a formula is, in points of a font of 10 points."""
    return _group(iter(_TOKEN.findall(latex)))


def _group(tokens: Iterator[str]) -> float:
    """Return the width up to the closing brace of a group, or to the end."""
    total, above, below = 0.0, 0.0, 0.0
    for token in tokens:
        if token == "}":
            break
        if token == "^":
            above = _SCRIPT * _argument(tokens)
        elif token == "_":
            below = _SCRIPT * _argument(tokens)
        else:
            total += max(above, below)
            above = below = 0.0
            total += _token(token, tokens)
    return total + max(above, below)


def _token(token: str, tokens: Iterator[str]) -> float:
    if token == "{":
        return _group(tokens)
    if token == r"\frac":
        return max(_argument(tokens), _argument(tokens)) + 2.4
    if token in (r"\begin", r"\end", r"\label"):
        _argument(tokens)
        return 3.0
    if token.startswith("\\"):
        return 0.0 if token in _PLAIN else _COMMANDS.get(token, _letters(token))
    if token.isspace():
        return 0.0
    return _WIDTHS.get(token, _DIGIT if token.isdigit() else _LETTER)


def _letters(command: str) -> float:
    r"""Return the width of a command: a Greek letter, or the name of a function such as \cosh."""
    upright = command[1:] in ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "min", "max", "det")
    return 5.2 * len(command[1:]) if upright else 5.6


def _argument(tokens: Iterator[str]) -> float:
    """Return the width of the next group or token."""
    for token in tokens:
        if not token.isspace():
            return _token(token, tokens)
    return 0.0
