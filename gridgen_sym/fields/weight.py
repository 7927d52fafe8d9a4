"""Weights, the paper's adaptive function s: a scalar field that is not negative, and how the solvers see it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError, UnusableValueError, quoted
from ..grids import Grid
from .outside import Outside
from .sampled import grid_field, raster_field, scattered_field
from .scalar import ScalarField, as_scalar
from .scalar import Source as Source

Mode = Literal["frozen", "differentiated"]

#: Beyond this size the squares of weights, and their products with other terms, overflow.
LARGEST = 1e100


@dataclass(frozen=True, slots=True, eq=False)
class Weight:
    """A weight s(x, y).

    Attributes:
        source: a formula such as `"1 + 5*exp(-20*(x**2 + y**2))"`, a SymPy expression in x and y, a number, a
            function of two arrays (x, y), or (only with mode `frozen`) an array with one value per node, per cell, or
            per corner (4, ni-1, nj-1) in the order of `corner_jacobians`. Fields known by samples come from `on_grid`,
            `on_raster` and `on_points`.
        mode: hold the weight at the nodes, or differentiate through it. `frozen`: s is evaluated again between steps,
            so that s·J becomes constant for the area functional; `differentiated`: s(x, y) belongs to the energy that
            is minimized, so that sqrt(s)·J becomes constant.
        allow_negative: accept a weight that is negative somewhere. The weighted area energy has no lower
            bound then; results report it.
        field: made of the source.
    """

    source: Source
    mode: Mode = "frozen"
    allow_negative: bool = False
    field: ScalarField = field(init=False, repr=False)

    @classmethod
    def on_grid(
        cls,
        grid: Grid,
        values: npt.ArrayLike,
        mode: Mode = "frozen",
        *,
        allow_negative: bool = False,
        outside: Outside = "error",
    ) -> Weight:
        """Return the weight that interpolates values (ni, nj) at the nodes of a grid, or (ni-1, nj-1) in its cells.

        Unlike an array it belongs to positions, not to nodes: a node that moves has the weight of its new position.
        Linear if frozen, cubic if differentiated (see `grid_field`). Nodes outside the grid are refused, or have the
        value of the nearest sample with `outside="nearest"`.
        """
        sampled = grid_field(grid, values, smooth=mode == "differentiated", outside=outside)
        return cls(sampled, mode, allow_negative)

    @classmethod
    def on_points(
        cls,
        points: npt.ArrayLike,
        values: npt.ArrayLike,
        mode: Mode = "frozen",
        *,
        allow_negative: bool = False,
        outside: Outside = "error",
    ) -> Weight:
        """Return the weight that interpolates values (n,) at scattered points (n, 2), as `on_grid` does."""
        sampled = scattered_field(points, values, smooth=mode == "differentiated", outside=outside)
        return cls(sampled, mode, allow_negative)

    @classmethod
    def on_raster(
        cls,
        x: npt.ArrayLike,
        y: npt.ArrayLike,
        values: npt.ArrayLike,
        mode: Mode = "frozen",
        *,
        allow_negative: bool = False,
        outside: Outside = "error",
    ) -> Weight:
        """Return the weight that interpolates a raster: values (nx, ny) at x (nx,) and y (ny,), in order.

        Bilinear if frozen, a bicubic spline if differentiated; outside as in `on_grid`.
        """
        sampled = raster_field(x, y, values, smooth=mode == "differentiated", outside=outside)
        return cls(sampled, mode, allow_negative)

    def __post_init__(self) -> None:
        """Make the field, and check what can be checked without a grid."""
        if self.mode not in ("frozen", "differentiated"):
            raise GridgenError(f"a weight's mode must be 'frozen' or 'differentiated'; came {quoted(self.mode)}")
        object.__setattr__(self, "field", as_scalar(self.source, "the weight"))
        if self.per_node and self.mode != "frozen":
            raise GridgenError(
                "an array of weights has no derivatives: use mode='frozen', or give a formula, a function or "
                "Weight.on_grid(grid, values, 'differentiated')"
            )

    @property
    def per_node(self) -> bool:
        """Whether it is given at the nodes, in the cells or at the corners of one grid only."""
        return self.field.per_node

    @property
    def lags(self) -> bool:
        """Whether it is held while the nodes move, and evaluated again where they come to."""
        return self.mode == "frozen" and self.field.varies

    def planes(self, coordinates: Array, names: tuple[str, ...]) -> list[Array]:
        """Return the weight, per node, cell or corner as it is given, and its derivatives that `names` lists after it.

        Args:
            coordinates: (2, ni, nj).
            names: `s`, and for example `s_x` or `s_xy`.

        Raises:
            GridgenError: if it is not finite at a node, or negative without `allow_negative`; the node is named.
        """
        x, y = coordinates
        value = self._checked(self.field.plane(x, y), coordinates, "node")
        if len(names) == 1:
            return [value]
        derivatives = self.field.derivatives(x, y, tuple(name.removeprefix("s_") for name in names[1:]))
        for name, derivative in zip(names[1:], derivatives, strict=True):
            _check_size(derivative, f"the weight's derivative {name}", coordinates)
        return [value, *derivatives]

    def values(self, coordinates: Array, where: str = "node") -> Array:
        """Return the weight at points (2, ni, nj), checked as `planes` does; messages call a point `where`."""
        return self._checked(self.field.values(coordinates[0], coordinates[1], where), coordinates, where)

    def _checked(self, value: Array, coordinates: Array, where: str) -> Array:
        """Refuse a weight that is too large, or negative without `allow_negative`."""
        _check_size(value, "the weight", coordinates)
        if value.min() < 0 and not self.allow_negative:
            raise UnusableValueError(
                f"the weight must not be negative: it is {value.min():.6g} at "
                f"{_place(value, int(value.argmin()), coordinates, where)}, and where cells may fold the energy has no "
                f"lower bound. Add at least {-value.min():.6g} to it, take its absolute value, or insist with "
                "Weight(..., allow_negative=True) (--allow-negative-weight)"
            )
        return value

    def negative_nodes(self, coordinates: Array) -> int:
        """Return the number of nodes at which the weight is negative."""
        return int((self.field.values(coordinates[0], coordinates[1]) < 0).sum())

    def check_samples(self, coordinates: Array, among: npt.NDArray[np.bool_] | None = None) -> None:
        """Refuse nodes outside the samples of the weight, as `ScalarField.check_samples` does."""
        self.field.check_samples(coordinates[0], coordinates[1], among=among)

    def nodes_outside(self, coordinates: Array) -> int:
        """Return the number of nodes outside the samples of the weight, where the nearest sample counts."""
        return self.field.outside(coordinates[0], coordinates[1])


def _check_size(value: Array, name: str, coordinates: Array) -> None:
    """Refuse values whose squares overflow."""
    if np.abs(value).max() > LARGEST:
        number = int(np.abs(value).argmax())
        raise UnusableValueError(
            f"{name} is {value.flat[number]:.3g} at {_place(value, number, coordinates, 'node')}, and its square "
            f"overflows: divide it by a constant (at most {LARGEST:g} is allowed)"
        )


def _place(value: Array, number: int, coordinates: Array, where: str) -> str:
    """Return the place of an entry of a plane in words: at a point with its coordinates."""
    index = tuple(int(k) for k in np.unravel_index(number, value.shape))
    if value.shape != coordinates.shape[1:]:
        return f"{'corner' if value.ndim == 3 else 'cell'} {index}"
    x, y = coordinates[0][index], coordinates[1][index]
    return f"{where} {index}, x = {x:.6g}, y = {y:.6g}"


def as_weight(weight: Weight | Source | None) -> Weight | None:
    """Return a weight given in any form as a `Weight`; a bare source is frozen, as in the paper."""
    return weight if weight is None or isinstance(weight, Weight) else Weight(weight)
