"""Minimize a discrete functional: the public `optimize` and `untangle`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.slide_curve import SlideCurve
from ..boundary.wall import NO_WALLS, Wall, walls_by_side
from ..deprecation import renamed_arguments
from ..errors import GridgenError, quoted
from ..fields.target import Target
from ..fields.wall_cells import corrected_beside, misplaced_sides
from ..fields.weight import Source, Weight
from ..functionals.definition import Functional
from ..functionals.registry import functional as find_functional
from ..grids import Grid
from ..grids.grid import check_grid
from .binding import make_problem
from .harmonic import move_sides
from .layout.dispatch import on_several_blocks
from .layout.optimize import optimize_layout
from .layout.untangling import untangle_layout
from .local import sweep_until_converged, visit_nodes
from .logical import LogicalRectangle, Spacing
from .minimization import Run
from .minimum import Minimum
from .multilevel.wall_continuation import approach_walls
from .newton.minimize import minimize
from .norms import norm_of
from .problem import Problem
from .run.checks import check_controls
from .run.deadline import Deadline
from .run.progress import Callback, Progress
from .run.result import Result
from .run.status import Outcome, Status
from .run.stopping import run_to_result
from .sliding.choice import slide_curves
from .turns import choose_turns

#: Factors by which the gradient must fall. One Newton step more gives ten digits of a grid that attains its target.
_TOLERANCE, _TO_TARGET = 1e-6, 1e-12
#: Boundary nodes that are moved by less, over the largest coordinate, are on their curves.
_ROUNDING = 1e-14
#: Default numbers of Newton steps and of sweeps.
_LIMITS = {"newton": 1000, "local": 5000}


@on_several_blocks(optimize_layout, without=("interior_only",), gets_own=True)
@renamed_arguments(stacklevel=3, name="functional")
def optimize(
    grid: Grid,
    functional: str | Functional,
    method: Literal["newton", "local"] = "newton",
    *,
    weight: Weight | Source | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | None = None,
    walls: Mapping[str, Wall] | None = None,
    slide: object = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    tolerance: float | None = None,
    max_iterations: int | None = None,
    keep_valid: bool = True,
    interior_only: bool = False,
    spacing: Spacing = "unit",
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> Result:
    """Minimize a functional over the positions of the free nodes; the boundary stays.

    A folded start of a barrier functional is untangled first, as by `untangle`. A valid start gives a valid result,
    unless a functional without a barrier is allowed to fold cells by `keep_valid=False`. Where no valid grid exists
    (see `Result.certificates`), the least folded one is returned, with every cell unfolded that can be.

    Args:
        grid: the start, for example from `transfinite`; or several blocks, a `MultiBlock`, for which the result is
            a `LayoutResult`.
        functional: what is minimized: a `Functional`, or its name.
        method: `newton` moves all nodes at once; `local` is the paper's method, one node at a time.
        weight: adaptive weight s(x, y): formula, function, array or `Weight`. A density that does not name the weight
            is multiplied by it.
        fields: values of the fields that the density declares, by name: for each a `Field`, or what one is made of.
        target: what cells should be like; the metric is taken relative to it, in any functional. A `Target`, or a
            reference grid of the same shape.
        walls: the first heights, growth and angles that are asked for at sides of the block, by side, such as
            `{"bottom": Wall(first=1e-5, growth=1.2)}`; they become the target.
        slide: the sides whose nodes slide along their curves, between the corners: `"all"`, a side, several, or a
            mapping from sides to curves (points, a SciPy spline, or a function of t in [0, 1]). Without a curve it is
            that of the side's own nodes, splines between sharp turns. Every turn that a node of the start holds is held
            by a node of the result: by which one, is chosen for a functional with a barrier, unless there are walls or
            a target. Of several blocks: names of boundaries, and (block, side); nodes slide from block to block.
        fixed: (ni, nj) mask of inner nodes that do not move.
        parameters: values of the functional's parameters.
        tolerance: factor by which the norm of the gradient or the residual must fall; by default 1e-6, and by Newton's
            method to a target 1e-12: where a valid grid attains the target, ten digits of it are found.
        max_iterations: Newton steps, or sweeps, on the grid itself; steps of untangling and on coarser grids are
            not counted. With 0 a start that needs no untangling comes back as it is.
        keep_valid: keep a valid grid valid: no step may make its smallest Jacobian non-positive. Barrier functionals
            never do, except at corners that are not summed.
        interior_only: sum over corners at inner nodes only (the paper's sums), not over all corners. With
            `keep_valid=False` and `spacing="index"` that is the paper's literal minimum: corners at boundary nodes have
            no barrier there.
        spacing: the logical steps, by which edge vectors along xi and along eta are divided. `unit`: 1/(ni-1) and
            1/(nj-1), those of the unit square, so that the grid tends to that of the Euler–Lagrange equations as it is
            refined, and parameters keep their meaning. `index`: steps of 1, the paper's literal sums. Or two numbers.
        callback: called with every `Step`. StopIteration ends the run, which returns the best grid; any other error
            is raised as it is, with the best grid's result as its attribute `result`.
        time_limit: seconds after which the best grid is returned, as soon as a step lets it. Kernels that the energy
            of any result needs are derived and compiled without a limit, once for a new functional.
        progress: show progress on standard error; by default where that is a terminal.
        backend: `c`, `numpy`, or one that is installed.

    Returns:
        The result; see its `converged` and `message`.

    Raises:
        GridgenError: for input that cannot be used.
    """
    if method not in ("newton", "local"):
        raise GridgenError(f"unknown method {quoted(method)}: optimize takes 'newton' or 'local'")
    if tolerance is None:
        tolerance = _TO_TARGET if target is not None and method == "newton" else _TOLERANCE
    check_controls(tolerance, max_iterations, callback, time_limit)
    check_grid(grid)
    if slide is not None and method == "local" and interior_only:
        raise GridgenError(
            "the local method cannot slide nodes at whose corners nothing is summed: drop interior_only, or slide"
        )
    definition = find_functional(functional)
    rectangle = LogicalRectangle.of(spacing, grid.shape)
    sides = None if walls is None else walls_by_side(walls)
    curves = None if slide is None else slide_curves(grid, slide)
    per_node = isinstance(weight, Weight) and weight.per_node

    def make(on: Grid, fixed: npt.ArrayLike | None = None, along: Mapping[str, SlideCurve] | None = None) -> Problem:
        return make_problem(
            on,
            definition,
            weight=weight,
            fields=fields,
            target=target,
            walls=sides,
            slide=along or (curves if on.shape == grid.shape else None),
            fixed=fixed,
            parameters=parameters,
            interior_only=interior_only,
            guard_summed_only=interior_only and not keep_valid,
            arrays_of=grid.shape,
            spacing=rectangle,
            backend=backend,
        )

    limit = _LIMITS[method] if max_iterations is None else max_iterations
    with Progress(f"{definition.name}, {method}", callback, progress, Deadline(time_limit)) as report:
        problem = make(grid, fixed)
        run = Run(problem, make, definition, parameters, _on_curves(problem, grid), report, grid, sides or NO_WALLS)

        def solve() -> Outcome:
            nonlocal sides
            if sides is not None and method == "newton" and limit:
                corrected = approach_walls(run, sides, backend)
                sides = corrected if curves is None else corrected_beside(corrected, sides, curves)
                run.renew(make(grid, fixed))
            else:
                if curves is not None and target is None and not per_node and limit:
                    choose_turns(run, curves, lambda on, along: make(on, along=along))
                if (method == "newton" and limit) or run.to_untangle:
                    run.start_from_coarse_grids()
            if not run.make_valid():
                return run.could_not_unfold()
            report.begin("minimize", grid.shape)
            iterate: Callable[..., Outcome] = partial(minimize, reference=run.reference)
            if method == "local":
                iterate = partial(sweep_until_converged, visit=visit_nodes)
            outcome = iterate(
                run.problem,
                run.coordinates,
                report,
                tolerance=tolerance,
                max_iterations=limit,
                keep_valid=keep_valid,
            )
            if walls is not None:
                run.remark = misplaced_sides(walls_by_side(walls), run.coordinates)
            return run.explained_by_derivatives(outcome)

        found = run_to_result(solve, run.result, report)
        asked = None if walls is None or sides is None else {"": (walls_by_side(walls), sides)}
        minimum = Minimum(lambda: run.problem, definition, parameters, tolerance, grid, target, slide, asked)
        return replace(found, minimum=minimum)


@on_several_blocks(untangle_layout, gets_own=True)
@renamed_arguments(stacklevel=3, name="functional")
def untangle(
    grid: Grid,
    functional: str | Functional = "winslow",
    *,
    slide: object = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> Result:
    """Make a folded grid valid, with the regularized barrier of a functional; a valid grid is returned as it is.

    Coarse grids of the same boundary are untangled first. It stops at a valid grid, or when progress has ended: then
    the result is the least folded grid that was found, its message names the cells, and `converged` is False.

    Args:
        grid: the start, of one or several blocks.
        functional: one with a barrier at J = 0; the grid is near its minimum. A weight and a target have no part in
            what is valid; where the density declares fields, Winslow's barrier is taken.
        slide: the sides whose nodes may slide along their curves, as in `optimize`: that often makes a valid grid
            possible. What is impossible is then not proved.
        fixed: (ni, nj) mask of inner nodes that do not move.
        parameters: values of the functional's parameters.
        callback: as in `optimize`.
        time_limit: as in `optimize`.
        progress: show progress on standard error; by default where that is a terminal.
        backend: `c`, `numpy`, or one that is installed.

    Returns:
        The result; `converged` is true if every corner's Jacobian is positive.

    Raises:
        GridgenError: if the functional has no barrier, and for other input that cannot be used.
    """
    check_grid(grid)
    definition = find_functional(functional)
    if definition.fields:
        definition = find_functional("winslow")
    check_controls(0.5, None, callback, time_limit)

    def make(on: Grid, fixed: npt.ArrayLike | None = None) -> Problem:
        curves = slide if on.shape == grid.shape else None
        return make_problem(on, definition, slide=curves, fixed=fixed, parameters=parameters, backend=backend)

    deadline = Deadline(time_limit)
    problem = make(grid, fixed)
    if not problem.kernels.barrier:
        raise GridgenError(
            f"untangling needs a functional with a barrier at J = 0, such as winslow; {definition.name!r} has none"
        )
    with Progress(f"{definition.name}, untangle", callback, progress, deadline) as report:
        folded = not problem.energy(grid.planes)[1] > 0
        start = _on_curves(problem, grid) if folded else grid.planes.copy()
        run = Run(problem, make, definition, parameters, start, report, grid)

        def solve() -> Outcome:
            if run.to_untangle:
                run.start_from_coarse_grids()
            report.begin("untangle", grid.shape)
            valid = run.make_valid()
            if not report.history:  # The start, or that from coarse grids, is valid: the history is this grid.
                energy, smallest, gradient = run.problem.energy_gradient(run.coordinates)
                report.step(0, energy, norm_of(gradient), smallest)
            run.said = ""
            return (
                Outcome(Status.CONVERGED, "every corner's Jacobian is positive.") if valid else run.could_not_unfold()
            )

        return run_to_result(solve, run.result, report)


def _on_curves(problem: Problem, grid: Grid) -> Array:
    """Return the nodes (2, ni, nj) of a grid with the sliding ones on their curves; inner nodes follow."""
    start = grid.planes.copy()
    if problem.slide is not None:
        problem.retract(start)
        moved = np.abs(start - grid.planes).max()
        if moved > _ROUNDING * np.abs(start).max():
            start = move_sides(grid.planes, start)
    return start
