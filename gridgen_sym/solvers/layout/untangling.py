"""Untangle a grid of several blocks."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy.typing as npt

from ...errors import GridgenError
from ...functionals.definition import Functional
from ...functionals.registry import functional as find_functional
from ...topology import MultiBlock
from ...topology.merging import merge
from ..run.checks import check_controls
from ..run.deadline import Deadline
from ..run.progress import Callback, Progress
from ..run.status import Outcome, Status
from ..run.stopping import run_to_result
from .binding import make_layout_problem
from .merged import of_all_blocks
from .nested import NestedLayouts
from .problem import LayoutProblem
from .result import LayoutResult
from .run import REGULARIZED, begin_run
from .untangle import NO_PROGRESS, untangle_blocks


def untangle_layout(
    grid: MultiBlock,
    functional: str | Functional = "winslow",
    *,
    fixed: Mapping[str, npt.ArrayLike] | None = None,
    parameters: Mapping[str, float] | None = None,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> LayoutResult:
    """Make a folded grid of several blocks valid; a valid one is returned as it is. See `gridgen_sym.untangle`."""
    definition = find_functional(functional)
    if definition.fields:
        definition = find_functional("winslow")
    check_controls(0.5, None, callback, time_limit)

    def make(on: MultiBlock) -> LayoutProblem:
        return make_layout_problem(
            on, definition, fixed=fixed if on is grid else None, parameters=parameters, backend=backend
        )

    if fixed is None:
        merged = merge(grid)
        if len(merged.layout) < len(grid):
            again = partial(
                untangle_layout,
                merged.layout,
                definition,
                parameters=parameters,
                callback=callback,
                time_limit=time_limit,
                progress=progress,
                backend=backend,
            )
            return of_all_blocks(again, grid, merged)
    problem = make(grid)
    if not problem.kernels.barrier:
        raise GridgenError(
            f"untangling needs a functional with a barrier at J = 0, such as winslow; {definition.name!r} has none"
        )
    with Progress(f"{definition.name}, untangle", callback, progress, Deadline(time_limit)) as report:
        run = begin_run(grid, problem, report)

        def solve() -> Outcome:
            folded = not problem.energy(run.coordinates)[1] > 0
            if folded and fixed is None:
                run.take(NestedLayouts(make, definition, parameters, report).start(grid, problem), folded=True)
            report.begin("untangle", (grid.node_count, 1))
            valid = problem.folds(run.coordinates).cells == 0 or untangle_blocks(
                problem, definition, run.coordinates, parameters, report
            )
            run.untangled_by = run.untangled_by or (REGULARIZED if folded and valid else "")
            if valid:
                return Outcome(Status.CONVERGED, "every corner's Jacobian is positive.")
            return Outcome(Status.FOLDED, NO_PROGRESS)

        return run_to_result(solve, run.result, report)
