"""A description of a functional, as its author wrote it, in LaTeX."""

from __future__ import annotations

import re

from sympy import Symbol

from ...functionals.metric import DERIVATIVE_NAMES, LOGICAL_NAMES, METRIC_NAMES
from .latex import latex_sentence
from .printer import symbol_name

_NAME = rf"(?:{'|'.join([*METRIC_NAMES, *DERIVATIVE_NAMES, *LOGICAL_NAMES])})(?![A-Za-z0-9_])"
#: A formula within a sentence: names of the metric with the numbers and signs beside them.
_FORMULA = re.compile(rf"(?<![A-Za-z0-9_])[(\d]*{_NAME}(?: ?[-+*/=<>()\d²³]+| (?={_NAME})|{_NAME})*")
_SIGNS = {"**": "^", "²": "^2", "³": "^3", "*": r"\,"}


def sentence(text: str) -> str:
    """Return a description with the names of the metric as formulas, and with a period at its end."""
    parts, last = [], 0
    for match in _FORMULA.finditer(text):
        formula = _within_brackets(match[0])
        if formula.count("(") == formula.count(")"):
            parts += [latex_sentence(text[last : match.start()]), f"${_inline(formula)}$"]
            last = match.start() + len(formula)
    whole = "".join([*parts, latex_sentence(text[last:])]).strip()
    return whole if not whole or whole[-1] in ".!?" else f"{whole}."


def _within_brackets(formula: str) -> str:
    """Return a formula up to a bracket that closes what was opened before it, without a sign at its end."""
    depth = 0
    for k, character in enumerate(formula):
        depth += (character == "(") - (character == ")")
        if depth < 0:
            formula = formula[:k]
            break
    return formula.rstrip(" +-*/=<>(")


def _inline(formula: str) -> str:
    """Return a short formula, written as in the code, in LaTeX."""
    named = re.sub(_NAME, lambda match: symbol_name(Symbol(match[0])), formula)
    for sign, command in _SIGNS.items():
        named = named.replace(sign, command)
    return named
