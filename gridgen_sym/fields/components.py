"""The components of a declared field: a scalar field for each, from whatever form the user has given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted
from ..functionals.field_kinds import KINDS, components
from .field import VARIABLES, Domain, Field, Mode
from .function import difference, takes_two_arrays
from .sampled import SampledField
from .scalar import ScalarField, as_scalar


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
        return self.domain == "physical" and self.mode == "frozen" and any(part.varies for part in self.parts)


def components_of(given: Any, name: str, kind: str, called: str = "") -> Components:  # noqa: ANN401 - whatever a user gave
    """Return the components of a declared field.

    Args:
        given: a `Field`, or its source, which then is physical and frozen.
        name: of the field.
        kind: of the field.
        called: what messages call it; by default `the field` and its name.

    Raises:
        GridgenError: for what cannot be a field of this kind.
    """
    field = given if isinstance(given, Field) else Field(given)
    variables = VARIABLES[field.domain]
    called = called or f"the field {name}"
    labels = [called if one == name else f"the component {one} of {called}" for one in components(name, kind)]
    given_parts = zip(_sources(field, name, kind, called), labels, strict=True)
    parts = tuple(_scalar(source, label, variables) for source, label in given_parts)
    if field.mode == "differentiated" and any(part.per_node for part in parts):
        raise GridgenError(
            f"the field {name} is an array, which has no derivatives: use mode='frozen', or give a formula, a function "
            "or Field.on_grid(grid, values, 'differentiated')"
        )
    return Components(name, kind, field.domain, field.mode, parts)


def _scalar(source: Any, label: str, variables: tuple[str, str]) -> ScalarField:  # noqa: ANN401
    if isinstance(source, _Part):
        return ScalarField(label, source.joint.function, source, variables=variables)
    return as_scalar(source, label, variables)


def _sources(field: Field, name: str, kind: str, called: str) -> Sequence[Any]:
    """Return a source for each component."""
    source, count = field.source, len(KINDS[kind])
    if count == 1 and not isinstance(source, (tuple, list, np.ndarray)):
        return (source,)
    if isinstance(source, (tuple, list)) and not _is_nested(source):
        if len(source) == count:
            return source
    elif callable(source) and not isinstance(source, SampledField):
        if takes_two_arrays(source):
            joint = _Joint(source, called, count)
            return [_Part(joint, k) for k in range(count)]
    elif isinstance(source, (np.ndarray, tuple, list)):
        array = real_array(source, called)
        if count == 1:
            return (array[0] if array.ndim in (3, 4) and array.shape[0] == 1 else array,)
        if array.shape[:1] == (count,):
            return tuple(array)
    order = ", ".join(components(name, kind))
    came = f"an array of shape {np.shape(source)}" if isinstance(source, np.ndarray) else quoted(source)
    raise GridgenError(
        f"{called} is {kind} and needs {count} component{'s' * (count > 1)}, in the order {order}: give a "
        f"tuple of {count} formulas, a function of two arrays that returns them along its first axis, or an array "
        f"({count}, ...); came {came}"
    )


def _is_nested(source: Sequence[Any]) -> bool:
    """Return whether a sequence is an array written as lists: its entries are sequences of numbers."""
    return all(isinstance(entry, (tuple, list)) for entry in source)


class _Joint:
    """A function that returns all components at once.

    What it gave last is kept, values and derivatives, since each component asks for them.
    """

    __slots__ = ("_at", "_kept", "called", "count", "function")

    def __init__(self, function: Callable[[Array, Array], npt.ArrayLike], called: str, count: int) -> None:
        self.function, self.called, self.count = function, called, count
        self._at: tuple[Array | None, Array | None] = (None, None)
        self._kept: dict[str, Array] = {}

    def along(self, u: Array, v: Array, key: str) -> Array:
        """Return the components at points, or for a key such as `x` or `xy` their derivatives."""
        if self._at[0] is not u or self._at[1] is not v:
            self._at, self._kept = (u, v), {}
        if key not in self._kept:
            self._kept[key] = difference(self._call, u, v, key) if key else self._call(u, v)
        return self._kept[key]

    def _call(self, u: Array, v: Array) -> Array:
        found = self.function(u, v)
        # Components may be of different shapes: a number and arrays.
        if isinstance(found, (tuple, list)) and len(found) == self.count:
            found = np.stack([np.broadcast_to(one, u.shape) for one in found])
        array = real_array(found, self.called)
        if array.shape != (self.count, *u.shape):
            raise GridgenError(
                f"the function of {self.called} must return an array of shape {(self.count, *u.shape)}, components "
                f"first; came {array.shape}"
            )
        return array


@dataclass(frozen=True, slots=True)
class _Part:
    """One component of a function of all of them: what a `ScalarField` evaluates."""

    joint: _Joint
    number: int

    def values(self, x: Array, y: Array) -> Array:
        """Return the values at points."""
        return np.asarray(self.joint.along(x, y, "")[self.number])

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        """Return the derivatives along `x`, `y`, `xx`, `xy` or `yy`, by differences."""
        return [self.joint.along(x, y, key)[self.number] for key in along]
