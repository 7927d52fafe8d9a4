"""Weights, the paper's adaptive function s: a scalar field that is not negative, and how the solvers see it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError, UnusableValueError, quoted
from ..grids import Grid
from .field import Field, as_field
from .field import Source as Source
from .sampled import grid_field, raster_field, scattered_field

Mode = Literal["frozen", "differentiated"]

#: Beyond this size the squares of weights, and their products with other terms, overflow.
LARGEST = 1e100


@dataclass(frozen=True, slots=True, eq=False)
class Weight:
    """A weight s(x, y).

    Attributes:
        source: a formula such as `"1 + 5*exp(-20*(x**2 + y**2))"`, a SymPy expression in x and y, a number, a
            function of two arrays (x, y), or an array with one value per node or per cell (only with mode
            `frozen`). Fields known by samples come from `on_grid`, `on_raster` and `on_points`.
        mode: `frozen`: s is held at the nodes and evaluated again between steps, so that s·J becomes constant
            for the area functional; `differentiated`: s(x, y) belongs to the energy that is minimized, so that
            sqrt(s)·J becomes constant.
        allow_negative: accept a weight that is negative somewhere. The weighted area energy has no lower
            bound then; results report it.
        field: made of the source.
    """

    source: Source
    mode: Mode = "frozen"
    allow_negative: bool = False
    field: Field = field(init=False, repr=False)

    @classmethod
    def on_grid(
        cls, grid: Grid, values: npt.ArrayLike, mode: Mode = "frozen", *, allow_negative: bool = False
    ) -> Weight:
        """Return the weight that interpolates values (ni, nj) at the nodes of a grid, or (ni-1, nj-1) in its cells.

        Unlike an array it belongs to positions, not to nodes: a node that moves has the weight of its new position.
        Linear if frozen, cubic if differentiated (see `grid_field`); outside the grid the nearest sample counts.
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
        """Make the field, and check what can be checked without a grid."""
        if self.mode not in ("frozen", "differentiated"):
            raise GridgenError(f"a weight's mode must be 'frozen' or 'differentiated'; came {quoted(self.mode)}")
        object.__setattr__(self, "field", as_field(self.source, "the weight"))
        if self.per_node and self.mode != "frozen":
            raise GridgenError(
                "an array of weights has no derivatives: use mode='frozen', or give a formula, a function or "
                "Weight.on_grid(grid, values, 'differentiated')"
            )

    @property
    def per_node(self) -> bool:
        """Whether it is given at the nodes or in the cells of one grid only."""
        return self.field.per_node

    @property
    def lags(self) -> bool:
        """Whether it is held while the nodes move, and evaluated again where they come to."""
        return self.mode == "frozen" and not self.per_node

    def planes(self, coordinates: Array, names: tuple[str, ...]) -> Array:
        """Return the weight at the nodes, and its derivatives that `names` lists after it, each (ni, nj).

        Args:
            coordinates: (2, ni, nj).
            names: `s`, and for example `s_x` or `s_xy`.

        Raises:
            GridgenError: if it is not finite at a node, or negative without `allow_negative`; the node is named.
        """
        value = self.values(coordinates)
        if len(names) == 1:
            return value[np.newaxis]
        x, y = coordinates
        derivatives = self.field.derivatives(x, y, tuple(name.removeprefix("s_") for name in names[1:]))
        for name, derivative in zip(names[1:], derivatives, strict=True):
            _check_size(derivative, f"the weight's derivative {name}", coordinates)
        return np.stack([value, *derivatives])

    def values(self, coordinates: Array, where: str = "node") -> Array:
        """Return the weight at points (2, ni, nj), checked as `planes` does; messages call a point `where`."""
        x, y = coordinates
        value = self.field.values(x, y, where)
        _check_size(value, "the weight", coordinates)
        if value.min() < 0 and not self.allow_negative:
            i, j = divmod(int(value.argmin()), value.shape[1])
            raise UnusableValueError(
                f"the weight must not be negative: it is {value.min():.6g} at {where} ({i}, {j}), x = {x[i, j]:.6g}, "
                f"y = {y[i, j]:.6g}, and where cells may fold the energy has no lower bound. Add at least "
                f"{-value.min():.6g} to it, take its absolute value, or insist with Weight(..., allow_negative=True) "
                "(--allow-negative-weight)"
            )
        return value

    def negative_nodes(self, coordinates: Array) -> int:
        """Return the number of nodes at which the weight is negative."""
        return int((self.field.values(coordinates[0], coordinates[1]) < 0).sum())

    def nodes_outside(self, coordinates: Array) -> int:
        """Return the number of nodes outside the samples of the weight, where the nearest sample counts."""
        return self.field.outside(coordinates[0], coordinates[1])


def _check_size(value: Array, name: str, coordinates: Array) -> None:
    """Refuse values whose squares overflow."""
    if np.abs(value).max() > LARGEST:
        i, j = divmod(int(np.abs(value).argmax()), value.shape[1])
        x, y = coordinates[:, i, j]
        raise UnusableValueError(
            f"{name} is {value[i, j]:.3g} at node ({i}, {j}), x = {x:.6g}, y = {y:.6g}, and its square overflows: "
            f"divide it by a constant (at most {LARGEST:g} is allowed)"
        )


def as_weight(weight: Weight | Source | None) -> Weight | None:
    """Return a weight given in any form as a `Weight`; a bare source is frozen, as in the paper."""
    return weight if weight is None or isinstance(weight, Weight) else Weight(weight)
