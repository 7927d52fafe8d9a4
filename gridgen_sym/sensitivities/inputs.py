"""Derivatives in what a density is given: the weight, declared fields and a target; and its changes with these."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..fields.components import Components
from ..fields.inputs import DensityInputs
from ..fields.scalar import ScalarField
from ..functionals.field_kinds import PHYSICAL_SUFFIXES
from ..functionals.metric import WEIGHT_NAME
from ..runtime import Values
from .corners import at_corners
from .scalars import SLOPES, Points, along_scalar, in_scalar
from .targets import Steps, derivative_in_target, inverse_along, inverse_at_corners

#: What a derivative in the values of a plane belongs to: the plane, and the planes of its derivatives in x and y.
_KEYS = dict(zip(SLOPES, PHYSICAL_SUFFIXES[:2], strict=True))


class InputDerivatives:
    """What a density is given on one block, and how it depends on what the user gave.

    Attributes:
        inputs: all of it.
        names: of the planes of the kernels.
    """

    def __init__(
        self, inputs: DensityInputs, names: tuple[str, ...], values: Values, place: Array, steps: Steps
    ) -> None:
        """Take the values at coordinates (2, ni, nj), in a kernel's order, and the logical steps."""
        self.inputs, self.names, self._values, self._steps = inputs, names, values, steps
        logical = np.meshgrid(*(np.linspace(0, 1, count) for count in place.shape[1:]), indexing="ij")
        self._points: dict[str, Points] = {"physical": (place[0], place[1]), "logical": (logical[0], logical[1])}

    # ---- derivatives ----

    def in_weight(self, planes: Mapping[str, Array]) -> Array | None:
        """Return the derivatives in the weight, from those in planes at the corners; None without one."""
        weight = self.inputs.weight
        if weight is None:
            return None
        return in_scalar(weight.field, self._points["physical"], self._at(planes, WEIGHT_NAME, weight.mode))

    def in_field(self, planes: Mapping[str, Array], name: str) -> Any:  # noqa: ANN401
        """Return the derivatives in a declared field: an array, its components first; a tuple where shapes differ."""
        components = self._components(name)
        points = self._points[components.domain]
        found = [
            in_scalar(part, points, self._at(planes, own, components.mode))
            for own, part in zip(components.names, components.parts, strict=True)
        ]
        return _joined(found)

    def in_matrix(self, planes: Mapping[str, Array]) -> list[Array]:
        """Return the derivatives in the entries of the target W at the corners, row by row."""
        inverse = inverse_at_corners(self._values, self.names)
        return derivative_in_target(inverse, planes, self._steps)

    def in_target(self, planes: Mapping[str, Array]) -> Any:  # noqa: ANN401
        """Return the derivatives in the parts of the target: w1, w2 and angle, or a matrix; None without one."""
        target = self.inputs.target
        if target is None:
            return None
        entries = self.in_matrix(planes)
        if len(target.parts) != len(entries):
            _, w2, angle = self._lengths()
            turn, degree = np.deg2rad(angle), np.deg2rad(1.0)
            entries = [
                entries[0],
                np.cos(turn) * entries[1] + np.sin(turn) * entries[3],
                degree * w2 * (np.cos(turn) * entries[3] - np.sin(turn) * entries[1]),
            ]
        points = self._points[target.domain]
        return _joined([in_scalar(part, points, {"": one}) for part, one in zip(target.parts, entries, strict=True)])

    def _at(self, planes: Mapping[str, Array], name: str, mode: str) -> dict[str, Array]:
        found = {"": planes[name]}
        if mode == "differentiated":
            found |= {key: planes[name + suffix] for key, suffix in _KEYS.items()}
        return found

    # ---- changes ----

    def along_weight(self, change: Any) -> dict[str, Array]:  # noqa: ANN401
        """Return the changes of planes at the corners with the weight."""
        weight = self.inputs.weight
        if weight is None:
            raise GridgenError("there is no weight along which the grid could change: give weight= to optimize")
        source = getattr(change, "source", change)
        return self._along(weight.field, "physical", weight.mode, WEIGHT_NAME, source)

    def along_field(self, name: str, change: Any) -> dict[str, Array]:  # noqa: ANN401
        """Return the changes of planes at the corners with a declared field."""
        components = self._components(name)
        parts = _split(getattr(change, "source", change), len(components.parts), f"the field {name}")
        found: dict[str, Array] = {}
        for own, part, one in zip(components.names, components.parts, parts, strict=True):
            found |= self._along(part, components.domain, components.mode, own, one)
        return found

    def along_matrix(self, change: list[Array]) -> dict[str, Array]:
        """Return the changes of the inverse target at the corners with the entries of W there."""
        return inverse_along(inverse_at_corners(self._values, self.names), change, self._steps)

    def along_target(self, change: Any) -> dict[str, Array]:  # noqa: ANN401
        """Return the changes of the inverse target at the corners with the parts of the target."""
        target = self.inputs.target
        if target is None:
            raise GridgenError("there is no target along which the grid could change: give target= to optimize")
        points = self._points[target.domain]
        parts = _split(change, len(target.parts), "the target")
        entries = [along_scalar(part, points, one, ("",))[""] for part, one in zip(target.parts, parts, strict=True)]
        if len(entries) == 3:
            (d1, d2, turned), (_, w2, angle) = entries, self._lengths()
            turn, turned = np.deg2rad(angle), np.deg2rad(turned)
            cosine, sine = np.cos(turn), np.sin(turn)
            entries = [
                d1,
                cosine * d2 - sine * w2 * turned,
                np.zeros_like(d1),
                sine * d2 + cosine * w2 * turned,
            ]
        return self.along_matrix(entries)

    def _along(self, part: ScalarField, domain: str, mode: str, name: str, change: Any) -> dict[str, Array]:  # noqa: ANN401
        keys = ("", *SLOPES) if mode == "differentiated" else ("",)
        found = along_scalar(part, self._points[domain], change, keys)
        return {name + (_KEYS[key] if key else ""): one for key, one in found.items()}

    def _lengths(self) -> list[Array]:
        """Return w1, w2 and the angle in degrees of the target at the corners."""
        target = self.inputs.target
        assert target is not None
        points = self._points[target.domain]
        shape = points[0].shape[0], points[0].shape[1]
        return [at_corners(part.plane(*points), shape) for part in target.parts]

    def _components(self, name: str) -> Components:
        for components in self.inputs.fields:
            if components.name == name:
                return components
        known = ", ".join(one.name for one in self.inputs.fields) or "none"
        raise GridgenError(f"the functional has no field {quoted(name)}; it declares {known}")


def _joined(parts: list[Array]) -> Any:  # noqa: ANN401
    """Return parts as one array, where they have one shape; one part alone as it is."""
    if len(parts) == 1:
        return parts[0]
    return np.stack(parts) if len({part.shape for part in parts}) == 1 else tuple(parts)


def _split(change: Any, count: int, what: str) -> list[Any]:  # noqa: ANN401
    """Return the changes of the parts of a field or target."""
    if count == 1:
        return [change]
    if not isinstance(change, (tuple, list, np.ndarray)) or len(change) != count:
        raise GridgenError(f"the change of {what} needs {count} parts, one for each; came {quoted(change)}")
    return list(change)
