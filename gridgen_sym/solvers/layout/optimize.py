"""Minimize a functional over a grid of several blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy.typing as npt

from ...errors import GridgenError, quoted
from ...fields.target import Target
from ...fields.weight import Source, Weight
from ...functionals.definition import Functional
from ...functionals.registry import functional as find_functional
from ...grids import Grid
from ...topology import MultiBlock
from ...topology.merging import merge
from ..local import sweep_until_converged
from ..logical import Spacing
from ..minimum import Minimum
from ..newton.minimize import minimize
from ..run.checks import check_controls
from ..run.deadline import Deadline
from ..run.progress import Callback, Progress
from ..run.result import Result
from ..run.status import Outcome, Status
from ..run.stopping import run_to_result
from .binding import logical_rectangles, make_layout_problem
from .merged import (
    begins_from_sides,
    is_one_grid,
    merged_slide,
    names_place,
    of_all_blocks,
    references_of,
    sliding_sides,
)
from .nested import NestedLayouts
from .problem import LayoutProblem
from .relaxation import LayoutSweeps
from .result import LayoutResult
from .run import REGULARIZED, begin_run
from .untangle import NO_PROGRESS, untangle_blocks
from .walls import LayoutWalls, minimize_with_walls, walled_start, walls_or_target

#: Factors by which the gradient must fall, as for one block.
_TOLERANCE, _TO_TARGET = 1e-6, 1e-12
#: Why such grids cannot be differentiated.
_WALLS_OF_BLOCKS = (
    "grids of several blocks with walls cannot be differentiated: their cells are made to agree from block to block, "
    "and first heights are corrected; give the cells as target="
)
#: Default numbers of Newton steps and of sweeps, likewise.
_LIMITS = {"newton": 1000, "local": 5000}


def optimize_layout(
    grid: MultiBlock,
    functional: str | Functional,
    method: str = "newton",
    *,
    weight: Weight | Source | Mapping[str, object] | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | MultiBlock | Mapping[str, object] | None = None,
    walls: LayoutWalls | None = None,
    slide: object = None,
    fixed: Mapping[str, npt.ArrayLike] | None = None,
    parameters: Mapping[str, float] | None = None,
    tolerance: float | None = None,
    max_iterations: int | None = None,
    keep_valid: bool = True,
    spacing: Spacing = "unit",
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
    of_one_block: Callable[..., Result] | None = None,
    merges: bool = True,
) -> LayoutResult:
    """Minimize a functional over a grid of several blocks; see `gridgen_sym.optimize`.

    Connected nodes move like inner ones; the outer boundary stays. `fixed`, and values that are given as a mapping from
    the names of blocks, are for each block; `walls` by block and side, such as `{"a": {"bottom": Wall(first=1e-3)}}`,
    or by the name of a boundary, `{"wall": Wall(first=1e-3)}`. `slide` takes names of boundaries and (block, side).
    With `merges`, blocks are put together where that gives the same grid; if they make up a plain one, `of_one_block`
    solves, where it is given.

    Raises:
        GridgenError: for input that cannot be used.
    """
    if method not in ("newton", "local"):
        raise GridgenError(f"unknown method {quoted(method)}: optimize takes 'newton' or 'local'")
    if tolerance is None:
        tolerance = _TO_TARGET if target is not None and method == "newton" else _TOLERANCE
    check_controls(tolerance, max_iterations, callback, time_limit)
    definition = find_functional(functional)
    asked, target = walls_or_target(grid, walls, target)

    def make(on: MultiBlock, target: object = target) -> LayoutProblem:
        return make_layout_problem(
            on,
            definition,
            weight=weight,
            fields=fields,
            target=target,
            slide=slide if on is grid else None,
            fixed=fixed if on is grid else None,
            parameters=parameters,
            rectangles=rectangles,
            arrays_of=[block.shape for block in grid.blocks],
            backend=backend,
        )

    alike = weight is None and not fields and fixed is None and walls is None and spacing in ("unit", "index")
    references = references_of(grid, target)
    alike = alike and (target is None or references is not None)
    if merges and alike and not names_place(grid, definition, parameters, backend):
        merged = merge(grid)
        sliding = merged_slide(grid, slide, merged)
        fewer, sides = len(merged.layout) < len(grid), sliding_sides(sliding) if is_one_grid(merged.layout) else None
        as_one = of_one_block is not None and sides is not None
        as_one = as_one and (bool(sides) or method == "local" or (fewer and begins_from_sides(merged.layout)))
        if as_one or fewer:
            reference = merged.join(references) if references is not None else None
            given: dict[str, Any] = {
                "parameters": parameters,
                "tolerance": tolerance,
                "max_iterations": max_iterations,
                "keep_valid": keep_valid,
                "spacing": spacing,
                "callback": callback,
                "time_limit": time_limit,
                "progress": progress,
                "backend": backend,
            }
            again: Callable[[], LayoutResult | Result]
            if of_one_block is not None and as_one:
                whole = None if reference is None else reference.blocks[0]
                again = partial(of_one_block, merged.layout.blocks[0], definition, method, target=whole, **given)
                again = partial(again, slide=sides or None)
            else:
                again = partial(optimize_layout, merged.layout, definition, method, target=reference, **given)
                again = partial(again, slide=sliding, merges=False)
            whole_problem = partial(make_layout_problem, grid, definition, target=target, slide=slide)
            whole_problem = partial(whole_problem, parameters=parameters, spacing=spacing, backend=backend)
            minimum = Minimum(whole_problem, definition, parameters, tolerance, grid, target, slide)
            return replace(of_all_blocks(again, grid, merged), minimum=minimum)
    limit, rectangles = _LIMITS[method] if max_iterations is None else max_iterations, logical_rectangles(grid, spacing)
    with Progress(f"{definition.name}, {len(grid)} blocks", callback, progress, Deadline(time_limit)) as report:
        problem = make(grid)
        run = begin_run(grid, problem, report)

        def minimized() -> Outcome:
            """Untangle, if necessary, and minimize."""
            problem = run.problem
            if problem.kernels.barrier and not problem.energy(run.coordinates)[1] > 0:
                report.begin("untangle", (grid.node_count, 1))
                if not untangle_blocks(problem, definition, run.coordinates, parameters, report):
                    return Outcome(Status.FOLDED, NO_PROGRESS)
                run.untangled_by = REGULARIZED
            report.begin("minimize", (grid.node_count, 1))
            controls: dict[str, Any] = {"tolerance": tolerance, "max_iterations": limit, "keep_valid": keep_valid}
            if method == "local":
                visit = LayoutSweeps(problem).visit
                return sweep_until_converged(problem, run.coordinates, report, visit=visit, **controls)
            return minimize(problem, run.coordinates, report, reference=run.reference, **controls)

        def solve() -> Outcome:
            if asked is not None and limit:
                run.coordinates = problem.exchange.join(
                    [block.planes for block in walled_start(run.present, asked, backend, report).blocks]
                )
                return minimize_with_walls(run, asked, lambda targets: make(grid, targets), minimized)
            folded = problem.kernels.barrier and not problem.energy(run.coordinates)[1] > 0
            end = run.impossible() if folded else None
            if end is not None:
                return end
            if limit and fixed is None and (folded or method == "newton"):
                start = NestedLayouts(make, definition, parameters, report).start(run.present, problem)
                run.take(start, folded=folded)
            return minimized()

        minimum = Minimum(lambda: run.problem, definition, parameters, tolerance, grid, target, slide)
        if asked is not None:
            minimum = replace(minimum, objection=_WALLS_OF_BLOCKS)
        return replace(run_to_result(solve, run.result, report), minimum=minimum)
