"""Solve the Euler–Lagrange equations of a functional on a grid of several blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy.typing as npt

from ....boundary.sides import Sides
from ....boundary.wall import Wall
from ....errors import GridgenError, quoted
from ....fields.target import Target
from ....fields.weight import Source, Weight
from ....functionals.definition import Functional
from ....functionals.registry import functional as find_functional
from ....grids import Grid
from ....topology import MultiBlock
from ....topology.merging import merge
from ...layout.binding import logical_rectangles, make_layout_problem
from ...layout.merged import is_one_grid, names_place, of_all_blocks
from ...layout.nested import NestedLayouts
from ...layout.problem import LayoutProblem
from ...layout.result import LayoutResult
from ...layout.run import REGULARIZED, LayoutRun, begin_run
from ...layout.untangle import NO_PROGRESS, untangle_blocks
from ...layout.walls import LayoutWalls, minimize_with_walls, walled_start, walls_or_target
from ...logical import Spacing
from ...newton.minimize import minimize
from ...run.checks import check_controls
from ...run.deadline import Deadline
from ...run.progress import Callback, Progress
from ...run.result import Result
from ...run.status import Outcome, Status
from ...run.stopping import run_to_result
from ..choice import choose_grid
from ..newton import solve_by_newton
from ..relaxation import solve_by_relaxation
from .system import LayoutEquations

#: Default numbers of Newton steps and of sweeps.
_LIMITS = {"newton": 200, "relaxation": 100_000}
#: How near to the minimum of the energy a start is brought, and in how many steps at most.
_NEAR, _STEPS_NEAR = 1e-2, 50


def solve_layout_euler_lagrange(
    grid: MultiBlock,
    functional: str | Functional,
    method: str = "newton",
    *,
    weight: Weight | Source | Mapping[str, object] | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | MultiBlock | Mapping[str, object] | None = None,
    walls: LayoutWalls | None = None,
    fixed: Mapping[str, npt.ArrayLike] | None = None,
    parameters: Mapping[str, float] | None = None,
    tolerance: float = 1e-8,
    max_iterations: int | None = None,
    relaxation: float | None = None,
    spacing: Spacing = "unit",
    keep_valid: bool = True,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
    of_one_block: Callable[..., Result] | None = None,
) -> LayoutResult:
    """Solve the Euler–Lagrange equations on several blocks; see `gridgen_sym.solve_euler_lagrange`.

    Connected nodes where four cells meet have the central differences of inner ones, across the connection. Where
    three, five or more cells meet there are no logical coordinates: such a node makes the discrete energy of its cells
    stationary. The message of the result counts these nodes. Blocks that make up a plain grid are solved by
    `of_one_block`, where nothing is given for blocks.

    Raises:
        GridgenError: for input that cannot be used.
    """
    check_controls(tolerance, max_iterations, callback, time_limit)
    definition = find_functional(functional)
    given: dict[str, Any] = {
        "parameters": parameters,
        "tolerance": tolerance,
        "max_iterations": max_iterations,
        "relaxation": relaxation,
        "spacing": spacing,
        "keep_valid": keep_valid,
        "callback": callback,
        "time_limit": time_limit,
        "progress": progress,
        "backend": backend,
    }
    alike = weight is None and not fields and target is None and walls is None and fixed is None
    alike = alike and spacing in ("unit", "index")
    if alike and of_one_block is not None and not names_place(grid, definition, parameters, backend):
        merged = merge(grid)
        if is_one_grid(merged.layout):
            block = merged.layout.blocks[0]
            return of_all_blocks(partial(of_one_block, block, definition, method, **given), grid, merged)
    if method not in ("newton", "relaxation"):
        raise GridgenError(f"unknown method {quoted(method)}: solve_euler_lagrange takes 'newton' or 'relaxation'")
    asked, target = walls_or_target(grid, walls, target)
    home, rectangles = [block.shape for block in grid.blocks], logical_rectangles(grid, spacing)

    def make(on: MultiBlock, target: object = target) -> LayoutProblem:
        return make_layout_problem(
            on,
            definition,
            weight=weight,
            fields=fields,
            target=target,
            fixed=fixed if on is grid else None,
            parameters=parameters,
            rectangles=rectangles,
            arrays_of=home,
            backend=backend,
        )

    title = f"Euler–Lagrange equations of {definition.name}, {len(grid)} blocks"
    with Progress(title, callback, progress, Deadline(time_limit)) as report:
        run = begin_run(grid, make(grid), report)
        limit = _LIMITS[method] if max_iterations is None else max_iterations
        sweeps = method == "relaxation"
        way = _Way(run, make, definition, parameters, asked, fixed is None, limit, sweeps, relaxation)
        return run_to_result(lambda: way.solve(tolerance, keep_valid), lambda end: way.result(end, keep_valid), report)


@dataclass(slots=True)
class _Way:
    """The way to a solution: near the minimum of the energy first, as in one block, and then Newton's method.

    Attributes:
        run: on the blocks.
        make: binds the functional to a layout, with a target.
        functional, parameters: what is minimized.
        asked: the walls.
        nests: whether coarse layouts give a start.
        limit: of Newton steps, or sweeps.
        sweeps: whether relaxation solves, which begins with the start as it is.
        relaxation: its factor, if it is given.
        equations: once they are reached.
    """

    run: LayoutRun
    make: Callable[..., LayoutProblem]
    functional: Functional
    parameters: Mapping[str, float] | None
    asked: Mapping[str, Sides[Wall | None]] | None
    nests: bool
    limit: int
    sweeps: bool
    relaxation: float | None
    equations: LayoutEquations | None = None

    def solve(self, tolerance: float, keep_valid: bool) -> Outcome:
        """Solve, and return how it ended."""
        run, barrier = self.run, self.run.problem.kernels.barrier
        near = (barrier and not self.sweeps) or self.asked is not None
        end = self._bring_near() if near and self.limit else None
        if end is not None:
            return end
        run.problem.refresh(run.coordinates)
        self.equations = LayoutEquations(run.problem, run.coordinates)
        run.report.begin("solve", (run.layout.node_count, 1))
        if self.sweeps:
            given = tolerance, self.limit, self.relaxation
            return solve_by_relaxation(self.equations, run.coordinates, run.report, *given)
        return solve_by_newton(self.equations, run.coordinates, run.report, tolerance, self.limit, keep_valid)

    def result(self, outcome: Outcome, keep_valid: bool) -> LayoutResult:
        """Return the result, which reports the nodes without central differences."""
        if self.equations is None:
            return self.run.result(outcome)
        status, message = choose_grid(self.run, self.equations, outcome, keep_valid)
        return self.run.result(Outcome(status, message + _remark(self.equations.others)))

    def _bring_near(self) -> Outcome | None:
        """Bring the grid near the minimum of the energy, which is near the solution; return the end if it is folded."""
        run = self.run
        if self.asked is not None:
            start = walled_start(run.layout, self.asked, run.problem.kernels.backend, run.report)
            run.coordinates = run.problem.exchange.join([block.planes for block in start.blocks])
            minimize_with_walls(run, self.asked, lambda targets: self.make(run.layout, targets), self._minimized)
        else:
            folded = not run.problem.energy(run.coordinates)[1] > 0
            end = run.impossible() if folded else None
            if end is not None:
                return end
            if self.nests:
                nested = NestedLayouts(self.make, self.functional, self.parameters, run.report)
                run.take(nested.start(run.layout, run.problem), folded=folded)
            if not run.problem.energy(run.coordinates)[1] > 0:
                self._minimized()
        folded = run.problem.kernels.barrier and not run.problem.energy(run.coordinates)[1] > 0
        return Outcome(Status.FOLDED, NO_PROGRESS) if folded else None

    def _minimized(self) -> Outcome:
        """Untangle, if necessary, and lower the energy."""
        run = self.run
        if run.problem.kernels.barrier and not run.problem.energy(run.coordinates)[1] > 0:
            run.report.begin("untangle", (run.layout.node_count, 1))
            if not untangle_blocks(run.problem, self.functional, run.coordinates, self.parameters, run.report):
                return Outcome(Status.FOLDED, NO_PROGRESS)
            run.untangled_by = REGULARIZED
        run.report.begin("minimize", (run.layout.node_count, 1))
        return minimize(
            run.problem,
            run.coordinates,
            run.report,
            tolerance=_NEAR,
            max_iterations=_STEPS_NEAR,
            keep_valid=True,
        )


def _remark(others: int) -> str:
    """Return what the result says of nodes without central differences."""
    if not others:
        return ""
    nodes, them = ("1 connected node has", "it") if others == 1 else (f"{others} connected nodes have", "them")
    return (
        f" {nodes} no logical coordinates round {them} that continue through all blocks, as where 3 or 5 cells meet: "
        "there the discrete energy of the cells that meet is stationary."
    )
