"""What the values of declared fields must meet: a size, positive definiteness, the functional's constraints."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import UnusableValueError
from ..functionals.definition import Functional
from ..functionals.expression import comparisons, names_in
from .components import Components
from .field import VARIABLES
from .locations import at_one_location, first_index, first_place

#: Beyond this size the products of values overflow.
_LARGEST = 1e100
_HOLDS: Mapping[str, Callable[..., Any]] = {
    ">": np.greater,
    ">=": np.greater_equal,
    "<": np.less,
    "<=": np.less_equal,
    "==": np.isclose,
}


@dataclass(frozen=True, slots=True)
class FieldValues:
    """The values of one field on a grid.

    Attributes:
        field: whose values they are.
        planes: of the components, each per node, cell or corner.
        points: the coordinates of the nodes that it is a function of.
    """

    field: Components
    planes: list[Array]
    points: tuple[Array, Array]

    @property
    def shape(self) -> tuple[int, int]:
        """The shape (ni, nj) of the grid."""
        return self.points[0].shape[0], self.points[0].shape[1]

    def check(self) -> None:
        """Refuse values that the kind of the field does not allow.

        Raises:
            UnusableValueError: naming the field, the place, the values and the repair.
        """
        for part, plane in zip(self.field.parts, self.planes, strict=True):
            large = ~(np.abs(plane) <= _LARGEST)
            if large.any():
                raise UnusableValueError(
                    f"{part.name} is {plane[first_index(large)]:.3g} at {self.place(large)}, and its square overflows: "
                    f"divide it by a constant (at most {_LARGEST:g} is allowed)"
                )
        if self.field.kind == "symmetric":
            first, mixed, second = together = at_one_location(self.planes, self.shape)
            bad = ~((first > 0) & (first * second > mixed**2))
            if bad.any():
                values = _listed(dict(zip(self.field.names, together, strict=True)), bad)
                raise UnusableValueError(
                    f"the field {self.field.name} must be positive definite; it is not at {self.place(bad)}, where "
                    f"{values}: its eigenvalues must be positive, so add a multiple of the identity or limit "
                    f"{self.field.names[1]}"
                )

    def place(self, bad: npt.NDArray[np.bool_]) -> str:
        """Return the place of the first true entry of a plane in words."""
        return first_place(bad, self.shape, self.points, VARIABLES[self.field.domain])


def check_constraints(functional: Functional, parameters: Mapping[str, float], given: Sequence[FieldValues]) -> None:
    """Refuse values that do not meet the constraints of a functional on its fields.

    Raises:
        UnusableValueError: naming the constraint, the place, the values and the repair.
    """
    for constraint in functional.constraints:
        words = names_in(constraint)
        named = [values for values in given if words & {*values.field.names}]
        if named:
            _check_constraint(constraint, functional, parameters, named)


def _check_constraint(
    constraint: str, functional: Functional, parameters: Mapping[str, float], named: Sequence[FieldValues]
) -> None:
    names = [name for values in named for name in values.field.names]
    planes = at_one_location([plane for values in named for plane in values.planes], named[0].shape)
    components = dict(zip(names, planes, strict=True))
    for one in comparisons(constraint, {**parameters, **components}):
        bad = ~np.broadcast_to(_HOLDS[one.sign](one.left, one.right), planes[0].shape)
        if bad.any():
            fields = " or ".join(values.field.name for values in named)
            raise UnusableValueError(
                f"functional {functional.name!r} needs {constraint}; at {named[0].place(bad)} came "
                f"{_listed(components, bad)}: change the field {fields} there"
            )


def _listed(components: Mapping[str, Array], bad: npt.NDArray[np.bool_]) -> str:
    """Return the values of components at the first true entry of a plane."""
    index = first_index(bad)
    return ", ".join(f"{name} = {plane[index]:.6g}" for name, plane in components.items())
