"""Solve the Euler–Lagrange equations of a functional by central differences on the 9-point stencil.

Newton's method uses the generated Jacobian; relaxation holds the coefficients of the second derivatives while every
node solves its own equations: for the Winslow functional this is what the literature calls the Winslow or TTM solver.
Logical coordinates are in the unit square, as in the discrete functionals; see `spacing`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
import numpy.typing as npt

from ...boundary.wall import NO_WALLS, Wall, walls_by_side
from ...deprecation import renamed_arguments
from ...errors import GridgenError, quoted
from ...fields.target import Target
from ...fields.weight import Source, Weight
from ...functionals.definition import Functional
from ...functionals.registry import functional as find_functional
from ...functionals.variant import Variant
from ...grids import Grid
from ...grids.grid import check_grid
from ...runtime import KernelSet, kernels
from ..binding import make_problem
from ..layout.dispatch import on_several_blocks
from ..logical import LogicalRectangle, Spacing
from ..minimization import Run
from ..newton.minimize import minimize
from ..problem import Problem
from ..run.checks import check_controls
from ..run.deadline import Deadline
from ..run.progress import Callback, Progress
from ..run.result import Result
from ..run.status import Outcome
from ..run.stopping import run_to_result
from .blocks.euler_lagrange import solve_layout_euler_lagrange
from .choice import choose_grid
from .control import Control, Controlled, check_walls
from .newton import solve_by_newton
from .relaxation import solve_by_relaxation
from .residual import Equations
from .wall_iteration import solve_with_walls

#: How near to the minimum a grid is brought that was folded at the start.
_NEAR, _STEPS_NEAR = 1e-2, 50
_FOLDED = "The grid was folded at the start; it was untangled and brought near the minimum of the energy first: "
#: Default numbers of Newton steps, of sweeps, and of updates of control functions.
_LIMITS = {"newton": 200, "relaxation": 100_000, "control": 100}


@on_several_blocks(solve_layout_euler_lagrange, without=("control",), gets_own=True)
@renamed_arguments(stacklevel=3, name="functional")
def solve_euler_lagrange(
    grid: Grid,
    functional: str | Functional,
    method: Literal["newton", "relaxation"] = "newton",
    *,
    weight: Weight | Source | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | None = None,
    walls: Mapping[str, Wall] | None = None,
    control: Control | None = None,
    fixed: npt.ArrayLike | None = None,
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
) -> Result:
    """Solve the Euler–Lagrange equations of a functional for the positions of the free nodes; the boundary stays.

    Args:
        grid: the start. Newton's method untangles a folded start of a barrier functional first. Or several blocks, a
            `MultiBlock`, for which the result is a `LayoutResult`: connected nodes have central differences across the
            connection, and where three, five or more cells meet the discrete energy of the cells is stationary.
        functional: what is minimized: a `Functional`, or its name.
        method: `newton`, or `relaxation` with frozen coefficients, node by node. For a barrier functional
            Newton's method starts near the minimum of the discrete energy, which it finds first: on coarse grids, or
            after untangling. These steps are not counted as iterations. Relaxation starts from `grid` as it is.
        weight: adaptive weight s(x, y): formula, function, array or `Weight`.
        fields: values of the fields that the density declares, by name: for each a `Field`, or what one is made of.
            The equations hold at the nodes: of values per cell or corner they take the means there.
        target: what cells should be like; the metric is taken relative to it, in any functional. A `Target`, or a
            reference grid of the same shape.
        walls: the first heights, growth and angles that are asked for at sides of the block, by side, such as
            `{"bottom": Wall(first=1e-5, growth=1.2)}`; they become the target, or by `control="hilgenstock-white"`
            control functions.
        control: control functions (P, Q) of the equations g22 (r_xixi + P r_xi) - 2 g12 r_xieta + g11 (r_etaeta +
            Q r_eta) = 0 of `winslow`, or of others that reduce to a scalar operator: formulas in xi and eta, functions
            of them, numbers or arrays (ni, nj); or `thomas-middlecoff`: computed from the boundary nodes, whose
            spacing they carry inwards. From a valid start, Newton's method then begins with `grid` itself. Or
            `hilgenstock-white`: from `walls`, updated from one solution to the next until heights are within 0.1 % and
            angles within 0.1 degrees; it begins with the transfinite grid that has these heights, or, if that is
            folded, with the one that has the walls as a target.
        fixed: (ni, nj) mask of inner nodes that do not move.
        parameters: values of the functional's parameters.
        tolerance: factor by which the norm of the gradient or the residual must fall.
        max_iterations: Newton steps, or sweeps; with `hilgenstock-white` updates of the control functions.
        relaxation: factor of a relaxation step; by default that which is best for Laplace's equation, and less
            where it diverges.
        spacing: the logical steps, as in `optimize`: `unit`, `index` or two numbers. It matters only where the
            functional is not homogeneous in each direction.
        keep_valid: keep a valid grid valid: Newton's method takes no step that folds a cell, and where
            relaxation ends in a folded solution, the best valid grid on the way is returned. The message says so. With
            False the solution of the equations is returned, folded or not (Laplace's equations, for one, fold on many
            domains).
        callback: called with every `Step`, whose `gradient_norm` is the residual's norm; else as in `optimize`.
        time_limit: as in `optimize`.
        progress: show progress on standard error; by default where that is a terminal.
        backend: `c`, `numpy`, or one that is installed.

    Raises:
        GridgenError: for input that cannot be used.
    """
    if method not in ("newton", "relaxation"):
        raise GridgenError(f"unknown method {quoted(method)}: solve_euler_lagrange takes 'newton' or 'relaxation'")
    check_controls(tolerance, max_iterations, callback, time_limit)
    _check_relaxation(relaxation)
    definition = find_functional(functional)
    check_grid(grid)
    rectangle = LogicalRectangle.of(spacing, grid.shape)
    sides = NO_WALLS if walls is None else walls_by_side(walls)
    by_control = check_walls(control, walls, method)

    def make(on: Grid, inside: npt.ArrayLike | None = None) -> Problem:
        return make_problem(
            on,
            definition,
            weight=weight,
            fields=fields,
            target=target,
            walls=None if by_control else walls,
            fixed=inside,
            parameters=parameters,
            arrays_of=grid.shape,
            spacing=rectangle,
            backend=backend,
        )

    limit = _LIMITS["control" if by_control else method] if max_iterations is None else max_iterations
    title = f"Euler–Lagrange equations of {definition.name}"
    with Progress(title, callback, progress, Deadline(time_limit)) as report:
        run = Run(make(grid, fixed), make, definition, parameters, grid.planes.copy(), report, grid, sides)
        equations = Equations(run.problem, _controlled(control, grid, run.problem, definition, parameters))

        def solve() -> Outcome:
            if by_control:
                return solve_with_walls(run, equations, sides, limit, tolerance)
            near = equations.controlled is not None and not run.to_untangle
            if method == "newton" and run.problem.kernels.barrier and limit and not near and not _bring_near(run):
                return run.could_not_unfold()
            report.begin("solve", grid.shape)
            if method == "relaxation":
                return solve_by_relaxation(equations, run.coordinates, report, tolerance, limit, relaxation)
            return solve_by_newton(equations, run.coordinates, report, tolerance, limit, keep_valid)

        def result(outcome: Outcome) -> Result:
            told = run.explained_by_derivatives(outcome)
            return run.result(told if by_control else choose_grid(run, equations, told, keep_valid))

        return run_to_result(solve, result, report)


def _controlled(
    control: Control | None,
    grid: Grid,
    problem: Problem,
    functional: Functional,
    parameters: Mapping[str, float] | None,
) -> Controlled | None:
    """Return the equations with control functions; None where none are given."""
    if control is None:
        return None

    def find_kernels(variant: Variant) -> KernelSet:
        return kernels(functional, variant, parameters, problem.kernels.backend)

    return Controlled.of(control, grid, problem, find_kernels)


def _bring_near(run: Run) -> bool:
    """Bring the grid near the minimum of the energy; return whether it is valid.

    The minimum is near the solution of the equations, and coarse grids find it fast. A grid that is just unfolded is
    far from a solution: the energy leads into its neighborhood, the residual's norm may not.
    """
    folded = run.to_untangle
    run.start_from_coarse_grids()
    unfolding = run.to_untangle
    if not run.make_valid():
        return False
    if unfolding:
        run.report.begin("minimize", run.problem.fixed.shape)
        minimize(
            run.problem,
            run.coordinates,
            run.report,
            tolerance=_NEAR,
            max_iterations=_STEPS_NEAR,
            keep_valid=True,
        )
    run.problem.refresh(run.coordinates)
    run.said = _FOLDED if folded else ""
    return True


def _check_relaxation(relaxation: float | None) -> None:
    """Refuse a relaxation that must diverge."""
    if relaxation is not None and not (isinstance(relaxation, (int, float, np.number)) and 0 < relaxation < 2):
        raise GridgenError(f"expected a relaxation between 0 and 2; came {quoted(relaxation)}")
