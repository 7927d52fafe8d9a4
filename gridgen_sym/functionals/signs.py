"""Absolute values of what constraints keep from being negative: sqrt(c*c) with c > 0 is c."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from .expression import comparisons
from .metric import symbol

if TYPE_CHECKING:
    from sympy import Expr, Symbol


def without_known_signs(density: Expr, constraints: Iterable[str], names: Iterable[str]) -> Expr:
    """Return a density with the absolute values taken whose signs follow from constraints such as `c > 0`.

    Args:
        density: of a functional.
        constraints: of the functional.
        names: of parameters and components of fields, which constraints may contain.
    """
    import sympy

    absolute = density.atoms(sympy.Abs)
    if not absolute:
        return density
    symbols = {name: symbol(name) for name in names}
    known = {one: sympy.Dummy(str(one), nonnegative=True) for one in _nonnegative(constraints, symbols)}
    back = {stand_in: one for one, stand_in in known.items()}
    taken = {part: part.xreplace(known) for part in absolute}
    return density.xreplace({part: value.xreplace(back) for part, value in taken.items() if not value.has(sympy.Abs)})


def _nonnegative(constraints: Iterable[str], symbols: dict[str, Symbol]) -> Iterator[Symbol]:
    """Yield the symbols that a constraint keeps at or above a number that is not negative."""
    import sympy

    for constraint in constraints:
        for one in comparisons(constraint, symbols, sympy.Rational):
            high, low = (one.left, one.right) if one.sign in (">", ">=") else (one.right, one.left)
            if one.sign != "==" and isinstance(high, sympy.Symbol) and sympy.sympify(low).is_nonnegative:
                yield high
