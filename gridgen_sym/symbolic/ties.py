"""Where a formula changes its branch: the ties of comparisons, and the zeros of arguments of abs() and sign()."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import sympy
from numpy.typing import NDArray
from sympy import Expr

from ..arrays import Array
from ..functionals.choices import CHOICES

_BISECTIONS = 60


def turning(expression: Expr) -> list[Expr]:
    """Return expressions at whose zeros the branch changes; an expression and its negative count once."""
    found = {part.args[0] for part in expression.atoms(sympy.Abs, sympy.sign)}
    compared = (part.as_choice().args for part in expression.atoms(*CHOICES))
    found |= {left - right for left, right, *_ in compared}
    return sorted({-part if part.could_extract_minus_sign() else part for part in found}, key=sympy.default_sort_key)


def zeros_between(value: Callable[[Array], Array], first: Array, last: Array) -> tuple[NDArray[np.bool_], Array, Array]:
    """Return on which lines a function changes its sign, and the fractions of the lines next to there on both sides.

    Args:
        value: the function of points (m, n), of which it returns n values.
        first: begins of the lines, (m, n).
        last: their ends.
    """
    low, high = np.zeros(first.shape[1]), np.ones(first.shape[1])
    sign = np.sign(value(first))
    crosses = sign * np.sign(value(last)) < 0
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        same = np.sign(value(first + middle * (last - first))) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return crosses, low, high
