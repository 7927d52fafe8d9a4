"""The determinant of a principal symbol in a frame, factored: as polynomials, with one symbol for each denominator.

To cancel the entries first takes minutes where the density is not symmetric, for the greatest common divisors of
polynomials in many symbols. Denominators are few, such as J: their common powers are divided out at the end.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from operator import add
from typing import Any

import sympy
from sympy import Expr, Symbol
from sympy.polys.rings import PolyRing

from ..coordinates import METRIC

#: More terms than this, and polynomials are not multiplied out, or one is not factored: that would take seconds.
_MOST_TERMS, _MOST_FACTORED = 300_000, 800


class _TooLongError(Exception):
    """A product has too many terms to be multiplied out."""


def frame_determinant(matrix: sympy.Matrix, frame: Mapping[Symbol, Expr]) -> Expr | None:
    """Return the determinant of a symmetric matrix in a frame, as a product of factors; None if it is too long.

    Args:
        matrix: 2 x 2, of quotients of polynomials.
        frame: what the first derivatives of the map are, in other symbols.
    """
    meanings = {name: meaning.xreplace(dict(frame)) for name, meaning in METRIC.items()}
    entries = [matrix[place].xreplace({**meanings, **frame}) for place in ((0, 0), (0, 1), (1, 1))]
    if any(_denominators([base]) for base in _denominators(entries)):
        entries = [sympy.together(entry) for entry in entries]
    bases = sorted(_denominators(entries), key=sympy.default_sort_key)
    inverses = {base: sympy.Dummy(f"inverse{k}") for k, base in enumerate(bases)}
    symbols = set().union(*(entry.free_symbols for entry in entries))
    ring = PolyRing([*sorted(symbols, key=sympy.default_sort_key), *inverses.values()], sympy.QQ)
    known: dict[Expr, Any] = {}
    try:
        first, mixed, second = (_element(entry, ring, inverses, known) for entry in entries)
        denominators = [_element(base, ring, inverses, known) for base in bases]
        determinant = _product(first, second) - _product(mixed, mixed)
        above, powers = _over_common_denominator(determinant, denominators, len(symbols))
    except _TooLongError:
        return None
    if len(above) > _MOST_FACTORED:
        return None
    below = sympy.prod(base**power for base, power in zip(bases, powers, strict=True))
    return sympy.factor(above.as_expr()) / sympy.factor(below)


def _denominators(expressions: Iterable[Expr]) -> set[Expr]:
    """Return the bases of all negative powers."""
    powers = (power for expression in expressions for power in expression.atoms(sympy.Pow))
    return {power.base for power in powers if power.exp.is_Integer and power.exp < 0}


def _element(expression: Expr, ring: PolyRing, inverses: Mapping[Expr, Symbol], known: dict[Expr, Any]) -> Any:  # noqa: ANN401
    """Return an expression as a polynomial, with symbols for the inverses of denominators."""
    if expression in known:
        return known[expression]
    parts = (_element(part, ring, inverses, known) for part in expression.args)
    if expression.is_Rational:
        result = ring(sympy.QQ(expression.p, expression.q))
    elif expression.is_Add:
        result = reduce(add, parts)
    elif expression.is_Mul:
        result = reduce(_product, parts)
    elif expression.is_Pow and expression.exp < 0:
        result = ring(inverses[expression.base]) ** int(-expression.exp)
    elif expression.is_Pow:
        result = reduce(_product, [_element(expression.base, ring, inverses, known)] * int(expression.exp))
    else:
        result = ring(expression)
    known[expression] = result
    return result


def _product(one: Any, other: Any) -> Any:  # noqa: ANN401
    if len(one) * len(other) > _MOST_TERMS:
        raise _TooLongError
    return one * other


def _over_common_denominator(polynomial: Any, denominators: list[Any], first: int) -> tuple[Any, list[int]]:  # noqa: ANN401
    """Return a numerator, and the powers of the denominators below it; inverses are the symbols from number `first`."""
    powers = [max((monomial[first + k] for monomial in polynomial), default=0) for k in range(len(denominators))]
    by_inverses: dict[tuple[int, ...], Any] = {}
    for monomial, coefficient in polynomial.items():
        inverses = monomial[first:]
        part = by_inverses.setdefault(inverses, polynomial.ring(0))
        part[(*monomial[:first], *(0 for _ in inverses))] = coefficient
    above = polynomial.ring(0)
    for inverses, part in by_inverses.items():
        for denominator, power, there in zip(denominators, powers, inverses, strict=True):
            part = reduce(_product, [denominator] * (power - there), part)
        above += part
    for k, denominator in enumerate(denominators):
        while powers[k] and above:
            quotient, rest = divmod(above, denominator)
            if rest:
                break
            above, powers[k] = quotient, powers[k] - 1
    return above, powers if above else [0 for _ in powers]
