"""Adapt a grid to a solution: solve, measure, move, and again, until the grid settles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError
from ..fields.sampled import SampledField, grid_field
from ..functionals.definition import Functional
from ..functionals.registry import functional as find_functional
from ..grids import Grid, quality
from ..solvers import untangle
from ..solvers.run.checks import fixed_mask
from ..solvers.run.deadline import Deadline, StopRequest
from ..solvers.run.status import StopReason
from .checks import check_arguments
from .equidistribution import cell_areas, cell_means, equidistribution, variation
from .error_estimate import hierarchical_error
from .law import law_of
from .monitor import Measure, Monitor, as_monitor
from .mover import Mover, movement
from .progress import Callback, Live
from .result import AdaptResult, AdaptStep
from .sides import Boundary, sliding_sides
from .source import Solution, Source, source_of


def adapt(
    grid: Grid,
    solution: Solution,
    *,
    functional: str | Functional = "area_winslow",
    monitor: Monitor | str | Measure = "curvature",
    power: float | None = None,
    parameters: Mapping[str, float] | None = None,
    steps: int = 30,
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

    Each step solves on the present grid, lets the monitor make a density of nodes of the solution, and minimises the
    functional with the weight of that density. The weight is held at the nodes and moves with them, so this is a fixed
    point and not one minimisation; from step to step the weight is damped.

    Args:
        grid: the start. A folded one is untangled first.
        solution: what to adapt to: a function of one argument, your solver, that takes a `Grid` and returns nodal
            values (ni, nj); a function of two arrays (x, y); a formula in x and y, as text or as a SymPy expression; or
            nodal values on `grid`, which are interpolated.
        functional: what is minimised. The default has a barrier; one without a barrier is kept from folding by the
            lengths of its steps alone.
        monitor: what the density of nodes is made of; a `Monitor`, its name, or your own function of the grid and the
            values.
        power: of the density that the weight must be, for functionals of your own (see the module `law`).
        parameters: of the functional.
        steps: at most so many steps.
        moves: of the nodes in each step, with the density interpolated between. By default 3 for a solver, 1 else.
        damping: the share of the wanted weight in the first one (a geometric mean with that of the start), above 0
            and at most 1; Aitken's rule chooses those of the next steps.
        tolerance: the grid has settled when no node moves farther in a step, over the size of the domain.
        boundary: `straight`: nodes slide along straight sides, where that changes no shape; `all`: along the polygon
            of every side, which cuts off what little lies between two nodes; `fixed`: they stay. Corners always stay.
        fixed: (ni, nj) mask of inner nodes that do not move; a side with such nodes does not slide.
        callback: called with every `AdaptStep`; may raise StopIteration to stop.
        time_limit: seconds after which to stop. Your own solver is not stopped while it works.
        progress: show progress on standard error; by default where that is a terminal.
        backend: `c` or `numpy`.

    Returns:
        The result; see its `converged` and `message`. Ctrl-C, the callback and the time limit give the last grid whose
        solution is known.

    Raises:
        GridgenError: for input that cannot be used, for a folded start that cannot be untangled, and for a solution
            that is not finite or of another shape.
        Exception: whatever the callback raises. The attribute `result` of an error after the start holds the last grid
            whose solution is known.
    """
    check_arguments(grid, steps, moves, damping, tolerance, boundary, callback, time_limit)
    deadline = Deadline(time_limit)
    definition = find_functional(functional)
    law = law_of(definition.name, power)
    source = source_of(solution, grid)
    start, said = _valid_start(grid, fixed, time_limit, backend)
    sides = sliding_sides(start, boundary, fixed)
    mover = Mover(definition, law, parameters, fixed_mask(grid, fixed), backend, damping, sides, deadline)
    run = _Run(source, as_monitor(monitor), mover, start)
    with Live(f"adapt, {definition.name}", callback, progress) as live:
        converged, stopped_by, message = run.until_ended(steps, moves or source.moves, tolerance, live)
    return run.result(converged, said + message, stopped_by)


@dataclass(slots=True)
class _Run:
    """The state of one adaptation: the last grid whose solution is known, that solution and its density."""

    source: Source
    monitor: Monitor
    mover: Mover
    start: Grid
    grid: Grid = field(init=False)
    values: Array = field(init=False)
    density: Array = field(init=False)
    history: list[AdaptStep] = field(default_factory=list)
    carried: SampledField | None = None

    def until_ended(self, steps: int, moves: int, tolerance: float, live: Live) -> tuple[bool, StopReason | None, str]:
        """Adapt; return whether the grid has settled, what ended this early, and why it stopped."""
        last = "this is the last grid whose solution is known."
        try:
            return self._until_settled(steps, moves, tolerance, live)
        except StopRequest as stop:
            return False, stop.by, f"{stop}; {last}"
        except KeyboardInterrupt:
            if not self.history:
                raise
            return False, StopReason.USER, f"it was interrupted; {last}"
        except Exception as error:
            if self.history:
                error.result = self.result(False, f"an error stopped it; {last}", StopReason.CALLBACK)  # type: ignore[attr-defined]
                error.add_note("Its attribute 'result' holds the last adapted grid whose solution is known.")
            raise

    def _until_settled(
        self, steps: int, moves: int, tolerance: float, live: Live
    ) -> tuple[bool, StopReason | None, str]:
        """Adapt until nothing moves, for so many steps at most."""
        live.tell(self._take(self.start, 0.0))
        if not steps:
            return False, None, "no step was allowed: this is the start."
        for _ in range(steps):
            moved = self.mover.towards(self.grid, self.density, moves)
            way = movement(self.grid, moved)
            live.tell(self._take(moved, way))
            if way <= tolerance:
                return self._settled(way)
        way = self.history[-1].movement
        return (
            False,
            None,
            (
                f"the grid has not settled in {steps} steps: the last one moved a node by {way:.1e}, more than "
                f"{tolerance:.1e} of the domain's size. Allow more steps, a smaller share or more smoothing."
            ),
        )

    def _settled(self, way: float) -> tuple[bool, None, str]:
        """Return what to say of a grid whose nodes no longer move: that can mean that they cannot."""
        if not self.mover.trouble:
            return True, None, f"the grid has settled: its last step moved no node by more than {way:.1e}."
        name = self.mover.functional.name
        return False, None, f"nodes move no farther, but {name} is not minimised: {self.mover.trouble}"

    def _take(self, grid: Grid, way: float) -> AdaptStep:
        """Solve on a grid and make it the present one."""
        values = self.source.on(grid, len(self.history))
        if self.carried is not None:
            density = self.carried(grid.x, grid.y)
        else:
            density = self.monitor.density(grid, values)
            if self.source.sampled:
                # Derivatives of interpolated values would show the interpolation: this density is carried along.
                self.carried = grid_field(grid, density)
        self.grid, self.values, self.density = grid, values, density
        step = AdaptStep(
            step=len(self.history),
            movement=way,
            error=float(np.linalg.norm(hierarchical_error(grid, values))),
            spread=variation(cell_means(density) * cell_areas(grid)),
            min_jacobian=quality(grid).min_jacobian,
            damping=self.mover.damping,
        )
        self.history.append(step)
        return step

    def result(self, converged: bool, message: str, stopped_by: StopReason | None) -> AdaptResult:
        """Return what was found."""
        if self.monitor.measure != "values":  # There the density was given, and no solution.
            first, last = self.history[0].error, self.history[-1].error
            message += f" The estimated error of interpolation was {first:.2e}, now it is {last:.2e}."
        if np.ptp(self.values) == 0:
            message += f" The solution is {self.values[0, 0]:g} at every node: there is nothing to adapt to."
        return AdaptResult(
            grid=self.grid,
            values=self.values,
            density=self.density,
            converged=converged,
            message=message,
            history=tuple(self.history),
            before=equidistribution(self.start, grid_field(self.grid, self.density)(self.start.x, self.start.y)),
            after=equidistribution(self.grid, self.density),
            stopped_by=stopped_by,
        )


def _valid_start(
    grid: Grid, fixed: npt.ArrayLike | None, time_limit: float | None, backend: str | None
) -> tuple[Grid, str]:
    """Return the start, untangled if it was folded, and what must be said of that."""
    if quality(grid).valid:
        return grid, ""
    mended = untangle(grid, fixed=fixed, time_limit=time_limit, backend=backend)
    if mended.stopped_by is StopReason.USER:
        raise KeyboardInterrupt
    if not mended.converged:
        raise GridgenError(f"adaptation needs a valid start, and this one is folded: {mended.message}")
    return mended.grid, "The start was folded and was untangled first: "
