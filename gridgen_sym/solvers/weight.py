"""Weights (the paper's adaptive function s): from a formula, a function or an array, checked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..errors import GridgenError
from ..functionals.expression import FUNCTION_NAMES, evaluate
from ..runtime import Array

Source = str | float | Callable[[Array, Array], npt.ArrayLike] | npt.NDArray[Any]

_NUMPY_FUNCTIONS = {name: getattr(np, {"atan": "arctan"}.get(name, name)) for name in FUNCTION_NAMES}
#: Partial derivatives of the weight, by the name of its plane.
_DERIVATIVES = {"s_x": "x", "s_y": "y", "s_xx": "xx", "s_xy": "xy", "s_yy": "yy"}


@dataclass(frozen=True, slots=True, eq=False)
class Weight:
    """A weight s(x, y).

    Attributes:
        source: a formula such as `"1 + 5*exp(-20*(x**2 + y**2))"`, a number, a function of two arrays
            (x, y), or an array with one value per node (only with mode `frozen`).
        mode: `frozen`: s is held at the nodes and evaluated again between steps, so that s·J becomes constant
            for the area functional; `differentiated`: s(x, y) belongs to the energy that is minimised, so that
            sqrt(s)·J becomes constant.
        allow_negative: accept a weight that is negative somewhere. The weighted area energy has no lower
            bound then; results say so.
    """

    source: Source
    mode: Literal["frozen", "differentiated"] = "frozen"
    allow_negative: bool = False

    def __post_init__(self) -> None:
        """Check what can be checked without a grid."""
        if self.mode not in ("frozen", "differentiated"):
            raise GridgenError(f"a weight's mode must be 'frozen' or 'differentiated'; came {self.mode!r}")
        if self.per_node and self.mode != "frozen":
            raise GridgenError(
                "an array of weights has no derivatives: use mode='frozen', or give a formula or a function"
            )

    @property
    def per_node(self) -> bool:
        """Whether it is given at the nodes of one grid only."""
        return not isinstance(self.source, str) and not callable(self.source) and _real(self.source).ndim > 0

    def planes(self, coordinates: Array, names: tuple[str, ...]) -> Array:
        """Return the weight at the nodes, and those of its derivatives that `names` lists, each (ni, nj).

        Raises:
            GridgenError: if it is not finite at a node, or negative without `allow_negative`; the node is named.
        """
        x, y = coordinates
        value = self._values(x, y)
        self._check(value, "weight", x, y)
        self._check_sign(value, x, y)
        if len(names) == 1:
            return value[np.newaxis]
        planes = [value]
        for name in names[1:]:
            planes.append(self._derivative(_DERIVATIVES[name], x, y))
            self._check(planes[-1], f"weight's derivative {name}", x, y)
        return np.stack(planes)

    def negative_nodes(self, coordinates: Array) -> int:
        """Return the number of nodes at which the weight is negative."""
        return int((self._values(*coordinates) < 0).sum())

    def _values(self, x: Array, y: Array) -> Array:
        try:
            with np.errstate(all="ignore"):
                if isinstance(self.source, str):
                    value = _real(evaluate(self.source, {"x": x, "y": y, "pi": np.pi}, _NUMPY_FUNCTIONS))
                else:
                    value = _real(self.source(x, y) if callable(self.source) else self.source)
        except GridgenError:
            raise
        except Exception as error:  # A user's function may raise anything.
            raise GridgenError(
                f"the weight {self.source!r} cannot be evaluated: {error}. It must be a formula in x and y, a function "
                "of two arrays (x, y), a number, or an array with one value per node"
            ) from error
        if value.shape not in ((), x.shape):
            raise GridgenError(f"the weight must have one value per node, shape {x.shape}; came {value.shape}")
        return np.ascontiguousarray(np.broadcast_to(value, x.shape))

    def _check(self, value: Array, what: str, x: Array, y: Array) -> None:
        bad = ~np.isfinite(value)
        if bad.any():
            i, j = (int(k) for k in np.argwhere(bad)[0])
            raise GridgenError(
                f"the {what} must be finite at every node; it is {value[i, j]} at node ({i}, {j}), "
                f"x = {x[i, j]:.6g}, y = {y[i, j]:.6g}: check its formula there"
            )

    def _check_sign(self, value: Array, x: Array, y: Array) -> None:
        if value.min() < 0 and not self.allow_negative:
            i, j = divmod(int(value.argmin()), value.shape[1])
            raise GridgenError(
                f"the weight must not be negative: it is {value.min():.6g} at node ({i}, {j}), x = {x[i, j]:.6g}, "
                f"y = {y[i, j]:.6g}, and the energy has no lower bound then. Add at least {-value.min():.6g} to it, "
                "take its absolute value, or insist with Weight(..., allow_negative=True)"
            )

    def _derivative(self, along: str, x: Array, y: Array) -> Array:
        if isinstance(self.source, str):
            return _symbolic_derivative(self.source, along, x, y)
        return self._difference(along, x, y)

    def _difference(self, along: str, x: Array, y: Array) -> Array:
        """Differentiate a function numerically, by central differences with a step that balances round-off."""
        size = max(float(np.ptp(x)), float(np.ptp(y)))
        h = size * (6e-6 if len(along) == 1 else 1e-4)
        shift = {"x": (h, 0.0), "y": (0.0, h)}
        (ax, ay) = shift[along[0]]
        if len(along) == 1:
            return (self._values(x + ax, y + ay) - self._values(x - ax, y - ay)) / (2 * h)
        (bx, by) = shift[along[1]]
        return (
            self._values(x + ax + bx, y + ay + by)
            - self._values(x + ax - bx, y + ay - by)
            - self._values(x - ax + bx, y - ay + by)
            + self._values(x - ax - bx, y - ay - by)
        ) / (4 * h * h)


def _real(values: npt.ArrayLike) -> Array:
    """Return values as an array of real numbers.

    Raises:
        GridgenError: for complex numbers, text or ragged lists.
    """
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "biuf":
            raise TypeError(f"numbers of type {array.dtype} came")
        return array.astype(float)
    except (TypeError, ValueError) as error:
        raise GridgenError(f"a weight must be real numbers, one or one per node: {error}") from error


def as_weight(weight: Weight | Source | None) -> Weight | None:
    """Return a weight given in any form as a `Weight`; a bare source is frozen, as in the paper."""
    return weight if weight is None or isinstance(weight, Weight) else Weight(weight)


def _symbolic_derivative(formula: str, along: str, x: Array, y: Array) -> Array:
    """Differentiate a formula exactly; loads SymPy."""
    function = _lambdified(formula, along)
    with np.errstate(all="ignore"):
        return np.ascontiguousarray(np.broadcast_to(function(x, y), x.shape)).astype(float)


_compiled: dict[tuple[str, str], Callable[[Array, Array], npt.ArrayLike]] = {}


def _lambdified(formula: str, along: str) -> Callable[[Array, Array], npt.ArrayLike]:
    if (formula, along) not in _compiled:
        import sympy

        from ..functionals.metric import symbol, sympy_functions

        variables = {name: symbol(name) for name in "xy"}
        expression = evaluate(formula, variables | {"pi": sympy.pi}, sympy_functions(), sympy.Rational)
        derivative = sympy.diff(expression, *(variables[name] for name in along))
        # Second derivatives of abs() are zero but on a line that no node need meet.
        derivative = derivative.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero)
        _compiled[formula, along] = sympy.lambdify(list(variables.values()), derivative, "numpy")
    return _compiled[formula, along]
