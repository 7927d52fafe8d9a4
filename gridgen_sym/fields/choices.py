"""The functions of several arguments in a formula, of numbers, arrays and jets: max, min, where, atan2.

A choice is made point by point, and its derivatives are those of the branch that holds there: at a tie that of the
argument of max() and min() that stands first, and of where() the branch that its condition names.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np

from .jets import Jet, applied

_COMPARE: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}


def largest(*arguments: Any) -> Any:  # noqa: ANN401 - numbers, arrays or jets
    """Return the largest of the arguments."""
    return reduce(lambda one, other: chosen("<", one, other, other, one), arguments)


def smallest(*arguments: Any) -> Any:  # noqa: ANN401
    """Return the smallest of the arguments."""
    return reduce(lambda one, other: chosen("<", other, one, other, one), arguments)


def chosen(sign: str, left: Any, right: Any, first: Any, second: Any) -> Any:  # noqa: ANN401
    """Return `first` where the comparison of left and right holds, else `second`."""
    holds = _COMPARE[sign](_value(left), _value(right))
    if isinstance(holds, (bool, np.bool_)):
        return first if holds else second
    if not isinstance(first, Jet) and not isinstance(second, Jet):
        return np.where(holds, first, second)
    both = [one for one in (first, second) if isinstance(one, Jet)]
    keys = dict.fromkeys(key for one in both for key in one.planes)
    planes = {key: np.where(holds, _plane(first, key), _plane(second, key)) for key in keys}
    return Jet(np.where(holds, _value(first), _value(second)), planes, both[0].order)


def angle(y: Any, x: Any) -> Any:  # noqa: ANN401
    """Return atan2(y, x)."""
    at_y, at_x = _value(y), _value(x)
    value = np.arctan2(at_y, at_x)
    if not isinstance(y, Jet) and not isinstance(x, Jet):
        return value
    # The angle is that of the point itself, plus the angle from there, which is atan of a quotient.
    return value + applied("atan", (y * at_x - x * at_y) / (x * at_x + y * at_y))


def _value(of: Any) -> Any:  # noqa: ANN401
    return of.value if isinstance(of, Jet) else of


def _plane(of: Any, key: str) -> Any:  # noqa: ANN401
    return of.planes.get(key, 0.0) if isinstance(of, Jet) else 0.0
