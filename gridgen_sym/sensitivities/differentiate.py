"""Differentiate a result: the adjoint of its grid, and the change of its grid.

At a minimum the gradient of the energy in the nodes that move, G(u; b), vanishes; so they change by du = -H⁻¹ G_b db,
and the derivatives of a number J(u; b) in the data b are J_b - (H⁻ᵗ J_u)ᵗ G_b: one linear system, whatever the number
of data (the adjoint method; M. B. Giles and N. A. Pierce, Flow Turbul. Combust. 65, 2000).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted
from ..solvers.layout.problem import LayoutProblem
from ..solvers.minimum import Minimum
from ..solvers.problem import Problem
from .block import BlockDerivatives
from .data import BlockAdjoint, BlockData, as_planes
from .gradients import Gradients
from .lines import LineData
from .slides import SideDerivatives
from .system import System
from .unknowns import BlockUnknowns, LayoutUnknowns, Unknowns
from .wall_data import WallData


def vjp(result: Any, cotangent: Any) -> Gradients:  # noqa: ANN401
    """Return the gradient of a number that depends on a result's grid; see `Result.vjp`."""
    setting = Setting(result)
    cotangents, many = setting.fields(cotangent)
    adjoints = [setting.adjoint(one) for one in cotangents]
    return Gradients(setting.names, setting.data, adjoints, many, setting.lines)


def jvp(result: Any, **tangents: Any) -> Any:  # noqa: ANN401
    """Return how a result's grid changes with what it was made of; see `Result.jvp`."""
    if not tangents:
        raise GridgenError("give what the grid should change with, such as boundary= or parameters=")
    setting = Setting(result)
    moved = [np.stack(tuple(part), axis=-1) for part in setting.along(tangents)]
    return moved[0] if setting.names is None else dict(zip(setting.names, moved, strict=True))


class Setting:
    """A result's grid, the system of its derivatives, and its data.

    Attributes:
        names: of several blocks; None for one.
        data: of every block.
        lines: of several blocks, along which nodes slide, or None.
        system: in the nodes that move.
    """

    def __init__(self, result: Any) -> None:  # noqa: ANN401
        """Set up the system.

        Raises:
            GridgenError: for a result that is no converged minimum, or whose Hessian is singular.
        """
        minimum = _checked(result)
        problem = minimum.problem()
        self.names: Sequence[str] | None = None
        if isinstance(problem, LayoutProblem):
            self.names = result.grid.names
            grids, problems, held = result.grid.blocks, problem.blocks, problem.held
            problem.follow(problem.exchange.join([grid.planes for grid in grids]))
        else:
            assert isinstance(problem, Problem)
            grids, problems, held = (result.grid,), (problem,), (problem.held,)
        blocks = [
            BlockDerivatives(one, minimum.functional, minimum.parameters, np.array(grid.planes, order="C"))
            for one, grid in zip(problems, grids, strict=True)
        ]
        targets = [_of_block(minimum.target, number, self.names) for number in range(len(blocks))]
        starts = result.grid.blocks if self.names else (minimum.start,)
        self.data = [
            BlockData(block, mask, target, self._walls(minimum, number), _sides(minimum, block, start.planes))
            for number, (block, mask, target, start) in enumerate(zip(blocks, held, targets, starts, strict=True))
        ]
        self.lines: LineData | None = None
        if isinstance(problem, LayoutProblem) and problem.slide is not None:
            gradient = problem.exchange.join([block.gradient() for block in blocks])
            self.lines = LineData(problem.slide, minimum.slide, minimum.start, problem.exchange, gradient)
        self.system = System(_unknowns(problem, blocks), minimum.tolerance)

    def _walls(self, minimum: Minimum[Any], number: int) -> WallData | None:
        """Return the walls of a block."""
        name = "" if self.names is None else self.names[number]
        if minimum.walls is None or name not in minimum.walls:
            return None
        start = minimum.start if self.names is None else minimum.start.blocks[number]
        return WallData(*minimum.walls[name], start.planes)

    @property
    def unknowns(self) -> Unknowns:
        """The nodes that move."""
        return self.system.unknowns

    def fields(self, given: Any) -> tuple[list[list[Array]], bool]:  # noqa: ANN401
        """Return cotangents as planes (2, ni, nj) for every block, of one number or of several, and which.

        Raises:
            GridgenError: for other shapes.
        """
        if self.names is None:
            given = [given]
        elif isinstance(given, Mapping):
            if set(given) != set(self.names):
                raise GridgenError(
                    f"a cotangent needs one array for each of {', '.join(self.names)}; came {quoted(given)}"
                )
            given = [given[name] for name in self.names]
        elif not isinstance(given, Sequence):
            raise GridgenError(
                f"a cotangent is given for every block, by name or in the order {', '.join(self.names)}; came "
                f"{quoted(given)}"
            )
        arrays = [real_array(one, "a cotangent") for one in given]
        shapes = [block.shape for block in self.unknowns.blocks]
        wanted, came = [(*shape, 2) for shape in shapes], [array.shape for array in arrays]
        many = bool(came) and all(shape[1:] == one for shape, one in zip(came, wanted, strict=False))
        if (
            len(came) != len(wanted)
            or not (many or came == wanted)
            or len({len(array) for array in arrays if many}) > 1
        ):
            raise GridgenError(
                f"a cotangent has the shape of the nodes, {_shown(wanted)}, or of several numbers one axis before; "
                f"came {_shown(came)}"
            )
        stacked = [np.moveaxis(array if many else array[None], -1, 1) for array in arrays]
        return [[np.ascontiguousarray(one[k]) for one in stacked] for k in range(len(stacked[0]))], many

    def adjoint(self, cotangent: Sequence[Array]) -> list[BlockAdjoint]:
        """Return the adjoint of one number on every block."""
        unknowns = self.unknowns
        field = self.system.solve(unknowns.collect(unknowns.join(cotangent)), transposed=True)
        return [
            BlockAdjoint(block, given - block.transposed(part), part.copy())
            for block, given, part in zip(unknowns.blocks, cotangent, unknowns.views(field), strict=True)
        ]

    def along(self, tangents: Mapping[str, Any]) -> list[Array]:
        """Return how the nodes of every block move along changes of data, (2, ni, nj)."""
        unknowns, nodes, residuals = self.unknowns, [], []
        moved, rest = self._along_lines(tangents)
        if self.lines is not None:
            tangents = {name: one for name, one in tangents.items() if name != "slide"}
        for number, (block, data) in enumerate(zip(unknowns.blocks, self.data, strict=True)):
            change = data.change({name: _of_block(one, number, self.names) for name, one in tangents.items()})
            change.nodes += unknowns.views(moved)[number]
            nodes.append(change.nodes)
            along = block.mixed_along(change.planes, change.parameters)
            residuals.append(block.product(change.nodes) + along + change.residual)
        moved = unknowns.join(nodes)
        moved -= self.system.solve(unknowns.collect(unknowns.join(residuals) + rest), transposed=False)
        return [part.copy() for part in unknowns.views(moved)]

    def _along_lines(self, tangents: Mapping[str, Any]) -> tuple[Array, Array]:
        """Return how the nodes of several blocks move with their curves, and what their equations change by."""
        blocks = self.unknowns.blocks
        if self.lines is None or self.names is None:
            zero = np.zeros(sum(block.coordinates.size for block in blocks))
            return zero, zero
        boundary = None
        if "boundary" in tangents:
            given = [_of_block(tangents["boundary"], number, self.names) for number in range(len(blocks))]
            what = "the change of the boundary"
            boundary = [as_planes(one, block.shape, what) for one, block in zip(given, blocks, strict=True)]
        return self.lines.change(boundary, dict(tangents.get("slide", {})))


def _unknowns(problem: Problem | LayoutProblem, blocks: list[BlockDerivatives]) -> Unknowns:
    return LayoutUnknowns(problem, blocks) if isinstance(problem, LayoutProblem) else BlockUnknowns(blocks[0])


def _sides(minimum: Minimum[Any], block: BlockDerivatives, start: Array) -> dict[str, SideDerivatives]:
    """Return the sliding sides of a block, by name."""
    slide, given = block.problem.slide, minimum.slide
    if slide is None:
        return {}
    gradient, curves = block.gradient(), given if isinstance(given, Mapping) else {}
    return {
        side.name: SideDerivatives(side, curves.get(side.name), start[:, *side.index].T, gradient)
        for side in slide.sides
    }


def _checked(result: Any) -> Minimum[Any]:  # noqa: ANN401
    """Return what a result is the minimum of.

    Raises:
        GridgenError: where it is none.
    """
    minimum = result.minimum
    if not isinstance(minimum, Minimum):
        raise GridgenError(
            "only what optimize returns can be differentiated: this result is no minimum of an energy, or it comes "
            "from a pickle; optimize its grid again"
        )
    if minimum.objection:
        raise GridgenError(minimum.objection)
    if not result.converged:
        raise GridgenError(
            f"a grid that has not converged has no derivatives: {result.message} Allow more steps (max_iterations, "
            "time_limit), or another start"
        )
    return minimum


def _of_block(given: Any, number: int, names: Sequence[str] | None) -> Any:  # noqa: ANN401
    """Return what is given for a block: of a mapping from the names of blocks its entry, else all of it."""
    if names is None or not isinstance(given, Mapping) or not set(given) <= set(names):
        return given
    return given.get(names[number])


def _shown(shapes: Sequence[tuple[int, ...]]) -> str:
    return str(shapes[0]) if len(shapes) == 1 else str(list(shapes))
