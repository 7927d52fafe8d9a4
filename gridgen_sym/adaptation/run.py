"""The loop of an adaptation: its state, its progress, and how it ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Array
from ..fields.sampled import SampledField, grid_field
from ..grids import Grid
from ..solvers.run.deadline import StopRequest
from ..solvers.run.live import LiveLine
from ..solvers.run.status import Outcome, Status, StopReason
from ..topology import MultiBlock, quality
from .equidistribution import variation
from .layout_nodes import nodes_of
from .monitor import ROUNDING, Monitor
from .mover import Mover, movement
from .result import AdaptResult, AdaptStep, LayoutAdaptResult, change_of
from .source import Source

#: Monitors to be tried where another one made the grid worse.
_ADVISED = ("curvature", "recovery_error")

Callback = Callable[[AdaptStep], None]


class Live(LiveLine):
    """Hands steps on to a callback, and shows them."""

    def __init__(self, title: str, callback: Callback | None, show: bool | None) -> None:
        """Begin; `show` is by default whether standard error is a terminal."""
        super().__init__(title, show)
        self._callback = callback

    def report(self, step: AdaptStep) -> None:
        """Report a step to the callback, and show it.

        Raises:
            StopRequest: if the callback asks for it.
        """
        if self._callback is not None:
            try:
                self._callback(step)
            except StopIteration:
                raise StopRequest(StopReason.CALLBACK, "the callback stopped it") from None
        self.display(
            f"step {step.step}, movement {step.movement:.1e}, estimated error {step.error:.2e}, "
            f"spread {step.spread:.2f}, smallest J {step.min_jacobian:.1e}"
        )


def adapted(
    source: Source,
    monitor: Monitor,
    mover: Mover,
    start: Grid | MultiBlock,
    note: str,
    max_iterations: int,
    moves: int,
    tolerance: float,
    callback: Callback | None,
    progress: bool | None,
) -> AdaptResult | LayoutAdaptResult:
    """Adapt a valid start; the message of the result begins with a note."""
    run = Run(source, monitor, mover, start)
    with Live(f"adapt, {mover.functional.name}", callback, progress) as live:
        outcome = run.until_ended(max_iterations, moves, tolerance, live)
    return run.result(Outcome(outcome.status, note + outcome.message))


@dataclass(slots=True)
class Run:
    """The state of one adaptation: the last grid whose solution is known, that solution and its density."""

    source: Source
    monitor: Monitor
    mover: Mover
    start: Any  # A Grid or a MultiBlock, and so is the last one.
    grid: Any = field(init=False)
    values: Array = field(init=False)
    density: Array = field(init=False)
    history: list[AdaptStep] = field(default_factory=list)
    carried: SampledField | None = None

    def until_ended(self, max_iterations: int, moves: int, tolerance: float, live: Live) -> Outcome:
        """Adapt; return how and why it ended."""
        last = "this is the last grid whose solution is known."
        try:
            return self._until_settled(max_iterations, moves, tolerance, live)
        except StopRequest as stop:
            return Outcome(Status.stopped(stop.by), f"{stop}; {last}")
        except KeyboardInterrupt:
            if not self.history:
                raise
            return Outcome(Status.STOPPED_BY_USER, f"it was interrupted; {last}")
        except Exception as error:
            if self.history:
                ended = Outcome(Status.STOPPED_BY_ERROR, f"an error stopped it; {last}")
                error.result = self.result(ended)  # type: ignore[attr-defined]
                error.add_note("Its attribute 'result' holds the last adapted grid whose solution is known.")
            raise

    def _until_settled(self, max_iterations: int, moves: int, tolerance: float, live: Live) -> Outcome:
        """Adapt until nothing moves, for so many steps at most."""
        live.report(self._solve_on(self.start, 0.0))
        if not max_iterations:
            return Outcome(Status.ITERATION_LIMIT, "no step was allowed: this is the start.")
        for _ in range(max_iterations):
            moved = self.mover.toward(self.grid, self.density, moves)
            distance = movement(self.grid, moved)
            live.report(self._solve_on(moved, distance))
            if distance <= tolerance:
                return self._settled(distance)
        return Outcome(
            Status.ITERATION_LIMIT,
            f"the grid has not settled in {max_iterations} steps: the last one moved a node by "
            f"{self.history[-1].movement:.1e}, more than {tolerance:.1e} of the domain's size. Allow more "
            "with max_iterations, a smaller feature_fraction or more smoothing.",
        )

    def _settled(self, distance: float) -> Outcome:
        """Return the outcome for a grid whose nodes no longer move: that can mean that they cannot."""
        if self.mover.failure:
            name = self.mover.functional.name
            why = f"nodes move no farther, but {name} is not minimized: {self.mover.failure}"
            return Outcome(Status.STALLED, why)
        message = f"the grid has settled: its last step moved no node by more than {distance:.1e}."
        size = float(np.abs(self.values).max()) * float(np.sqrt(nodes_of(self.grid).areas.sum()))
        least = max(self.history[0].error, ROUNDING * size)
        if not self._estimates or self.history[-1].error <= least:
            return Outcome(Status.CONVERGED, message)
        others = [repr(name) for name in _ADVISED if name != self.monitor.measure]
        return Outcome(
            Status.WORSE,
            f"{message} But it is worse than the start by its own estimate: the monitor {self.monitor.name} does not "
            "suit this solution, or the start is too coarse to show it. Take monitor="
            f"{' or '.join(others)}, or more nodes.",
        )

    @property
    def _estimates(self) -> bool:
        """Whether the history holds estimates of an error: of a density that is given there is none."""
        return self.monitor.measure != "values"

    def _solve_on(self, grid: Any, distance: float) -> AdaptStep:  # noqa: ANN401
        """Solve on a grid and make it the present one."""
        values, nodes = self.source.on(grid, len(self.history)), nodes_of(grid)
        if self.carried is not None:
            density = self.carried(nodes.x, nodes.y)
        else:
            density = self.monitor.density_at(nodes, values)
            if self.source.sampled:
                # Derivatives of interpolated values would show the interpolation: this density is carried along.
                self.carried = grid_field(grid, density)
        self.grid, self.values, self.density = grid, values, density
        step = AdaptStep(
            step=len(self.history),
            movement=distance,
            error=float(np.linalg.norm(nodes.hierarchical_error(values))),
            spread=variation(nodes.cell_means(density) * nodes.areas),
            min_jacobian=quality(grid).min_jacobian,
            damping=self.mover.damping,
        )
        self.history.append(step)
        return step

    def result(self, outcome: Outcome) -> AdaptResult | LayoutAdaptResult:
        """Return what was found."""
        message = outcome.message
        if self._estimates:
            first, last = self.history[0].error, self.history[-1].error
            message += f" The estimated error of interpolation was {first:.2e}, now it is {last:.2e}."
        if np.ptp(self.values) == 0:
            message += f" The solution is {self.values.flat[0]:g} at every node: there is nothing to adapt to."
        told: dict[str, Any] = {"status": outcome.status, "history": tuple(self.history)}
        if isinstance(self.grid, MultiBlock):
            back = nodes_of(self.grid).given_back
            found = {"values": back(self.values), "density": back(self.density)}
            return LayoutAdaptResult(grid=self.grid, start=self.start, message=message, **found, **told)
        message = f"{message} {change_of(self.start, self.grid).warning}".rstrip()
        return AdaptResult(
            grid=self.grid, start=self.start, values=self.values, density=self.density, message=message, **told
        )
