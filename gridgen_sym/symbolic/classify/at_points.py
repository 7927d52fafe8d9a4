"""Expressions at points, to thirty digits: a claim about all jets is tried there, where algebra would take long."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise
from zlib import crc32

import sympy
from sympy import Expr, Symbol

from ..coordinates import DEFINITIONS, FIRST_DERIVATIVES

_DIGITS = 40
#: Numbers that agree to so many digits are equal.
_ROUND_OFF = sympy.Float("1e-24")
#: First derivatives with J > 0, in which no two numbers have a simple relation.
_JETS = (
    ("1.7320", "0.3319", "-0.4127", "1.2391"),
    ("0.8147", "-0.5923", "0.6691", "1.0859"),
    ("1.1273", "0.7741", "-0.9563", "1.5077"),
)


def varies(expressions: Iterable[Expr], variables: Iterable[Symbol]) -> bool:
    """Return whether an expression changes where some first derivatives change, at jets with J > 0.

    Args:
        expressions: in the symbols of `DEFINITIONS`, and others, which keep their values.
        variables: among `FIRST_DERIVATIVES`.
    """
    moving = {*variables}
    first = dict(zip(FIRST_DERIVATIVES, _JETS[0], strict=True))
    jets = [
        {p: dict(zip(FIRST_DERIVATIVES, jet, strict=True))[p] if p in moving else first[p] for p in FIRST_DERIVATIVES}
        for jet in _JETS
    ]
    return any(
        not _agree(one, other) for part in expressions for one, other in pairwise(_at(part, jet) for jet in jets)
    )


def vanishes(expression: Expr) -> bool:
    """Return whether an expression is zero at jets with J > 0."""
    values = (at_a_jet(expression, number) for number in range(len(_JETS)))
    return all(bool(value.is_finite) and bool(abs(value) < _ROUND_OFF) for value in values)


def at_a_jet(expression: Expr, number: int = 0) -> Expr:
    """Return the number that an expression is at one of the jets."""
    return _at(expression, dict(zip(FIRST_DERIVATIVES, _JETS[number], strict=True)))


def _at(expression: Expr, jet: Mapping[Symbol, str]) -> Expr:
    """Return the number that an expression is at a jet; every other symbol has a value of its own between 1/2 and 1."""
    values = {p: sympy.Float(text, _DIGITS) for p, text in jet.items()}
    if expression.free_symbols & DEFINITIONS.keys():
        for name, meaning in DEFINITIONS.items():
            values[name] = _number(meaning, values)
    return _number(expression, values)


def _number(expression: Expr, values: Mapping[Symbol, Expr]) -> Expr:
    others = {one: _value_of(one.name) for one in expression.free_symbols if one not in values}
    return sympy.N(expression.xreplace({**values, **others}), _DIGITS)


def _value_of(name: str) -> Expr:
    return sympy.Float(crc32(name.encode()) % 9973, _DIGITS) / 20000 + sympy.Rational(1, 2)


def _agree(one: Expr, other: Expr) -> bool:
    size = abs(one) + abs(other)
    return bool(size.is_finite) and bool(size == 0 or abs(one - other) <= _ROUND_OFF * size)
