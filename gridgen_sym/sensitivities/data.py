"""What the grid of one block was made of: derivatives in it, and changes of the minimum's equations with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, Mask, real_array
from ..errors import GridgenError, quoted
from ..grids import Grid
from ..grids.grid import corner_edges
from .block import BlockDerivatives
from .corners import COUNTER_CLOCKWISE
from .edges import corner_edges_transposed
from .inputs import InputDerivatives
from .slides import SideDerivatives
from .wall_data import WallData, WallGradient


@dataclass(eq=False)
class BlockAdjoint:
    """What one number's derivatives in a block's grid come to, once the nodes that move are eliminated.

    Attributes:
        block: the derivatives of its energy.
        nodes: (2, ni, nj), the derivatives in the nodes, as if those that move were moved by hand.
        field: (2, ni, nj), the solution of the adjoint system.
    """

    block: BlockDerivatives
    nodes: Array
    field: Array

    @cached_property
    def mixed(self) -> tuple[dict[str, Array], dict[str, Array]]:
        """The derivatives in planes and parameters, at the corners."""
        planes, parameters = self.block.mixed(self.field)
        return {name: -one for name, one in planes.items()}, {name: -one for name, one in parameters.items()}


@dataclass(eq=False)
class Change:
    """How data change the equations of a block's minimum, per unit of their change.

    Attributes:
        nodes: (2, ni, nj), of nodes that do not move by themselves, and of the curves under those that slide.
        residual: (2, ni, nj), of the equations of nodes that slide, by the slope of their curves.
        planes: of what the density is given, at the corners.
        parameters: of the functional.
    """

    nodes: Array
    residual: Array
    planes: dict[str, Array] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)

    def add(self, planes: Mapping[str, Array]) -> None:
        """Add changes of planes."""
        for name, change in planes.items():
            self.planes[name] = self.planes[name] + change if name in self.planes else change


@dataclass(eq=False)
class BlockData:
    """The data of one block.

    Attributes:
        block: the derivatives of its energy.
        held: the mask of nodes that neither move nor slide.
        target: as it was given.
        walls: that were given.
        sides: those that slide, by name.
    """

    block: BlockDerivatives
    held: Mask
    target: object = None
    walls: WallData | None = None
    sides: Mapping[str, SideDerivatives] = field(default_factory=dict)
    _of_walls: dict[BlockAdjoint, tuple[dict[str, WallGradient], Array]] = field(default_factory=dict)

    @cached_property
    def inputs(self) -> InputDerivatives:
        """What the density is given, and what that was made of."""
        problem = self.block.problem
        values = problem.values(self.block.coordinates)
        if problem.inputs is None or values is None:
            raise GridgenError("the density is given nothing beside the metric: there is no weight, field or target")
        place = self.block.coordinates
        return InputDerivatives(problem.inputs, problem.kernels.planes, values, place, problem.steps)

    # ---- derivatives ----

    def in_boundary(self, adjoint: BlockAdjoint) -> Array:
        """Return the derivatives in the start's nodes that stay, and that curves go through, (ni, nj, 2)."""
        found = np.where(self.held != 0, adjoint.nodes, 0.0)
        for one in self.sides.values():
            i, j = one.side.index
            found[:, i[one.moved], j[one.moved]] = 0.0
        for one in self.sides.values():
            if one.own:
                found[:, *one.side.index] += one.derivative(adjoint.nodes, adjoint.field).T
        if self.walls is not None:
            found += self._in_walls(adjoint)[1]
        return np.stack(tuple(found), axis=-1)

    def in_walls(self, adjoint: BlockAdjoint) -> dict[str, WallGradient]:
        """Return the derivatives in the walls, by side."""
        return {} if self.walls is None else self._in_walls(adjoint)[0]

    def _in_walls(self, adjoint: BlockAdjoint) -> tuple[dict[str, WallGradient], Array]:
        assert self.walls is not None
        if adjoint not in self._of_walls:
            self._of_walls[adjoint] = self.walls.derivatives(self._in_matrix(adjoint))
        return self._of_walls[adjoint]

    def _in_matrix(self, adjoint: BlockAdjoint) -> list[Array]:
        """Return the derivatives in the entries of the target W, row by row, corners counter-clockwise."""
        return [entry[list(COUNTER_CLOCKWISE)] for entry in self.inputs.in_matrix(adjoint.mixed[0])]

    def in_slide(self, adjoint: BlockAdjoint) -> dict[str, Any]:
        """Return the derivatives in the curves that were given of sliding sides, by side."""
        given = {name: one for name, one in self.sides.items() if not one.own}
        return {name: one.derivative(adjoint.nodes, adjoint.field) for name, one in given.items()}

    def in_parameters(self, adjoint: BlockAdjoint) -> dict[str, float]:
        """Return the derivatives in the parameters of the functional."""
        return {name: float(corners.sum()) for name, corners in adjoint.mixed[1].items()}

    def in_weight(self, adjoint: BlockAdjoint) -> Array | None:
        """Return the derivatives in the weight; None without one."""
        given = self.block.problem.inputs
        return None if given is None or given.weight is None else self.inputs.in_weight(adjoint.mixed[0])

    def in_fields(self, adjoint: BlockAdjoint) -> dict[str, Any]:
        """Return the derivatives in the declared fields, by name."""
        given = self.block.problem.inputs
        names = [] if given is None else [components.name for components in given.fields]
        return {name: self.inputs.in_field(adjoint.mixed[0], name) for name in names}

    def in_target(self, adjoint: BlockAdjoint) -> Any:  # noqa: ANN401
        """Return the derivatives in the target as it was given: of a reference grid in its nodes, (ni, nj, 2)."""
        if self.target is None:
            return None
        if not isinstance(self.target, Grid):
            return self.inputs.in_target(adjoint.mixed[0])
        return np.stack(tuple(corner_edges_transposed(self._in_matrix(adjoint))), axis=-1)

    # ---- changes ----

    def change(self, tangents: Mapping[str, Any]) -> Change:
        """Return how the equations of the minimum change along tangents.

        Raises:
            GridgenError: for a tangent of what the grid was not made of, or of another shape.
        """
        found = Change(np.zeros_like(self.block.coordinates), np.zeros_like(self.block.coordinates))
        for name, tangent in tangents.items():
            along = {
                "boundary": self._along_boundary,
                "parameters": self._along_parameters,
                "weight": lambda change, tangent: change.add(self.inputs.along_weight(tangent)),
                "fields": self._along_fields,
                "target": self._along_target,
                "walls": self._along_walls,
                "slide": self._along_slide,
            }.get(name)
            if along is None:
                raise GridgenError(
                    f"unknown data {quoted(name)}: a grid changes with boundary, parameters, weight, fields, target, "
                    "walls and slide"
                )
            along(found, tangent)
        return found

    def _along_boundary(self, change: Change, tangent: Any) -> None:  # noqa: ANN401
        moved = as_planes(tangent, self.block.shape, "the change of the boundary")
        stays = self.held != 0
        for one in self.sides.values():
            i, j = one.side.index
            stays[i[one.moved], j[one.moved]] = False
        change.nodes += np.where(stays, moved, 0.0)
        for one in self.sides.values():
            if one.own:
                self._add_side(change, one, moved[:, *one.side.index].T)
        if self.walls is not None:
            self._add_matrix(change, self.walls.along({}, moved))

    def _along_walls(self, change: Change, tangent: Any) -> None:  # noqa: ANN401
        if self.walls is None:
            raise GridgenError("there are no walls along which the grid could change: give walls= to optimize")
        self._add_matrix(change, self.walls.along(dict(tangent), np.zeros_like(self.block.coordinates)))

    def _add_matrix(self, change: Change, entries: list[Array]) -> None:
        change.add(self.inputs.along_matrix([entry[list(COUNTER_CLOCKWISE)] for entry in entries]))

    def _along_slide(self, change: Change, tangent: Any) -> None:  # noqa: ANN401
        for name, one in dict(tangent).items():
            side = self.sides.get(name)
            if side is None or side.own:
                raise GridgenError(
                    f"no curve was given of a sliding side {quoted(name)}: where nodes slide along the curve of their "
                    "own side, the change is one of the boundary"
                )
            self._add_side(change, side, one)

    def _add_side(self, change: Change, one: SideDerivatives, tangent: Any) -> None:  # noqa: ANN401
        nodes, residual = one.change(tangent)
        change.nodes[:, *one.side.index] += nodes
        change.residual[:, *one.side.index] += residual

    def _along_parameters(self, change: Change, tangent: Any) -> None:  # noqa: ANN401
        known = self.block.functional.parameters
        for name, number in dict(tangent).items():
            if name not in known:
                raise GridgenError(f"unknown parameter {quoted(name)}; the functional has {', '.join(known) or 'none'}")
            change.parameters[name] = float(number)

    def _along_fields(self, change: Change, tangent: Any) -> None:  # noqa: ANN401
        for name, one in dict(tangent).items():
            change.add(self.inputs.along_field(name, one))

    def _along_target(self, change: Change, tangent: Any) -> None:  # noqa: ANN401
        if not isinstance(self.target, Grid):
            change.add(self.inputs.along_target(tangent))
            return
        moved = as_planes(tangent, self.block.shape, "the change of the reference grid")
        self._add_matrix(change, list(corner_edges(moved[0], moved[1])))


def as_planes(given: Any, shape: tuple[int, int], what: str) -> Array:  # noqa: ANN401
    """Return vectors at the nodes, (ni, nj, 2), as planes (2, ni, nj).

    Raises:
        GridgenError: for another shape.
    """
    array = real_array(given, what)
    if array.shape != (*shape, 2):
        raise GridgenError(f"{what} must have the shape {(*shape, 2)}, x and y last; came {array.shape}")
    return np.ascontiguousarray(np.moveaxis(array, -1, 0))
