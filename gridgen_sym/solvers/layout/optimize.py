"""Minimize a functional over a grid of several blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...boundary.sides import Sides
from ...boundary.wall import Wall
from ...errors import GridgenError, quoted
from ...fields.target import Target
from ...fields.weight import Source, Weight
from ...functionals.definition import Functional
from ...functionals.metric import LOGICAL_NAMES
from ...functionals.registry import functional as find_functional
from ...grids import Grid
from ...topology import MultiBlock
from ...topology.merging import Merged, merge
from ...topology.quality import quality
from ..binding import make_problem
from ..logical import Spacing
from ..newton.minimize import minimize
from ..run.checks import check_controls
from ..run.deadline import Deadline
from ..run.progress import Callback, Progress
from ..run.status import Outcome, Status
from ..run.stopping import run_to_result
from .binding import blocks_of, logical_rectangles, make_layout_problem
from .nested import NestedLayouts
from .problem import LayoutProblem
from .result import LayoutResult
from .untangle import untangle_blocks
from .walls import LayoutWalls, corrected_walls, wall_targets, walled_start, walls_of_blocks

#: Factors by which the gradient must fall, as for one block.
_TOLERANCE, _TO_TARGET, _STEPS = 1e-6, 1e-12, 1000
#: What made a folded start valid.
_NESTED, _REGULARIZED = "nested iteration", "regularized barrier at all nodes"
#: First heights are corrected so often at most, and not where they are wrong by no more than this part.
_CORRECTIONS, _RIGHT = 3, 2e-3
_NO_PROGRESS = "untangling made no more progress; this is the least folded grid found."


@dataclass(slots=True)
class _Run:
    """The state of a run: the best coordinates so far, and how they were reached."""

    layout: MultiBlock
    problem: LayoutProblem
    coordinates: Array
    report: Progress
    untangled_by: str = ""

    def result(self, outcome: Outcome) -> LayoutResult:
        """Return the result, which reports folded cells."""
        self.problem.refresh(self.coordinates)
        grid = self.layout.moved(self.problem.exchange.views(self.coordinates))
        valid, status, message = not self.problem.folds(self.coordinates).cells, outcome.status, outcome.message
        if self.untangled_by:
            message = f"The grid was folded at the start and was untangled first ({self.untangled_by}): {message}"
        if not valid:
            status = status if status.stop_reason else Status.FOLDED
            message = f"{message} {quality(grid).describe_folds()}"
        return LayoutResult(
            grid=grid,
            converged=outcome.converged and (valid or not self.problem.kernels.barrier),
            status=status,
            message=message.strip(),
            iterations=max(len(self.report.history) - 1, 0),
            energy=self.problem.energy(self.coordinates)[0],
            history=tuple(self.report.history),
            untangled_by=self.untangled_by,
        )


def optimize_layout(
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
    tolerance: float | None = None,
    max_iterations: int | None = None,
    keep_valid: bool = True,
    spacing: Spacing = "unit",
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> LayoutResult:
    """Minimize a functional over a grid of several blocks; see `gridgen_sym.optimize`.

    Connected nodes move like inner ones; the outer boundary stays. `fixed`, and values that are given as a mapping from
    the names of blocks, are for each block; `walls` by block and side, such as `{"a": {"bottom": Wall(first=1e-3)}}`,
    or by the name of a boundary, `{"wall": Wall(first=1e-3)}`.

    Raises:
        GridgenError: for input that cannot be used.
    """
    if method != "newton":
        raise GridgenError(f"several blocks are optimized by method='newton'; came {quoted(method)}")
    if tolerance is None:
        tolerance = _TOLERANCE if target is None else _TO_TARGET
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

    alike = weight is None and not fields and not fixed and walls is None and spacing in ("unit", "index")
    references = _references(grid, target)
    alike = alike and (target is None or references is not None)
    if alike and not _names_place(grid, definition, parameters, backend):
        merged = merge(grid)
        if len(merged.layout) < len(grid):
            found = optimize_layout(
                merged.layout,
                definition,
                target=merged.join(references) if references is not None else None,
                parameters=parameters,
                tolerance=tolerance,
                max_iterations=max_iterations,
                keep_valid=keep_valid,
                spacing=spacing,
                callback=callback,
                time_limit=time_limit,
                progress=progress,
                backend=backend,
            )
            return _of_all_blocks(found, grid, merged)
    limit = _STEPS if max_iterations is None else max_iterations
    with Progress(f"{definition.name}, {len(grid)} blocks", callback, progress, Deadline(time_limit)) as report:
        problem = make(grid)
        run = _Run(grid, problem, problem.exchange.join([block.planes for block in grid.blocks]), report)

        def minimized() -> Outcome:
            """Untangle, if necessary, and minimize."""
            problem = run.problem
            if problem.kernels.barrier and not problem.energy(run.coordinates)[1] > 0:
                report.begin("untangle", (grid.node_count, 1))
                if not untangle_blocks(problem, definition, run.coordinates, parameters, report):
                    return Outcome(Status.FOLDED, _NO_PROGRESS)
                run.untangled_by = _REGULARIZED
            report.begin("minimize", (grid.node_count, 1))
            controls = {"tolerance": tolerance, "max_iterations": limit, "keep_valid": keep_valid}
            return minimize(problem, run.coordinates, report, **controls)  # type: ignore[arg-type]

        def solve() -> Outcome:
            if asked is not None and limit:
                run.coordinates = problem.exchange.join(
                    [block.planes for block in walled_start(grid, asked, backend, report).blocks]
                )
                return _with_walls(run, asked, lambda targets: make(grid, targets), minimized)
            folded = problem.kernels.barrier and not problem.energy(run.coordinates)[1] > 0
            if limit and not fixed:
                start = NestedLayouts(make, definition, parameters, report).start(grid, problem)
                _take(run, start, folded=folded)
            return minimized()

        return run_to_result(solve, run.result, report)


def _references(layout: MultiBlock, target: object) -> list[Array] | None:
    """Return the planes of the reference grids of all blocks; None where the target is anything else."""
    if not isinstance(target, Mapping) or set(target) != set(layout.names):
        return None
    shapes = zip((target[name] for name in layout.names), layout.blocks, strict=True)
    if not all(isinstance(one, Grid) and one.shape == block.shape for one, block in shapes):
        return None
    return [target[name].planes for name in layout.names]


def _names_place(
    layout: MultiBlock, functional: Functional, parameters: Mapping[str, float] | None, backend: str | None
) -> bool:
    """Whether the density names xi or eta, which are others where blocks are put together."""
    planes = make_problem(layout.blocks[0], functional, parameters=parameters, backend=backend).kernels.planes
    return bool(set(LOGICAL_NAMES) & set(planes))


def _of_all_blocks(found: LayoutResult, layout: MultiBlock, merged: Merged) -> LayoutResult:
    """Return the result on merged blocks as one on those that were given."""
    planes = merged.split([block.planes for block in found.grid.blocks])
    return replace(found, grid=layout.moved(planes))


def _with_walls(
    run: _Run,
    asked: Mapping[str, Sides[Wall | None]],
    make: Callable[[dict[str, Target]], LayoutProblem],
    minimized: Callable[[], Outcome],
) -> Outcome:
    """Minimize for the targets of walls, and for others that make up for first heights that came out wrong."""
    walls, least, outcome = dict(asked), np.inf, None
    for _ in range(1 + _CORRECTIONS):
        before, problem = run.coordinates.copy(), run.problem
        run.problem = make(wall_targets(run.layout, walls))
        run.problem.measure_locally(run.coordinates)
        found = minimized()
        if outcome is not None and not found.converged:
            run.coordinates, run.problem = before, problem
            break
        outcome = found
        places = dict(zip(run.layout.names, run.problem.exchange.views(run.coordinates), strict=True))
        walls, wrong = corrected_walls(walls, asked, places)
        if not found.converged or wrong < _RIGHT or wrong > 0.7 * least:
            break
        least = wrong
    assert outcome is not None
    return outcome


def _take(run: _Run, start: Array, *, folded: bool) -> None:
    """Take the start that coarse layouts gave, if it is less folded, or of lower energy."""
    problem = run.problem
    problem.refresh(start)
    energy, smallest = problem.energy(start)
    problem.refresh(run.coordinates)
    before, least = problem.energy(run.coordinates)
    if folded or not min(smallest, least) > 0:
        better = problem.folds(start) < problem.folds(run.coordinates)
    else:
        better = energy < before
    if better:
        run.coordinates = start
        run.untangled_by = _NESTED if folded and smallest > 0 else ""
    problem.refresh(run.coordinates)


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

    if not fixed:
        merged = merge(grid)
        if len(merged.layout) < len(grid):
            found = untangle_layout(
                merged.layout,
                definition,
                parameters=parameters,
                callback=callback,
                time_limit=time_limit,
                progress=progress,
                backend=backend,
            )
            return _of_all_blocks(found, grid, merged)
    problem = make(grid)
    if not problem.kernels.barrier:
        raise GridgenError(
            f"untangling needs a functional with a barrier at J = 0, such as winslow; {definition.name!r} has none"
        )
    with Progress(f"{definition.name}, untangle", callback, progress, Deadline(time_limit)) as report:
        run = _Run(grid, problem, problem.exchange.join([block.planes for block in grid.blocks]), report)

        def solve() -> Outcome:
            folded = not problem.energy(run.coordinates)[1] > 0
            if folded and not fixed:
                _take(run, NestedLayouts(make, definition, parameters, report).start(grid, problem), folded=True)
            report.begin("untangle", (grid.node_count, 1))
            valid = problem.folds(run.coordinates).cells == 0 or untangle_blocks(
                problem, definition, run.coordinates, parameters, report
            )
            run.untangled_by = run.untangled_by or (_REGULARIZED if folded and valid else "")
            if valid:
                return Outcome(Status.CONVERGED, "every corner's Jacobian is positive.")
            return Outcome(Status.FOLDED, _NO_PROGRESS)

        return run_to_result(solve, run.result, report)
