"""Adapt a grid to a solution: solve, measure, move, and again, until the grid settles."""

from __future__ import annotations

from collections.abc import Mapping

import numpy.typing as npt

from ..deprecation import renamed_arguments
from ..fields.target import Target
from ..functionals.definition import Functional
from ..functionals.registry import functional as find_functional
from ..grids import Grid
from ..grids.grid import check_grid
from ..solvers.layout.dispatch import on_several_blocks
from ..solvers.run.checks import check_size, fixed_mask
from ..solvers.run.deadline import Deadline
from .arguments import check_arguments, valid_start
from .layouts import adapt_layout
from .monitor import Monitor, as_monitor
from .mover import Mover
from .nodes import Measure
from .result import AdaptResult
from .run import Callback, adapted
from .sides import Boundary, SideSpacing, sliding_curves
from .source import Solution, source_of
from .weight_exponent import weight_exponent_of


@on_several_blocks(adapt_layout, without=("moves",), gets_own=True)
@renamed_arguments(stacklevel=3, steps="max_iterations", power="weight_exponent")
def adapt(
    grid: Grid,
    solution: Solution,
    *,
    functional: str | Functional = "area_winslow",
    monitor: Monitor | str | Measure = "curvature",
    weight_exponent: float | None = None,
    parameters: Mapping[str, float] | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | None = None,
    max_iterations: int = 30,
    moves: int | None = None,
    damping: float = 0.5,
    tolerance: float = 1e-3,
    boundary: Boundary = "straight",
    fixed: npt.ArrayLike | None = None,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> AdaptResult:
    """Move the nodes of a grid to where a solution needs them; no cell ever folds.

    Each step solves on the present grid, lets the monitor make a density of nodes of the solution, and minimizes the
    functional with the weight of that density. The weight is held at the nodes and moves with them, so this is a fixed
    point and not one minimization; from step to step the weight is damped.

    Args:
        grid: the start. A folded one is untangled first. Of several blocks, a `MultiBlock`, the result is a
            `LayoutAdaptResult`.
        solution: what to adapt to: a function of one argument, your solver, that takes a `Grid` and returns nodal
            values (ni, nj), or takes a `MultiBlock` and returns them by the names of blocks;
            a function of two arrays (x, y); a formula in x and y, as text or as a SymPy expression; or
            nodal values on `grid`, which are interpolated.
        functional: what is minimized. The default has a barrier; one without a barrier is kept from folding by the
            lengths of its steps alone.
        monitor: what the density of nodes is made of; a `Monitor`, its name, or your own function of the grid and the
            values.
        weight_exponent: the power of the density of nodes that the weight of the functional is; needed for functionals
            of your own.
        parameters: values of the functional's parameters.
        fields: values of the fields that the density declares, as in `optimize`.
        target: what cells should be like, beside the weight, as in `optimize`.
        max_iterations: at most so many steps.
        moves: of the nodes in each step, with the density interpolated between. By default 3 for a solver, 1 else.
        damping: how far the first step goes from the weight of the start to the one of the density, above 0 and at most
            1, by geometric means; Aitken's rule chooses it in the next steps.
        tolerance: the grid has settled when no node moves farther in a step, over the size of the domain.
        boundary: where boundary nodes slide. `straight`: along the straight stretches of every side, which changes no
            shape; `all`: along every side, on splines through its nodes between sharp turns, which cuts off what lies
            between two nodes; `fixed`: they stay. Corners and sharp turns always stay.
        fixed: (ni, nj) mask of nodes that do not move.
        callback: called with every `AdaptStep`; may raise StopIteration to stop.
        time_limit: seconds after which the best grid is returned; untangling a folded start counts. Your own solver is
            not stopped while it works.
        progress: show progress on standard error; by default where that is a terminal.
        backend: `c`, `numpy`, or one that is installed.

    Returns:
        The result; see its `status` and `message`. Ctrl-C, the callback and the time limit give the last grid whose
        solution is known.

    Raises:
        GridgenError: for input that cannot be used, for a folded start that cannot be untangled, and for a solution
            that is not finite or of another shape.
        Exception: whatever the callback raises. The attribute `result` of an error after the start holds the last grid
            whose solution is known.
    """
    check_grid(grid)
    check_size(grid)
    check_arguments(max_iterations, moves, damping, tolerance, boundary, callback, time_limit)
    deadline = Deadline(time_limit)
    definition = find_functional(functional)
    exponent = weight_exponent_of(definition.name, weight_exponent)
    source = source_of(solution, grid)
    start, note = valid_start(grid, fixed, deadline, backend)
    chosen = as_monitor(monitor)
    sides = SideSpacing(sliding_curves(start, boundary, fixed), chosen.side_exponent)
    mask = fixed_mask(grid, fixed)
    given = {"parameters": parameters, "fields": fields, "target": target}
    mover = Mover(definition, exponent, given, mask, backend, damping, sides, deadline)
    often = moves or source.moves
    found = adapted(source, chosen, mover, start, note, max_iterations, often, tolerance, callback, progress)
    assert isinstance(found, AdaptResult)
    return found
