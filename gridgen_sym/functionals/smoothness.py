"""Find the part of a density that has no derivative at a corner, although its value is finite there.

Every part of the formula is evaluated together with its first and second derivative along one direction in the space
of edge vectors, by the chain rule, as the kernels do it: the root of something that vanishes gives 0/0. Of a choice
the branch that holds is looked at, and no other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .metric import DERIVATIVE_NAMES, METRIC_NAMES, TARGET_NAMES, symbol

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

    def where(self, holds: NDArray[np.bool_], other: Jet) -> Jet:
        """Return this one where a condition holds, and another elsewhere."""
        pairs = ((self.value, other.value), (self.first, other.first), (self.second, other.second))
        return Jet(*(np.where(holds, one, two) for one, two in pairs))

    def rough(self, order: int) -> NDArray[np.bool_]:
        """Return where the value is of a usable size, and the derivative of this order is not finite.

        Of order 0, where the value is not.
        """
        if order == 0:
            return ~np.isfinite(self.value)
        derivative = self.first if order == 1 else self.second
        return (np.abs(self.value) < _HUGE) & ~np.isfinite(derivative)

    def through(self, value: Array, slope: Array, bend: Array) -> Jet:
        """Return f of this, given f, f' and f'' at its value."""
        return Jet(value, slope * self.first, bend * self.first**2 + slope * self.second)


@dataclass(frozen=True, slots=True)
class Rough:
    """A part of a density without a derivative.

    Attributes:
        part: the smallest such part, a SymPy expression.
        order: 0 where the value is not finite, 1 where the first derivative is not, 2 where only the second is not.
        corners: whether that is so, for each corner that was asked for.
    """

    part: sympy.Expr
    order: int
    corners: NDArray[np.bool_]


def rough_part(
    density: sympy.Expr,
    corners: Array,
    parameters: Mapping[str, Array | float],
    weight: Array | float = 1.0,
    relative: Array | None = None,
    *,
    least: int = 1,
) -> Rough | None:
    """Return the first part of a density that has a value but no derivative at some of the corners.

    Args:
        density: in the symbols of the metric and the parameters.
        corners: edge vectors (x_xi, y_xi, x_eta, y_eta), shape (4, n).
        parameters: values of the parameters, and of what else the density names.
        weight: values of s, n of them or one for all.
        relative: (4, n), the columns of T = A W⁻¹ where there is a target: a density that does not name the metric of
            T is of them instead.
        least: 0 to look for the first part without a value first.
    """
    import sympy

    to_target = corners if relative is None else relative
    if not {value.name for value in density.free_symbols} & {*TARGET_NAMES}:
        corners = to_target
    names = _metric_jets(corners, to_target) | {name: _constant(value, corners) for name, value in parameters.items()}
    names["s"] = _constant(weight, corners)
    known: dict[Any, Jet] = {symbol(name): jet for name, jet in names.items()}
    with np.errstate(all="ignore"):
        for part in sympy.postorder_traversal(density):
            if part not in known:
                known[part] = _jet(part, known, corners)
    for order in range(least, 3):
        rough = known[density].rough(order)
        if rough.any():
            return _smallest(density, order, rough, known)
    return None


def _smallest(part: sympy.Expr, order: int, rough: NDArray[np.bool_], known: Mapping[Any, Jet]) -> Rough:
    """Return the smallest part of a part that has no derivative at some corners, among the branches that hold there."""
    for argument, holds in _used(part, known):
        inner = rough & holds & known[argument].rough(order)
        if inner.any():
            return _smallest(argument, order, inner, known)
    return Rough(part, order, rough)


def _used(part: sympy.Expr, known: Mapping[Any, Jet]) -> Iterator[tuple[sympy.Expr, Any]]:
    """Yield the arguments whose derivatives those of a part are made of, and at which corners."""
    from .choices import CHOICES

    if not isinstance(part, CHOICES):
        yield from ((argument, True) for argument in part.args)
        return
    left, right, first, second = part.as_choice().args
    below = known[left].value < known[right].value
    yield from ((first, below), (second, ~below))


def _metric_jets(corners: Array, relative: Array) -> dict[str, Jet]:
    """Return what a density may be written in, along one direction that no density was made for."""
    jets = _edge_jets(corners)
    metric = dict(zip(METRIC_NAMES, _products(*jets), strict=True))
    to_target = dict(zip(TARGET_NAMES, _products(*_edge_jets(relative)), strict=True))
    return dict(zip(DERIVATIVE_NAMES, jets, strict=True)) | metric | to_target


def _edge_jets(corners: Array) -> list[Jet]:
    direction = np.broadcast_to(np.random.default_rng(5).normal(size=(4, 1)), corners.shape)
    zero = np.zeros(corners.shape[1])
    return [Jet(value, slope, zero) for value, slope in zip(corners, direction, strict=True)]


def _products(a: Jet, b: Jet, c: Jet, d: Jet) -> tuple[Jet, ...]:
    """Return g11, g22, g12 and J of the edge vectors (a, b) and (c, d)."""
    return a * a + b * b, c * c + d * d, a * c + b * d, a * d + _constant(-1.0, a.value[np.newaxis]) * b * c


def _constant(value: Array | float, corners: Array) -> Jet:
    zero = np.zeros(corners.shape[1])
    return Jet(np.broadcast_to(np.asarray(value, dtype=float), zero.shape), zero, zero)


def _jet(part: sympy.Expr, known: Mapping[Any, Jet], corners: Array) -> Jet:
    """Return the jet of a part whose arguments are known."""
    import sympy

    from .choices import CHOICES

    if not part.args:
        return _constant(float(part), corners)
    arguments = [known[argument] for argument in part.args]
    if part.is_Add:
        return reduce(Jet.__add__, arguments)
    if part.is_Mul:
        return reduce(Jet.__mul__, arguments)
    if isinstance(part, sympy.Pow):
        return _power(*arguments, exponent=float(part.exp) if part.exp.is_number else None)
    if isinstance(part, CHOICES):
        left, right, first, second = (known[argument] for argument in part.as_choice().args)
        return first.where(left.value < right.value, second)
    if isinstance(part, sympy.atan2):
        return _angle(*arguments)
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


def _angle(y: Jet, x: Jet) -> Jet:
    """Return atan2(y, x)."""
    square = x.value**2 + y.value**2
    turn = x.value * y.first - y.value * x.first
    second = (x.value * y.second - y.value * x.second) / square
    return Jet(
        np.arctan2(y.value, x.value),
        turn / square,
        second - 2 * turn * (x.value * x.first + y.value * y.first) / square**2,
    )


@lru_cache(maxsize=32)
def _derivatives(function: Any) -> tuple[Callable[[Array], Array], ...]:  # noqa: ANN401 - a SymPy function
    """Return a function of one variable and its first two derivatives; kinks and jumps are left out."""
    import sympy

    if function is sympy.Abs:
        return np.abs, np.sign, np.zeros_like
    if function is sympy.sign:
        return np.sign, np.zeros_like, np.zeros_like
    z = sympy.Symbol("z", real=True)
    parts = [sympy.diff(function(z), z, order) for order in range(3)]
    return tuple(_broadcast(sympy.lambdify(z, part, "numpy")) for part in parts)


def _broadcast(function: Callable[[Array], Any]) -> Callable[[Array], Array]:
    """Return the function with results of the shape of its argument: constant derivatives are numbers."""
    return lambda values: np.broadcast_to(np.asarray(function(values), dtype=float), values.shape)
