"""Declared fields of a density: what a user gives for one, and its components on a grid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted
from ..functionals.field_kinds import KINDS, components
from ..grids import Grid
from .function import difference, takes_two_arrays
from .sampled import SampledField, grid_field, raster_field, scattered_field
from .scalar import ScalarField, as_scalar

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
    def on_grid(cls, grid: Grid, values: npt.ArrayLike, mode: Mode = "frozen") -> Field:
        """Return the field that interpolates values at the nodes (ni, nj), or in the cells, of a grid.

        Of several components, values have these along the first axis. It belongs to positions: a node that moves has
        the value of its new position (see `grid_field`).
        """
        return cls._sampled(values, mode, lambda one: grid_field(grid, one, smooth=mode == "differentiated"))

    @classmethod
    def on_points(cls, points: npt.ArrayLike, values: npt.ArrayLike, mode: Mode = "frozen") -> Field:
        """Return the field that interpolates values (n,), or (k, n), at scattered points (n, 2)."""
        smooth = mode == "differentiated"
        return cls._sampled(values, mode, lambda one: scattered_field(points, one, smooth=smooth), axes=1)

    @classmethod
    def on_raster(cls, x: npt.ArrayLike, y: npt.ArrayLike, values: npt.ArrayLike, mode: Mode = "frozen") -> Field:
        """Return the field that interpolates a raster: values (nx, ny), or (k, nx, ny), at x (nx,) and y (ny,)."""
        return cls._sampled(values, mode, lambda one: raster_field(x, y, one, smooth=mode == "differentiated"))

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


@dataclass(frozen=True, slots=True, eq=False)
class Components:
    """The components of one declared field.

    Attributes:
        name: of the field.
        kind: of the field.
        domain: of functions.
        mode: of functions.
        parts: the components, in order.
    """

    name: str
    kind: str
    domain: Domain
    mode: Mode
    parts: tuple[ScalarField, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the components."""
        return components(self.name, self.kind)

    @property
    def lags(self) -> bool:
        """Whether it is held while the nodes move, and evaluated again where they come to."""
        moves = self.domain == "physical" and any(not part.per_node for part in self.parts)
        return moves and self.mode == "frozen"


def components_of(given: Any, name: str, kind: str) -> Components:  # noqa: ANN401 - whatever a user gave
    """Return the components of a declared field.

    Args:
        given: a `Field`, or its source, which then is physical and frozen.
        name: of the field.
        kind: of the field.

    Raises:
        GridgenError: for what cannot be a field of this kind.
    """
    field = given if isinstance(given, Field) else Field(given)
    variables = VARIABLES[field.domain]
    described = _described(name, kind)
    parts = tuple(
        as_scalar(source, label, variables)
        for source, label in zip(_sources(field, name, kind), described, strict=True)
    )
    if field.mode == "differentiated" and any(part.per_node for part in parts):
        raise GridgenError(
            f"the field {name} is an array, which has no derivatives: use mode='frozen', or give a formula, a function "
            "or Field.on_grid(grid, values, 'differentiated')"
        )
    return Components(name, kind, field.domain, field.mode, parts)


def _described(name: str, kind: str) -> list[str]:
    """Return what messages call the components."""
    if kind == "scalar":
        return [f"the field {name}"]
    return [f"the component {one} of the field {name}" for one in components(name, kind)]


def _sources(field: Field, name: str, kind: str) -> Sequence[Any]:
    """Return a source for each component."""
    source, count = field.source, len(KINDS[kind])
    if count == 1 and not isinstance(source, (tuple, list, np.ndarray)):
        return (source,)
    if isinstance(source, (tuple, list)) and not _is_nested(source):
        if len(source) == count:
            return source
    elif callable(source) and not isinstance(source, SampledField):
        if takes_two_arrays(source):
            joint = _Joint(source, f"the field {name}", count)
            return [_Part(joint, k) for k in range(count)]
    elif isinstance(source, (np.ndarray, tuple, list)):
        array = real_array(source, f"the field {name}")
        if count == 1:
            return (array[0] if array.ndim in (3, 4) and array.shape[0] == 1 else array,)
        if array.shape[:1] == (count,):
            return tuple(array)
    order = ", ".join(components(name, kind))
    came = f"an array of shape {np.shape(source)}" if isinstance(source, np.ndarray) else quoted(source)
    raise GridgenError(
        f"the field {name} is {kind} and needs {count} component{'s' * (count > 1)}, in the order {order}: give a "
        f"tuple of {count} formulas, a function of two arrays that returns them along its first axis, or an array "
        f"({count}, ...); came {came}"
    )


def _is_nested(source: Sequence[Any]) -> bool:
    """Return whether a sequence is an array written as lists: its entries are sequences of numbers."""
    return all(isinstance(entry, (tuple, list)) for entry in source)


class _Joint:
    """A function that returns all components at once; the last result is kept, since each component asks for it."""

    __slots__ = ("_at", "_found", "count", "function", "name")

    def __init__(self, function: Callable[[Array, Array], npt.ArrayLike], name: str, count: int) -> None:
        self.function, self.name, self.count = function, name, count
        self._at: tuple[Any, Any] = (None, None)
        self._found: Array = np.empty(0)

    def __call__(self, u: Array, v: Array) -> Array:
        if self._at[0] is not u or self._at[1] is not v:
            found = self.function(u, v)
            # Components may be of different shapes: a number and arrays.
            if isinstance(found, (tuple, list)) and len(found) == self.count:
                found = np.stack([np.broadcast_to(one, u.shape) for one in found])
            array = real_array(found, self.name)
            if array.shape != (self.count, *u.shape):
                raise GridgenError(
                    f"the function of {self.name} must return an array of shape {(self.count, *u.shape)}, components "
                    f"first; came {array.shape}"
                )
            self._at, self._found = (u, v), array
        return self._found


class _Part:
    """One component of a joint function, as a function of two arrays."""

    __slots__ = ("joint", "number")

    def __init__(self, joint: _Joint, number: int) -> None:
        self.joint, self.number = joint, number

    def __call__(self, u: Array, v: Array) -> Array:
        return np.asarray(self.joint(u, v)[self.number])

    def derivatives(self, u: Array, v: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        return [difference(self, u, v, key) for key in along]
