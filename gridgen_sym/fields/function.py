"""Fields given as Python functions of two arrays: their values, and derivatives by differences."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array

#: Steps of central differences over the extent of the points: of a first derivative the cube root of the unit
#: round-off, of a second one its fourth root, where truncation and round-off are of one size.
_STEP, _STEP_SECOND = 6e-6, 1e-4


class Function:
    """A function of two arrays (x, y)."""

    __slots__ = ("function",)

    def __init__(self, function: Callable[[Array, Array], npt.ArrayLike]) -> None:
        """Hold the function."""
        self.function = function

    def values(self, x: Array, y: Array) -> npt.ArrayLike:
        """Return the values at points."""
        return self.function(x, y)

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        """Return the derivatives along `x`, `y`, `xx`, `xy` or `yy`, by differences."""
        return [difference(self.function, x, y, key) for key in along]


@dataclass(frozen=True, slots=True)
class Constant:
    """A number everywhere."""

    value: float

    def values(self, x: Array, y: Array) -> npt.ArrayLike:
        """Return the number."""
        return self.value

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        """Return zeros."""
        return [0.0 for _ in along]


def difference(function: Callable[[Array, Array], npt.ArrayLike], x: Array, y: Array, along: str) -> Array:
    """Return a derivative of a function by central differences.

    Args:
        function: of two arrays.
        x: the points.
        y: the same.
        along: `x`, `y`, `xx`, `xy` or `yy`.
    """

    def value(x: Array, y: Array) -> Array:
        return np.asarray(function(x, y), dtype=float)

    h = max(float(np.ptp(x)), float(np.ptp(y))) * (_STEP if len(along) == 1 else _STEP_SECOND)
    shift = {"x": (h, 0.0), "y": (0.0, h)}
    ax, ay = shift[along[0]]
    if len(along) == 1:
        return (value(x + ax, y + ay) - value(x - ax, y - ay)) / (2 * h)
    bx, by = shift[along[1]]
    return (
        value(x + ax + bx, y + ay + by)
        - value(x + ax - bx, y + ay - by)
        - value(x - ax + bx, y - ay + by)
        + value(x - ax - bx, y - ay - by)
    ) / (4 * h * h)


def takes_two_arrays(function: Callable[..., Any]) -> bool:
    """Return whether a function can be called with two arguments, as far as it shows."""
    inputs = getattr(function, "nin", None)  # NumPy's own functions have no signature.
    if inputs is not None:
        return bool(inputs == 2)
    try:
        inspect.signature(function).bind(None, None)
    except TypeError:
        return False
    except ValueError:  # Some functions of compiled modules have no signature.
        return True
    return True


def required_arguments(function: Callable[..., Any]) -> int:
    """Return how many arguments a function must be given by position, as far as it shows."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return int(getattr(function, "nin", 0))
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(one.kind in kinds and one.default is inspect.Parameter.empty for one in parameters)
