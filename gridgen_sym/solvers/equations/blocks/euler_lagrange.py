"""Solve the Euler–Lagrange equations of a functional on a grid of several blocks."""

from __future__ import annotations

from collections.abc import Mapping

import numpy.typing as npt

from ....errors import GridgenError, quoted
from ....fields.target import Target
from ....fields.weight import Source, Weight
from ....functionals.definition import Functional
from ....functionals.registry import functional as find_functional
from ....grids import Grid
from ....topology import MultiBlock
from ...layout.binding import blocks_of, logical_rectangles, make_layout_problem
from ...layout.nested import NestedLayouts
from ...layout.problem import LayoutProblem
from ...layout.result import LayoutResult
from ...layout.run import REGULARIZED, LayoutRun, begin_run
from ...layout.untangle import NO_PROGRESS, untangle_blocks
from ...layout.walls import LayoutWalls, minimize_with_walls, walled_start, walls_of_blocks
from ...logical import Spacing
from ...newton.minimize import minimize
from ...run.checks import check_controls
from ...run.deadline import Deadline
from ...run.progress import Callback, Progress
from ...run.status import Outcome, Status
from ...run.stopping import run_to_result
from ..choice import choose_grid
from ..newton import solve_by_newton
from .system import LayoutEquations

#: Newton steps; how near to the minimum of the energy a start is brought, and in how many steps at most.
_STEPS, _NEAR, _STEPS_NEAR = 200, 1e-2, 50


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
    spacing: Spacing = "unit",
    keep_valid: bool = True,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> LayoutResult:
    """Solve the Euler–Lagrange equations on several blocks; see `gridgen_sym.solve_euler_lagrange`.

    Connected nodes where four cells meet have the central differences of inner ones, across the connection. Where
    three, five or more cells meet there are no logical coordinates: such a node makes the discrete energy of its cells
    stationary. The message of the result counts these nodes.

    Raises:
        GridgenError: for input that cannot be used.
    """
    if method != "newton":
        raise GridgenError(f"the equations on several blocks are solved by method='newton'; came {quoted(method)}")
    check_controls(tolerance, max_iterations, callback, time_limit)
    definition = find_functional(functional)
    asked = None if walls is None else walls_of_blocks(grid, walls)
    if asked is not None and target is not None:
        raise GridgenError("walls become a target: give walls or a target, not both")
    home, rectangles = [block.shape for block in grid.blocks], logical_rectangles(grid, spacing)
    if isinstance(target, MultiBlock):
        target = blocks_of(grid, target)

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

    limit = _STEPS if max_iterations is None else max_iterations
    title = f"Euler–Lagrange equations of {definition.name}, {len(grid)} blocks"
    with Progress(title, callback, progress, Deadline(time_limit)) as report:
        run = begin_run(grid, make(grid), report)
        solved: list[LayoutEquations] = []

        def near_minimum(tolerance: float = _NEAR, steps: int = _STEPS_NEAR) -> Outcome:
            """Untangle, if necessary, and minimize the energy, whose minimum is near the solution."""
            if not _made_valid(run, definition, parameters):
                return Outcome(Status.FOLDED, NO_PROGRESS)
            report.begin("minimize", (grid.node_count, 1))
            controls = {"tolerance": tolerance, "max_iterations": steps, "keep_valid": True}
            return minimize(run.problem, run.coordinates, report, **controls)  # type: ignore[arg-type]

        def solve() -> Outcome:
            if limit and asked is not None:
                start = walled_start(grid, asked, backend, report)
                run.coordinates = run.problem.exchange.join([block.planes for block in start.blocks])
                minimize_with_walls(run, asked, lambda targets: make(grid, targets), near_minimum)
            elif limit and run.problem.kernels.barrier:
                folded = not run.problem.energy(run.coordinates)[1] > 0
                end = run.impossible() if folded else None
                if end is not None:
                    return end
                if fixed is None:
                    nested = NestedLayouts(make, definition, parameters, report)
                    run.take(nested.start(grid, run.problem), folded=folded)
                if not run.problem.energy(run.coordinates)[1] > 0:
                    near_minimum()
            if run.problem.kernels.barrier and limit and not run.problem.energy(run.coordinates)[1] > 0:
                return Outcome(Status.FOLDED, NO_PROGRESS)
            run.problem.refresh(run.coordinates)
            solved.append(LayoutEquations(run.problem, run.coordinates))
            report.begin("solve", (grid.node_count, 1))
            return solve_by_newton(solved[0], run.coordinates, report, tolerance, limit, keep_valid)

        def result(outcome: Outcome) -> LayoutResult:
            if not solved:
                return run.result(outcome)
            status, message = choose_grid(run, solved[0], outcome, keep_valid)
            return run.result(Outcome(status, message + _remark(solved[0].others)))

        return run_to_result(solve, result, report)


def _made_valid(run: LayoutRun, functional: Functional, parameters: Mapping[str, float] | None) -> bool:
    """Untangle a folded grid where the functional has a barrier; return whether it may be minimized on."""
    if not run.problem.kernels.barrier or run.problem.energy(run.coordinates)[1] > 0:
        return True
    run.report.begin("untangle", (run.layout.node_count, 1))
    if not untangle_blocks(run.problem, functional, run.coordinates, parameters, run.report):
        return False
    run.untangled_by = REGULARIZED
    return True


def _remark(others: int) -> str:
    """Return what the result says of nodes without central differences."""
    if not others:
        return ""
    nodes, them = ("1 connected node has", "it") if others == 1 else (f"{others} connected nodes have", "them")
    return (
        f" {nodes} no logical coordinates round {them} that continue through all blocks, as where 3 or 5 cells meet: "
        "there the discrete energy of the cells that meet is stationary."
    )
