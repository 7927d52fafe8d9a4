"""Declared fields of a density: what a user gives for one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted
from ..grids import Grid
from .outside import Outside
from .sampled import SampledField, grid_field, raster_field, scattered_field

Domain = Literal["physical", "logical"]
Mode = Literal["frozen", "differentiated"]

#: The coordinates of each domain.
VARIABLES: dict[str, tuple[str, str]] = {"physical": ("x", "y"), "logical": ("xi", "eta")}


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """Values of a field that a density declares.

    Attributes:
        source: of a scalar, a formula, a number, a SymPy expression, a function of two arrays, samples (`raster_field`,
            `scattered_field`, or `Field.on_grid`), or an array per node (ni, nj), per cell (ni-1, nj-1) or per corner
            (4, ni-1, nj-1; in the order of `corner_jacobians`). Of several components, a tuple of these, in the order
            1, 2 of a vector, 11, 12, 22 of a symmetric matrix, or 11, 12, 21, 22 of another one; a function that
            returns the components along its first axis; or an array with the components along its first axis.
        domain: `physical`: functions are of the arrays x and y; `logical`: of xi and eta, in [0, 1].
        mode: `frozen`: values are held at the nodes, and evaluated again between steps; `differentiated`: the field
            belongs to the energy that is minimized. A logical field does not change where nodes move, and has no mode.
    """

    source: Any
    domain: Domain = "physical"
    mode: Mode = "frozen"

    def __post_init__(self) -> None:
        """Check what can be checked without a kind."""
        if self.domain not in VARIABLES:
            raise GridgenError(f"a field's domain must be 'physical' or 'logical'; came {quoted(self.domain)}")
        if self.mode not in ("frozen", "differentiated"):
            raise GridgenError(f"a field's mode must be 'frozen' or 'differentiated'; came {quoted(self.mode)}")
        if self.domain == "logical" and self.mode == "differentiated":
            raise GridgenError(
                "a logical field does not change where nodes move, so there is nothing to differentiate through: drop "
                "mode='differentiated', or give a function of x and y"
            )

    @classmethod
    def on_grid(cls, grid: Grid, values: npt.ArrayLike, mode: Mode = "frozen", *, outside: Outside = "error") -> Field:
        """Return the field that interpolates values at the nodes (ni, nj), or in the cells, of a grid.

        Of several components, values have these along the first axis. It belongs to positions: a node that moves has
        the value of its new position (see `grid_field`). Nodes outside the samples are refused, or have the value of
        the nearest sample with `outside="nearest"`.
        """
        smooth = mode == "differentiated"
        return cls._sampled(values, mode, lambda one: grid_field(grid, one, smooth=smooth, outside=outside))

    @classmethod
    def on_points(
        cls, points: npt.ArrayLike, values: npt.ArrayLike, mode: Mode = "frozen", *, outside: Outside = "error"
    ) -> Field:
        """Return the field that interpolates values (n,), or (k, n), at scattered points (n, 2)."""
        smooth = mode == "differentiated"
        return cls._sampled(
            values, mode, lambda one: scattered_field(points, one, smooth=smooth, outside=outside), axes=1
        )

    @classmethod
    def on_raster(
        cls,
        x: npt.ArrayLike,
        y: npt.ArrayLike,
        values: npt.ArrayLike,
        mode: Mode = "frozen",
        *,
        outside: Outside = "error",
    ) -> Field:
        """Return the field that interpolates a raster: values (nx, ny), or (k, nx, ny), at x (nx,) and y (ny,)."""
        smooth = mode == "differentiated"
        return cls._sampled(values, mode, lambda one: raster_field(x, y, one, smooth=smooth, outside=outside))

    @classmethod
    def _sampled(
        cls, values: npt.ArrayLike, mode: Mode, interpolate: Callable[[Array], SampledField], axes: int = 2
    ) -> Field:
        array = real_array(values, "the values of samples")
        if array.ndim == axes:
            return cls(interpolate(array), mode=mode)
        if array.ndim != axes + 1:
            raise GridgenError(
                f"the values of samples must have {axes} axes, or {axes + 1} with the components along the first; "
                f"came the shape {array.shape}"
            )
        return cls(tuple(interpolate(one) for one in array), mode=mode)
