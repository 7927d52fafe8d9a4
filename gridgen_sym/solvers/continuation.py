"""Continuation in a parameter: minimize a functional for one value after the other, each from the last grid."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from ..errors import GridgenError, quoted
from ..functionals.definition import Functional
from ..functionals.registry import functional as find_functional
from ..grids import Change, Grid
from ..grids.grid import check_grid
from .optimize import optimize
from .run.checks import check_controls
from .run.deadline import Deadline, StopRequest
from .run.live import LiveLine
from .run.progress import Callback
from .run.result import Result, Step
from .run.status import Status

#: A step that ends so has no minimum, and the next value would start from no better grid.
_FAILURES = (Status.DIVERGED, Status.NOT_DIFFERENTIABLE)


@dataclass(frozen=True, slots=True)
class ContinuationResult(Result):
    """The grid of the last value of the parameter that was reached, and what led to it.

    Attributes:
        parameter: the name of the parameter that was varied.
        steps: (value, result of `optimize`) of every value that was tried; a failed one is the last.
    """

    parameter: str = ""
    steps: tuple[tuple[float, Result], ...] = ()


def continuation(
    grid: Grid,
    functional: str | Functional,
    parameter: str,
    values: Iterable[float] | None = None,
    *,
    start: float | None = None,
    stop: float | None = None,
    steps: int = 8,
    parameters: Mapping[str, float] | None = None,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    **options: Any,  # noqa: ANN401 - those of `optimize`, which checks them
) -> ContinuationResult:
    """Minimize a functional for one value of a parameter after the other, each time from the last grid.

    For functionals whose minimum at the last value is hard to reach at once, such as `quasi_harmonic` with a small
    omega. A step that fails ends it, and the grid of the step before is returned; so does a step that would fold a
    valid grid, unless `keep_valid=False` allows that.

    Args:
        grid: the start.
        functional: what is minimized: a `Functional`, or its name.
        parameter: the name of the parameter that is varied.
        values: its values, in order; or else give `start` and `stop`.
        start: the first value.
        stop: the last value.
        steps: number of values from `start` to `stop`, at least 2: in geometric progression where both are of one
            sign, else in equal steps.
        parameters: the other parameters of the functional.
        callback: as in `optimize`, for the steps of every value.
        time_limit: seconds for all values together, after which the best grid is returned.
        progress: show progress on standard error; by default where that is a terminal.
        options: what else `optimize` takes: `method`, `weight`, `fields`, `target`, `keep_valid`, ...

    Returns:
        The grid of the last value that was reached. `status` is that of the last step, also of one that has failed;
        `message` names its value.

    Raises:
        GridgenError: for input that cannot be used.
    """
    check_grid(grid)
    definition = find_functional(functional)
    check_controls(0.5, None, callback, time_limit)
    others = dict(parameters or {})
    given = _values(values, start, stop, steps)
    for value in given:  # Before anything is solved.
        definition.values({**others, parameter: value})
    deadline = Deadline(time_limit)
    done: list[tuple[float, Result]] = []

    def ended(kept: Result, status: Status, message: str) -> ContinuationResult:
        change = _since(done[0][1], kept)
        if change is not None:
            message = f"{message} {change.warning}".rstrip()
        own = {field.name: getattr(kept, field.name) for field in fields(Result)}
        own |= {"status": status, "message": message, "converged": status is Status.CONVERGED, "change": change}
        return ContinuationResult(**own, parameter=parameter, steps=tuple(done))

    with LiveLine(f"{definition.name}, {parameter}", progress) as line:
        for number, value in enumerate(given, 1):
            last = done[-1][1] if done else None
            try:
                left = deadline.check()
            except StopRequest as stopped:
                assert last is not None  # There is time for the first value.
                return ended(last, Status.stopped(stopped.by), f"{stopped}, before {parameter} = {value:g}.")
            result = optimize(
                grid if last is None else last.grid,
                definition,
                parameters={**others, parameter: value},
                callback=_shown(line, f"{value:g} ({number} of {len(given)})", callback),
                time_limit=None if time_limit is None else left,
                progress=False,
                **options,
            )
            done.append((value, result))
            message = f"{parameter} = {value:g}: {_without_warning(result)}"
            folds = last is not None and last.quality.valid and not result.quality.valid
            if last is not None and folds and options.get("keep_valid") is not False:
                return ended(last, Status.FOLDED, f"{message} It would fold a valid grid, which is returned as it was.")
            if last is not None and result.status in _FAILURES:
                return ended(last, result.status, f"{message} The grid is that of {parameter} = {done[-2][0]:g}.")
            if result.interrupted or result.status in _FAILURES:
                break
    return ended(result, result.status, message)


def _since(first: Result, last: Result) -> Change | None:
    """Return the change from the start of one result to the grid of a later one."""
    if first.change is None or last.change is None:
        return None
    return replace(last.change, before=first.change.before)


def _without_warning(result: Result) -> str:
    """Return the message of a step without what it says of the step before."""
    return result.message.removesuffix(result.change.warning).rstrip() if result.change else result.message


def _shown(line: LiveLine, head: str, callback: Callback | None) -> Callback:
    """Return a callback that shows every step on a line, and then calls the user's."""

    def show(step: Step) -> None:
        line.display(f"{head}, {step.stage}, iteration {step.iteration}, smallest J {step.min_jacobian:.2e}")
        if callback is not None:
            callback(step)

    return show


def _values(values: Iterable[float] | None, start: float | None, stop: float | None, steps: int) -> tuple[float, ...]:
    """Return the values of the parameter.

    Raises:
        GridgenError: where they are not numbers, there is none, or it is not clear which are meant.
    """
    ends = start is not None and stop is not None
    if (values is None) != ends or (values is not None and (start, stop) != (None, None)):
        raise GridgenError(
            "give either the values of the parameter, such as [1, 0.1, 0.01], or both start= and stop=; came "
            f"values={quoted(values)}, start={quoted(start)}, stop={quoted(stop)}"
        )
    if isinstance(steps, bool) or not isinstance(steps, (int, np.integer)) or (ends and steps < 2):
        raise GridgenError(f"steps is the number of values from start to stop, at least 2; came {quoted(steps)}")
    try:
        if values is not None:
            found = np.array([float(value) for value in values])
        else:
            between: Callable[..., Any] = np.geomspace if start * stop > 0 else np.linspace  # type: ignore[operator]
            found = between(float(start), float(stop), steps)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        came = values if values is not None else (start, stop)
        raise GridgenError(f"the values of the parameter must be numbers; came {quoted(came)}") from None
    if not len(found) or not np.isfinite(found).all():
        raise GridgenError(f"the values of the parameter must be one or more finite numbers; came {quoted(values)}")
    return tuple(map(float, found))
