"""Untangle a grid of several blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy.typing as npt

from ...errors import GridgenError
from ...functionals.definition import Functional
from ...functionals.registry import functional as find_functional
from ...topology import MultiBlock
from ...topology.merging import merge
from ..run.checks import check_controls
from ..run.deadline import Deadline
from ..run.progress import Callback, Progress
from ..run.result import Result
from ..run.status import Outcome, Status
from ..run.stopping import run_to_result
from .binding import make_layout_problem
from .merged import is_one_grid, merged_slide, of_all_blocks, sliding_sides
from .nested import NestedLayouts
from .problem import LayoutProblem
from .result import LayoutResult
from .run import REGULARIZED, LayoutRun, begin_run
from .untangle import NO_PROGRESS, untangle_blocks


def untangle_layout(
    grid: MultiBlock,
    functional: str | Functional = "winslow",
    *,
    slide: object = None,
    fixed: Mapping[str, npt.ArrayLike] | None = None,
    parameters: Mapping[str, float] | None = None,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
    of_one_block: Callable[..., Result] | None = None,
) -> LayoutResult:
    """Make a folded grid of several blocks valid; see `gridgen_sym.untangle`.

    If they make up a plain grid, `of_one_block` solves, where it is given.
    """
    definition = find_functional(functional)
    if definition.fields:
        definition = find_functional("winslow")
    check_controls(0.5, None, callback, time_limit)

    def make(on: MultiBlock) -> LayoutProblem:
        whole = on is grid
        return make_layout_problem(
            on,
            definition,
            slide=slide if whole else None,
            fixed=fixed if whole else None,
            parameters=parameters,
            backend=backend,
        )

    if fixed is None:
        merged = merge(grid)
        sliding = merged_slide(grid, slide, merged)
        given: dict[str, Any] = {
            "parameters": parameters,
            "callback": callback,
            "time_limit": time_limit,
            "progress": progress,
            "backend": backend,
        }
        sides = sliding_sides(sliding) if is_one_grid(merged.layout) else None
        again: Callable[[], LayoutResult | Result]
        if of_one_block is not None and sides is not None:
            again = partial(of_one_block, merged.layout.blocks[0], definition, slide=sides or None, **given)
            return of_all_blocks(again, grid, merged)
        if len(merged.layout) < len(grid):
            again = partial(untangle_layout, merged.layout, definition, slide=sliding, **given)
            return of_all_blocks(again, grid, merged)
    problem = make(grid)
    if not problem.kernels.barrier:
        raise GridgenError(
            f"untangling needs a functional with a barrier at J = 0, such as winslow; {definition.name!r} has none"
        )
    with Progress(f"{definition.name}, untangle", callback, progress, Deadline(time_limit)) as report:
        own = problem.exchange.join([block.planes for block in grid.blocks])
        folded = not problem.energy(own)[1] > 0
        run = begin_run(grid, problem, report) if folded else LayoutRun(grid, problem, own, report)

        def solve() -> Outcome:
            end = run.impossible() if folded else None
            if end is not None:
                return end
            if folded and fixed is None:
                nested, sliding = NestedLayouts(make, definition, parameters, report), problem.slide
                problem.slide = None  # Boundary nodes stay where that is enough.
                try:
                    run.take(nested.start(run.present, problem), folded=True)
                finally:
                    problem.slide = sliding
            report.begin("untangle", (grid.node_count, 1))
            valid = problem.folds(run.coordinates).cells == 0 or untangle_blocks(
                problem, definition, run.coordinates, parameters, report
            )
            run.untangled_by = run.untangled_by or (REGULARIZED if folded and valid else "")
            if valid:
                return Outcome(Status.CONVERGED, "every corner's Jacobian is positive.")
            return Outcome(Status.FOLDED, NO_PROGRESS)

        return run_to_result(solve, run.result, report)
