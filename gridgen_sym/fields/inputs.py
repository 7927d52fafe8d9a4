"""All that a density is given beside the metric: the weight, the place, declared fields and a target, on a grid."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, UnusableValueError, quoted
from ..functionals.definition import Functional
from ..functionals.expression import comparisons, names_in
from ..functionals.metric import INVERSE_TARGET_NAMES, WEIGHT_NAME
from ..functionals.variant import Modes, Variant
from .field import Components, components_of
from .restriction import restricted
from .scalar import ScalarField
from .target import Target, common_location, location
from .weight import Weight

#: Beyond this size the products of values overflow.
_LARGEST = 1e100
_HOLDS: Mapping[str, Callable[..., Any]] = {
    ">": np.greater,
    ">=": np.greater_equal,
    "<": np.less,
    "<=": np.less_equal,
    "==": np.isclose,
}


@dataclass(frozen=True, slots=True, eq=False)
class DensityInputs:
    """What a functional is given beside the metric.

    Attributes:
        functional: that is given it.
        weight: the weight, or None.
        fields: the components of all declared fields.
        target: the target, or None.
        shape: (ni, nj) of the grid that arrays belong to; on coarser grids of the same logical square they are
            interpolated.
    """

    functional: Functional
    weight: Weight | None
    fields: tuple[Components, ...]
    target: Target | None
    shape: tuple[int, int]

    @property
    def variant(self) -> Variant:
        """The variant of the kernels that take this."""
        moving = tuple(sorted(field.name for field in self.fields if field.mode == "differentiated"))
        return Modes(self.weight.mode if self.weight else "", moving, self.target is not None).variant

    @property
    def lags(self) -> bool:
        """Whether something is held while the nodes move, and evaluated again where they come to."""
        weight = self.weight is not None and self.weight.lags
        target = self.target is not None and self.target.domain == "physical"
        return weight or target or any(field.lags for field in self.fields)

    @property
    def settled(self) -> bool:
        """Whether nothing depends on where the nodes are, so that one evaluation is enough for a grid's shape."""
        return self.weight is None and not self.lags and all(field.mode == "frozen" for field in self.fields)

    def planes(
        self, coordinates: Array, names: tuple[str, ...], steps: tuple[float, float] = (1.0, 1.0)
    ) -> list[Array]:
        """Return the planes that kernels read, in the order of `names`, each per node, cell or corner.

        Args:
            coordinates: (2, ni, nj).
            names: of the planes: those of the weight, `x`, `y`, `xi`, `eta`, of fields and their derivatives, and of
                the inverse target.
            steps: the steps of the logical coordinates that edges are divided by.

        Raises:
            GridgenError: for values that cannot be used: the field, the place and the repair are named.
        """
        found: dict[str, Array] = {}
        if self.weight is not None:
            own = tuple(name for name in names if name == WEIGHT_NAME or name.startswith(f"{WEIGHT_NAME}_"))
            found |= zip(own, self.weight.planes(coordinates, own), strict=True)
        found |= dict(zip("xy", coordinates, strict=True))
        found |= dict(zip(("xi", "eta"), _logical(coordinates.shape[1:]), strict=True))
        for field in self.fields:
            found |= self._field(field, coordinates, names)
        if self.target is not None:
            found |= zip(INVERSE_TARGET_NAMES, self._inverse_target(self.target, coordinates, steps), strict=True)
        return [np.ascontiguousarray(found[name]) for name in names]

    def _field(self, field: Components, coordinates: Array, names: tuple[str, ...]) -> Iterator[tuple[str, Array]]:
        """Yield the planes of a field."""
        points = tuple(coordinates) if field.domain == "physical" else _logical(coordinates.shape[1:])
        planes = [self._plane(part, points) for part in field.parts]
        self._check(field, planes, points)
        for name, part, plane in zip(field.names, field.parts, planes, strict=True):
            yield name, plane
            along = tuple(key for key in ("x", "y", "xx", "xy", "yy") if f"{name}_{key}" in names)
            if along:
                derivatives = part.derivatives(points[0], points[1], along)
                yield from zip((f"{name}_{key}" for key in along), derivatives, strict=True)

    def _plane(self, part: ScalarField, points: tuple[Array, ...]) -> Array:
        """Return a part on a grid: arrays of a finer one are interpolated to it."""
        if part.numbers is not None and points[0].shape != self.shape:
            return restricted(part.plane(*_logical(self.shape)), self.shape, points[0].shape)
        return part.plane(points[0], points[1])

    def _check(self, field: Components, planes: list[Array], points: tuple[Array, ...]) -> None:
        """Refuse values that the declaration of a field does not allow."""
        shape = points[0].shape
        for part, plane in zip(field.parts, planes, strict=True):
            if not np.abs(plane).max() <= _LARGEST:
                raise UnusableValueError(f"{part.name} is larger than {_LARGEST:g}, and its square overflows: scale it")
        together = common_location(planes, (shape[0], shape[1]))
        if field.kind == "symmetric":
            first, mixed, second = together
            bad = ~((first > 0) & (first * second - mixed**2 > 0))
            if bad.any():
                index = tuple(int(k) for k in np.argwhere(bad)[0])
                values = ", ".join(f"{n} = {p[index]:.6g}" for n, p in zip(field.names, together, strict=True))
                raise UnusableValueError(
                    f"the field {field.name} must be positive definite; it is not at "
                    f"{_place(field, first, points, index)}, where {values}: its eigenvalues must be positive, so add "
                    f"a multiple of the identity or limit {field.names[1]}"
                )
        for constraint in self.functional.constraints:
            if names_in(constraint) & {*field.names}:
                self._check_constraint(constraint, field, together, points)

    def _check_constraint(
        self, constraint: str, field: Components, planes: list[Array], points: tuple[Array, ...]
    ) -> None:
        """Refuse values that do not meet a constraint of the functional on a field (and on parameters' defaults)."""
        known = {**self.functional.parameters, **dict(zip(field.names, planes, strict=True))}
        if not names_in(constraint) <= {*known}:
            return  # It is on several fields.
        for one in comparisons(constraint, known):
            bad = ~np.broadcast_to(_HOLDS[one.sign](one.left, one.right), planes[0].shape)
            if bad.any():
                index = tuple(int(k) for k in np.argwhere(bad)[0])
                values = ", ".join(f"{n} = {p[index]:.6g}" for n, p in zip(field.names, planes, strict=True))
                where = _place(field, planes[0], points, index)
                raise UnusableValueError(
                    f"functional {self.functional.name!r} needs {constraint}; at {where} {values}: change the field "
                    f"{field.name} there"
                )

    def _inverse_target(
        self, target: Target, coordinates: Array, steps: tuple[float, float]
    ) -> tuple[Array, Array, Array, Array]:
        """Return V = W⁻¹ for edges that are divided by `steps`.

        W is that of edges with steps of 1 on the grid of the shape `shape`; on a coarser one, cells and W are larger.
        """
        shape = coordinates.shape[1:]
        points = tuple(coordinates) if target.domain == "physical" else _logical(shape)
        first, second, third, fourth = target.inverse(lambda part: self._plane(part, points), (shape[0], shape[1]))
        along_xi, along_eta = (
            step * (now - 1) / (home - 1) for step, now, home in zip(steps, shape, self.shape, strict=True)
        )
        return first * along_xi, second * along_xi, third * along_eta, fourth * along_eta

    def exists(self, coordinates: Array, names: tuple[str, ...]) -> bool:
        """Return whether everything can be evaluated on a grid."""
        try:
            self.planes(coordinates, names)
        except UnusableValueError:
            return False
        return True

    def remarks(self, coordinates: Array) -> str:
        """Return a remark on nodes outside the samples of a field, with a leading blank, or nothing."""
        said = ""
        for field in self.fields:
            parts = [part for part in field.parts if field.domain == "physical"]
            outside = max((part.outside(*coordinates) for part in parts), default=0)
            if outside:
                said += (
                    f" {outside} of {coordinates[0].size} nodes lie outside the samples of the field {field.name}: the "
                    "nearest sample counts there."
                )
        return said


def _logical(shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Return xi and eta at the nodes."""
    xi, eta = np.meshgrid(np.linspace(0, 1, shape[0]), np.linspace(0, 1, shape[1]), indexing="ij")
    return xi, eta


def _place(field: Components, plane: Array, points: tuple[Array, ...], index: tuple[int, ...]) -> str:
    """Return a place in words."""
    shape = points[0].shape
    where = location(plane, (shape[0], shape[1]))
    near = f", {field.parts[0].place(points[0], points[1], index)}" if where == "node" else ""
    return f"{where} {index}{near}"


def density_inputs(
    functional: Functional,
    shape: tuple[int, int],
    weight: Weight | None,
    fields: Mapping[str, object] | None,
    target: Target | None,
) -> DensityInputs:
    """Return what a functional is given.

    Args:
        functional: that is given it.
        shape: (ni, nj) of the grid.
        weight: the weight, or None.
        fields: for every declared field a `Field` or its source.
        target: the target, or None.

    Raises:
        GridgenError: if a declared field is missing, or one is given that is not declared.
    """
    if fields is not None and not isinstance(fields, Mapping):
        raise GridgenError(f"fields must map names to values, such as {{'M': (1, 0, 1)}}; came {quoted(fields)}")
    given = dict(fields or {})
    declared = functional.fields
    for name in given:
        if name not in declared:
            known = ", ".join(f"{one} ({kind})" for one, kind in declared.items()) or "none"
            hint = ": give the weight as weight=" if name == WEIGHT_NAME else ""
            raise GridgenError(f"functional {functional.name!r} has no field {quoted(name)}; it declares {known}{hint}")
    missing = [name for name in declared if name not in given]
    if missing:
        name = missing[0]
        raise GridgenError(
            f"functional {functional.name!r} needs values of the field {name} ({declared[name]}): give "
            f"fields={{{name!r}: ...}}"
        )
    made = tuple(components_of(given[name], name, kind) for name, kind in declared.items())
    return DensityInputs(functional, weight, made, target, shape)
