"""All that a density is given beside the metric: the weight, the place, declared fields and a target, on a grid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError, UnusableValueError, quoted
from ..functionals.definition import Functional
from ..functionals.field_kinds import PHYSICAL_SUFFIXES
from ..functionals.metric import INVERSE_TARGET_NAMES, LOGICAL_NAMES, POSITION_NAMES, WEIGHT_NAME
from ..functionals.variant import Modes, Variant
from .allowed import FieldValues, check_constraints
from .components import Components, components_of
from .restriction import restricted
from .scalar import ScalarField
from .target import Target
from .weight import Weight


@dataclass(frozen=True, slots=True, eq=False)
class DensityInputs:
    """What a functional is given beside the metric.

    Attributes:
        functional: that is given it.
        parameters: values of its parameters.
        weight: the weight, or None.
        fields: the components of all declared fields.
        target: the target, or None.
        shape: (ni, nj) of the grid that arrays belong to; on coarser grids of the same logical square they are
            interpolated.
    """

    functional: Functional
    parameters: Mapping[str, float]
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
        target = self.target is not None and self.target.lags
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
        found |= zip(POSITION_NAMES, coordinates, strict=True)
        if LOGICAL_NAMES[0] in names:
            found |= zip(LOGICAL_NAMES, _logical(coordinates.shape), strict=True)
        given = [self._values(field, coordinates) for field in self.fields]
        check_constraints(self.functional, self.parameters, given)
        for values in given:
            found |= _named(values, names)
        if self.target is not None:
            found |= zip(INVERSE_TARGET_NAMES, self._inverse_target(self.target, coordinates, steps), strict=True)
        return [np.ascontiguousarray(found[name]) for name in names]

    def _values(self, field: Components, coordinates: Array) -> FieldValues:
        """Return the values of a field, checked."""
        points = _points(field.domain, coordinates)
        values = FieldValues(field, [_plane(part, points, self.shape) for part in field.parts], points)
        values.check()
        return values

    def _inverse_target(
        self, target: Target, coordinates: Array, steps: tuple[float, float]
    ) -> tuple[Array, Array, Array, Array]:
        """Return V = W⁻¹ for edges that are divided by `steps`.

        W is that of edges with steps of 1 on the grid that it was given for; on a coarser one, cells and W are larger.
        """
        shape, home = coordinates.shape[1:], target.shape or self.shape
        points = _points(target.domain, coordinates)
        first, second, third, fourth = target.inverse(lambda part: _plane(part, points, home), (shape[0], shape[1]))
        along_xi, along_eta = (step * (now - 1) / (old - 1) for step, now, old in zip(steps, shape, home, strict=True))
        return first * along_xi, second * along_xi, third * along_eta, fourth * along_eta

    def exists(self, coordinates: Array, names: tuple[str, ...]) -> bool:
        """Return whether everything can be evaluated on a grid."""
        try:
            self.planes(coordinates, names)
        except UnusableValueError:
            return False
        return True

    def check_samples(self, coordinates: Array, among: npt.NDArray[np.bool_] | None = None) -> None:
        """Refuse nodes outside the samples of the weight, a field or the target.

        Args:
            coordinates: (2, ni, nj).
            among: which nodes must lie in the samples; by default all.

        Raises:
            UnusableValueError: naming the field, the node and the repair.
        """
        if self.weight is not None:
            self.weight.check_samples(coordinates, among)
        given = [(field.domain, field.parts) for field in self.fields]
        if self.target is not None:
            given.append((self.target.domain, self.target.parts))
        for domain, parts in given:
            for part in parts:
                if part.ends:
                    part.check_samples(*_points(domain, coordinates), among=among)

    def remarks(self, coordinates: Array) -> str:
        """Return a remark on nodes where the nearest sample of a field counts, with a leading blank, or nothing."""
        said = ""
        for field in self.fields:
            points = _points(field.domain, coordinates)
            outside = max(part.outside(*points) for part in field.parts)
            if outside:
                said += (
                    f" {outside} of {coordinates[0].size} nodes lie outside the samples of the field {field.name}: the "
                    "nearest sample counts there."
                )
        return said


def _plane(part: ScalarField, points: tuple[Array, Array], home: tuple[int, int]) -> Array:
    """Return a part on a grid: arrays of a finer one, of the shape `home`, are interpolated to it."""
    if part.numbers is not None and points[0].shape != home:
        return restricted(part.plane(*_logical((2, *home))), home, points[0].shape)
    return part.plane(points[0], points[1])


def _points(domain: str, coordinates: Array) -> tuple[Array, Array]:
    """Return the coordinates of the nodes that functions of a domain are given."""
    return (coordinates[0], coordinates[1]) if domain == "physical" else _logical(coordinates.shape)


def _logical(shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Return xi and eta at the nodes of a grid whose coordinates have the shape (2, ni, nj)."""
    xi, eta = np.meshgrid(*(np.linspace(0, 1, count) for count in shape[1:]), indexing="ij")
    return xi, eta


def _named(values: FieldValues, names: tuple[str, ...]) -> Iterator[tuple[str, Array]]:
    """Yield the components of a field, and their derivatives among the names, with their names."""
    for name, part, plane in zip(values.field.names, values.field.parts, values.planes, strict=True):
        yield name, plane
        along = tuple(suffix[1:] for suffix in PHYSICAL_SUFFIXES if name + suffix in names)
        if along:
            derivatives = part.derivatives(*values.points, along)
            yield from zip((f"{name}_{key}" for key in along), derivatives, strict=True)


def density_inputs(
    functional: Functional,
    shape: tuple[int, int],
    *,
    parameters: Mapping[str, float] | None = None,
    weight: Weight | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | None = None,
) -> DensityInputs:
    """Return what a functional is given.

    Args:
        functional: that is given it.
        shape: (ni, nj) of the grid.
        parameters: of the functional, where they are not the defaults.
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
    return DensityInputs(functional, functional.values(parameters), weight, made, target, shape)
