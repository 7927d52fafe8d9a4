"""Weights (the paper's adaptive function s): from a formula, a function, samples or an array, checked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError
from ..functionals.expression import FUNCTION_NAMES, evaluate
from ..grids import Grid
from .sampled import SampledField, grid_field, nodal, raster_field, scattered_field
from .weight_formula import compiled_formula, is_expression

if TYPE_CHECKING:
    import sympy

Mode = Literal["frozen", "differentiated"]
Source: TypeAlias = "str | float | sympy.Expr | Callable[[Array, Array], npt.ArrayLike] | npt.NDArray[Any]"

_NUMPY_FUNCTIONS = {name: getattr(np, {"atan": "arctan"}.get(name, name)) for name in FUNCTION_NAMES}
#: Beyond this size the squares of weights, and their products with other terms, overflow.
LARGEST = 1e100
#: Partial derivatives of the weight, by the name of its plane.
_DERIVATIVES = {"s_x": "x", "s_y": "y", "s_xx": "xx", "s_xy": "xy", "s_yy": "yy"}


@dataclass(frozen=True, slots=True, eq=False)
class Weight:
    """A weight s(x, y).

    Attributes:
        source: a formula such as `"1 + 5*exp(-20*(x**2 + y**2))"`, a SymPy expression in x and y, a number, a
            function of two arrays (x, y), or an array with one value per node or per cell (only with mode
            `frozen`). Fields known by samples come from `on_grid`, `on_raster` and `on_points`.
        mode: `frozen`: s is held at the nodes and evaluated again between steps, so that s·J becomes constant
            for the area functional; `differentiated`: s(x, y) belongs to the energy that is minimised, so that
            sqrt(s)·J becomes constant.
        allow_negative: accept a weight that is negative somewhere. The weighted area energy has no lower
            bound then; results say so.
    """

    source: Source
    mode: Mode = "frozen"
    allow_negative: bool = False

    @classmethod
    def on_grid(
        cls, grid: Grid, values: npt.ArrayLike, mode: Mode = "frozen", *, allow_negative: bool = False
    ) -> Weight:
        """Return the weight that interpolates values (ni, nj) at the nodes of a grid, or (ni-1, nj-1) in its cells.

        Unlike an array it belongs to places, not to nodes: where a node goes, it meets the weight of that place.
        Linear if frozen, cubic if differentiated (see `sampled`); the nearest sample counts outside the grid's hull.
        """
        return cls(grid_field(grid, values, smooth=mode == "differentiated"), mode, allow_negative)

    @classmethod
    def on_points(
        cls, points: npt.ArrayLike, values: npt.ArrayLike, mode: Mode = "frozen", *, allow_negative: bool = False
    ) -> Weight:
        """Return the weight that interpolates values (n,) at scattered points (n, 2), as `on_grid` does."""
        return cls(scattered_field(points, values, smooth=mode == "differentiated"), mode, allow_negative)

    @classmethod
    def on_raster(
        cls,
        x: npt.ArrayLike,
        y: npt.ArrayLike,
        values: npt.ArrayLike,
        mode: Mode = "frozen",
        *,
        allow_negative: bool = False,
    ) -> Weight:
        """Return the weight that interpolates a raster: values (nx, ny) at x (nx,) and y (ny,), in order.

        Bilinear if frozen, a bicubic spline if differentiated; the nearest value of the edge counts outside.
        """
        return cls(raster_field(x, y, values, smooth=mode == "differentiated"), mode, allow_negative)

    def __post_init__(self) -> None:
        """Check what can be checked without a grid."""
        if self.mode not in ("frozen", "differentiated"):
            raise GridgenError(f"a weight's mode must be 'frozen' or 'differentiated'; came {self.mode!r}")
        if is_expression(self.source):
            compiled_formula(self.source, "")
        if self.per_node and self.mode != "frozen":
            raise GridgenError(
                "an array of weights has no derivatives: use mode='frozen', or give a formula, a function or "
                "Weight.on_grid(grid, values, 'differentiated')"
            )

    @property
    def per_node(self) -> bool:
        """Whether it is given at the nodes or in the cells of one grid only."""
        source: Any = self.source
        of_place = isinstance(source, str) or callable(source) or is_expression(source)
        return not of_place and _real(source).ndim > 0

    @property
    def lags(self) -> bool:
        """Whether it is held while the nodes move, and another where they come to."""
        return self.mode == "frozen" and not self.per_node

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

    def nodes_outside(self, coordinates: Array) -> int:
        """Return the number of nodes outside the samples of the weight, where the nearest sample counts."""
        return self.source.outside(*coordinates) if isinstance(self.source, SampledField) else 0

    def _values(self, x: Array, y: Array) -> Array:
        try:
            with np.errstate(all="ignore"):
                if isinstance(self.source, str):
                    value = _real(evaluate(self.source, {"x": x, "y": y, "pi": np.pi}, _NUMPY_FUNCTIONS))
                elif is_expression(self.source):
                    value = _real(compiled_formula(self.source, "")(x, y))
                else:
                    value = _real(self.source(x, y) if callable(self.source) else self.source)
        except GridgenError:
            raise
        except Exception as error:  # A user's function may raise anything.
            raise GridgenError(
                f"the weight {self.source!r} cannot be evaluated: {error}. It must be a formula in x and y, a function "
                "of two arrays (x, y), a number, or an array with one value per node or per cell"
            ) from error
        if self.per_node and value.shape == (x.shape[0] - 1, x.shape[1] - 1):
            value = nodal(value)
        if value.shape not in ((), x.shape):
            cells = (x.shape[0] - 1, x.shape[1] - 1)
            raise GridgenError(
                f"the weight must have one value per node, shape {x.shape}, or an array one per cell, shape {cells}; "
                f"came {value.shape}. Samples of another grid are given as Weight.on_grid(grid, values)"
            )
        return np.ascontiguousarray(np.broadcast_to(value, x.shape))

    def _check(self, value: Array, what: str, x: Array, y: Array) -> None:
        bad = ~np.isfinite(value)
        if bad.any():
            i, j = (int(k) for k in np.argwhere(bad)[0])
            raise GridgenError(
                f"the {what} must be finite at every node; it is {value[i, j]} at node ({i}, {j}), "
                f"x = {x[i, j]:.6g}, y = {y[i, j]:.6g}: check its formula there"
            )
        if np.abs(value).max() > LARGEST:
            i, j = divmod(int(np.abs(value).argmax()), value.shape[1])
            raise GridgenError(
                f"the {what} is {value[i, j]:.3g} at node ({i}, {j}), x = {x[i, j]:.6g}, y = {y[i, j]:.6g}, and its "
                f"square overflows: divide it by a constant (at most {LARGEST:g} is allowed)"
            )

    def _check_sign(self, value: Array, x: Array, y: Array) -> None:
        if value.min() < 0 and not self.allow_negative:
            i, j = divmod(int(value.argmin()), value.shape[1])
            raise GridgenError(
                f"the weight must not be negative: it is {value.min():.6g} at node ({i}, {j}), x = {x[i, j]:.6g}, "
                f"y = {y[i, j]:.6g}, and the energy has no lower bound then. Add at least {-value.min():.6g} to it, "
                "take its absolute value, or insist with Weight(..., allow_negative=True) (--allow-negative-weight)"
            )

    def _derivative(self, along: str, x: Array, y: Array) -> Array:
        if isinstance(self.source, str) or is_expression(self.source):
            with np.errstate(all="ignore"):
                slope = compiled_formula(self.source, along)(x, y)
            return np.ascontiguousarray(np.broadcast_to(slope, x.shape)).astype(float)
        if isinstance(self.source, SampledField) and self.source.derivative is not None:
            return self.source.derivative(x, y, along.count("x"), along.count("y"))
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
        GridgenError: for complex numbers, text, ragged lists or masked numbers.
    """
    try:
        if np.ma.is_masked(values):
            raise TypeError("some of them are masked; fill them")
        array = np.asarray(values)
        if array.dtype.kind not in "biuf":
            raise TypeError(f"numbers of type {array.dtype} came")
        return array.astype(float)
    except (TypeError, ValueError) as error:
        raise GridgenError(f"a weight must be real numbers, one or one per node: {error}") from error


def as_weight(weight: Weight | Source | None) -> Weight | None:
    """Return a weight given in any form as a `Weight`; a bare source is frozen, as in the paper."""
    return weight if weight is None or isinstance(weight, Weight) else Weight(weight)
