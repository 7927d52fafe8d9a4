"""Find the part of a density that has no derivative at a corner, although its value is finite there.

Every part of the formula is evaluated together with its first and second derivative along one direction in the space
of edge vectors, by the chain rule, as the kernels do it: the root of something that vanishes gives 0/0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .metric import symbol

if TYPE_CHECKING:
    import sympy

#: Values beyond this may have derivatives that overflow, which does not concern the density.
_HUGE = 1e100


@dataclass(frozen=True, slots=True)
class Jet:
    """A value and its first and second derivative along a direction, arrays of one shape."""

    value: Array
    first: Array
    second: Array

    def __add__(self, other: Jet) -> Jet:
        """Return the sum."""
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __mul__(self, other: Jet) -> Jet:
        """Return the product."""
        return Jet(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * self.first * other.first + self.value * other.second,
        )

    def through(self, value: Array, slope: Array, bend: Array) -> Jet:
        """Return f of this, given f, f' and f'' at its value."""
        return Jet(value, slope * self.first, bend * self.first**2 + slope * self.second)


@dataclass(frozen=True, slots=True)
class Rough:
    """A part of a density without a derivative.

    Attributes:
        part: the smallest such part, a SymPy expression.
        order: 1 where the first derivative is not finite, 2 where only the second is not.
        corners: whether that is so, for each corner that was asked for.
    """

    part: sympy.Expr
    order: int
    corners: NDArray[np.bool_]


def rough_part(
    density: sympy.Expr, corners: Array, parameters: Mapping[str, float], weight: Array | float = 1.0
) -> Rough | None:
    """Return the first part of a density that has a value but no derivative at some of the corners.

    Args:
        density: in the symbols of the metric and the parameters.
        corners: edge vectors (x_xi, y_xi, x_eta, y_eta), shape (4, n).
        parameters: values of the parameters, and of what else the density names.
        weight: values of s, n of them or one for all.
    """
    import sympy

    names = dict(_metric_jets(corners)) | {name: _constant(value, corners) for name, value in parameters.items()}
    names["s"] = _constant(weight, corners)
    known: dict[Any, Jet] = {symbol(name): jet for name, jet in names.items()}
    with np.errstate(all="ignore"):
        for part in sympy.postorder_traversal(density):
            if part in known:
                continue
            known[part] = jet = _jet(part, known, corners)
            usable = np.abs(jet.value) < _HUGE
            for order, derivative in ((1, jet.first), (2, jet.second)):
                rough = usable & ~np.isfinite(derivative)
                if rough.any():
                    return Rough(part, order, rough)
    return None


def _metric_jets(corners: Array) -> Iterator[tuple[str, Jet]]:
    """Yield what a density may be written in, along one direction that no density was made for."""
    direction = np.broadcast_to(np.random.default_rng(5).normal(size=(4, 1)), corners.shape)
    zero = np.zeros(corners.shape[1])
    a, b, c, d = (Jet(value, slope, zero) for value, slope in zip(corners, direction, strict=True))
    yield from zip(("x_xi", "y_xi", "x_eta", "y_eta"), (a, b, c, d), strict=True)
    yield from (("g11", a * a + b * b), ("g22", c * c + d * d), ("g12", a * c + b * d))
    jacobian = a * d + _constant(-1.0, corners) * b * c
    yield from (("J", jacobian), ("tau", jacobian))
    yield from (("t11", a * a + b * b), ("t22", c * c + d * d), ("t12", a * c + b * d))


def _constant(value: Array | float, corners: Array) -> Jet:
    zero = np.zeros(corners.shape[1])
    return Jet(np.broadcast_to(np.asarray(value, dtype=float), zero.shape), zero, zero)


def _jet(part: sympy.Expr, known: Mapping[Any, Jet], corners: Array) -> Jet:
    """Return the jet of a part whose arguments are known."""
    import sympy

    if not part.args:
        return _constant(float(part), corners)
    arguments = [known[argument] for argument in part.args]
    if part.is_Add:
        return reduce(Jet.__add__, arguments)
    if part.is_Mul:
        return reduce(Jet.__mul__, arguments)
    if isinstance(part, sympy.Pow):
        return _power(*arguments, exponent=float(part.exp) if part.exp.is_number else None)
    (inner,) = arguments
    return inner.through(*(function(inner.value) for function in _derivatives(part.func)))


def _power(base: Jet, power: Jet, *, exponent: float | None) -> Jet:
    """Return base ** power; `exponent` is the power where that is a number."""
    if exponent is None:  # exp(power * log(base))
        logarithm = base.through(np.log(base.value), 1 / base.value, -1 / base.value**2)
        product = power * logarithm
        return product.through(*(np.exp(product.value),) * 3)
    p, u = exponent, base.value
    return base.through(u**p, p * u ** (p - 1), p * (p - 1) * u ** (p - 2))


@lru_cache(maxsize=32)
def _derivatives(function: Any) -> tuple[Callable[[Array], Array], ...]:  # noqa: ANN401 - a SymPy function
    """Return a function of one variable and its first two derivatives; those of abs() leave out its kink."""
    import sympy

    if function is sympy.Abs:
        return np.abs, np.sign, np.zeros_like
    z = sympy.Symbol("z", real=True)
    parts = [sympy.diff(function(z), z, order) for order in range(3)]
    return tuple(_broadcast(sympy.lambdify(z, part, "numpy")) for part in parts)


def _broadcast(function: Callable[[Array], Any]) -> Callable[[Array], Array]:
    """Return the function with results of the shape of its argument: constant derivatives are numbers."""
    return lambda values: np.broadcast_to(np.asarray(function(values), dtype=float), values.shape)
