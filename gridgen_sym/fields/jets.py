"""Exact derivatives by arithmetic: numbers that carry their first and second derivatives along x and y (jets).

The rules of differentiation applied operation by operation (forward differentiation, R. E. Wengert 1964): the same
program that evaluates a formula on arrays evaluates its derivatives on jets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

#: The second derivatives, and the two directions of each.
_PAIRS = {"xx": ("x", "x"), "xy": ("x", "y"), "yy": ("y", "y")}


@dataclass(frozen=True, slots=True, eq=False)
class Jet:
    """A value and its derivatives.

    Attributes:
        value: a number or an array.
        planes: the derivatives, under the keys `x`, `y`, `xx`, `xy` and `yy`; those that are zero are left out.
        order: of the derivatives that are carried, 1 or 2.
    """

    value: Any
    planes: dict[str, Any]
    order: int

    # Arrays leave the operation to the jet.
    __array_ufunc__ = None

    def __pos__(self) -> Jet:
        """Return the jet itself."""
        return self

    def __neg__(self) -> Jet:
        """Return minus the jet."""
        return Jet(-self.value, {key: -plane for key, plane in self.planes.items()}, self.order)

    def __add__(self, other: Any) -> Jet:  # noqa: ANN401 - a jet, a number or an array
        """Return the sum."""
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.planes, self.order)
        return Jet(self.value + other.value, _sum(self.planes, other.planes), self.order)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Jet:  # noqa: ANN401
        """Return the difference."""
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Jet:  # noqa: ANN401
        """Return the difference, the jet being what is subtracted."""
        return self.__neg__().__add__(other)

    def __mul__(self, other: Any) -> Jet:  # noqa: ANN401
        """Return the product."""
        if not isinstance(other, Jet):
            return Jet(self.value * other, {key: plane * other for key, plane in self.planes.items()}, self.order)
        planes = _sum(
            {key: plane * other.value for key, plane in self.planes.items()},
            {key: self.value * plane for key, plane in other.planes.items()},
        )
        return Jet(self.value * other.value, _sum(planes, self._mixed(other)), self.order)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:  # noqa: ANN401
        """Return the quotient."""
        if not isinstance(other, Jet):
            return Jet(self.value / other, {key: plane / other for key, plane in self.planes.items()}, self.order)
        return self.__mul__(other.__rtruediv__(1.0))

    def __rtruediv__(self, other: Any) -> Jet:  # noqa: ANN401
        """Return the quotient, the jet being the denominator."""
        quotient = other / self.value
        return _chain(self, quotient, -quotient / self.value, 2 * quotient / self.value**2)

    def __pow__(self, other: Any) -> Jet:  # noqa: ANN401
        """Return the power."""
        u = self.value
        if not isinstance(other, Jet):
            # A factor of zero stands for the whole term, also where its power is infinite.
            first = other * u ** (other - 1) if other else 0.0
            second = other * (other - 1) * u ** (other - 2) if other * (other - 1) else 0.0
            return _chain(self, u**other, first, second)
        power = u**other.value
        return _chain(other * applied("log", self), power, power, power)

    def __rpow__(self, other: Any) -> Jet:  # noqa: ANN401
        """Return the power, the jet being the exponent."""
        power = other**self.value
        return _chain(self * np.log(other), power, power, power)

    def _mixed(self, other: Jet) -> dict[str, Any]:
        """Return the products of the first derivatives that a product's second derivatives have."""
        if self.order < 2:
            return {}
        one, two = self.planes, other.planes
        found: dict[str, Any] = {}
        for key, (p, q) in _PAIRS.items():
            for first, second in ((p, q), (q, p)):
                if first in one and second in two:
                    found[key] = found.get(key, 0.0) + one[first] * two[second]
        return found


def variables(x: Any, y: Any, order: int) -> dict[str, Jet]:  # noqa: ANN401
    """Return x and y as jets of the given order."""
    return {"x": Jet(x, {"x": 1.0}, order), "y": Jet(y, {"y": 1.0}, order)}


def applied(name: str, argument: Any) -> Any:  # noqa: ANN401
    """Return a function of `FUNCTIONS` of a number, an array or a jet."""
    function, first, second = FUNCTIONS[name]
    if not isinstance(argument, Jet):
        return function(argument)
    u = argument.value
    value = function(u)
    return _chain(argument, value, first(u, value), second(u, value) if argument.order > 1 else 0.0)


def _chain(inner: Jet, value: Any, first: Any, second: Any) -> Jet:  # noqa: ANN401
    """Return the jet of a function of a jet, by its value and its first and second derivative there."""
    planes = {key: first * plane for key, plane in inner.planes.items()}
    if inner.order > 1:
        directions = inner.planes
        for key, (p, q) in _PAIRS.items():
            if p in directions and q in directions:
                planes[key] = planes.get(key, 0.0) + second * (directions[p] * directions[q])
    return Jet(value, planes, inner.order)


def _sum(one: dict[str, Any], other: dict[str, Any]) -> dict[str, Any]:
    """Return the sums of planes."""
    both = dict(one)
    for key, plane in other.items():
        both[key] = both[key] + plane if key in both else plane
    return both


_Derivative = Callable[[Any, Any], Any]

#: Each function of one argument, its first and its second derivative; these take the argument and the function's value.
#: At a kink the derivatives are those of abs(): its sign, zero at the kink, and zero. Those of sign() are zero.
FUNCTIONS: dict[str, tuple[Callable[[Any], Any], _Derivative, _Derivative]] = {
    "sqrt": (np.sqrt, lambda u, f: 0.5 / f, lambda u, f: -0.25 / (u * f)),
    "exp": (np.exp, lambda u, f: f, lambda u, f: f),
    "log": (np.log, lambda u, f: 1 / u, lambda u, f: -1 / u**2),
    "sin": (np.sin, lambda u, f: np.cos(u), lambda u, f: -f),
    "cos": (np.cos, lambda u, f: -np.sin(u), lambda u, f: -f),
    "tan": (np.tan, lambda u, f: 1 + f**2, lambda u, f: 2 * f * (1 + f**2)),
    "sinh": (np.sinh, lambda u, f: np.cosh(u), lambda u, f: f),
    "cosh": (np.cosh, lambda u, f: np.sinh(u), lambda u, f: f),
    "tanh": (np.tanh, lambda u, f: 1 - f**2, lambda u, f: -2 * f * (1 - f**2)),
    "asin": (np.arcsin, lambda u, f: 1 / np.sqrt(1 - u**2), lambda u, f: u / (1 - u**2) ** 1.5),
    "acos": (np.arccos, lambda u, f: -1 / np.sqrt(1 - u**2), lambda u, f: -u / (1 - u**2) ** 1.5),
    "atan": (np.arctan, lambda u, f: 1 / (1 + u**2), lambda u, f: -2 * u / (1 + u**2) ** 2),
    "abs": (np.abs, lambda u, f: np.sign(u), lambda u, f: 0.0),
    "sign": (np.sign, lambda u, f: 0.0, lambda u, f: 0.0),
}
