"""What adaptation is given, checked; and a start that is valid."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np

from ..errors import GridgenError, quoted
from ..solvers import untangle
from ..solvers.run.checks import check_time_limit
from ..solvers.run.deadline import Deadline, StopRequest
from ..solvers.run.status import StopReason
from ..topology import quality
from .mover import SomeGrid
from .run import Callback
from .sides import Boundary


def check_arguments(
    max_iterations: int,
    moves: int | None,
    damping: float,
    tolerance: float,
    boundary: str,
    callback: Callback | None,
    time_limit: float | None,
) -> None:
    """Refuse arguments out of their range.

    Raises:
        GridgenError: naming the argument, its range and what came.
    """
    for name, count, least in (("max_iterations", max_iterations, 0), ("moves", moves, 1)):
        if count is not None and (not isinstance(count, (int, np.integer)) or count < least):
            raise GridgenError(f"{name} must be a whole number, at least {least}; came {quoted(count)}")
    for name, number in (("damping", damping), ("tolerance", tolerance)):
        if not isinstance(number, (int, float, np.number)) or not 0 < number <= 1:
            raise GridgenError(f"{name} must be a number above 0 and at most 1; came {quoted(number)}")
    if boundary not in get_args(Boundary):
        raise GridgenError(f"unknown boundary {quoted(boundary)}: it is one of {', '.join(get_args(Boundary))}")
    if callback is not None and not callable(callback):
        raise GridgenError(f"callback must be a function of one AdaptStep; came {quoted(callback)}")
    check_time_limit(time_limit)


def valid_start(
    grid: SomeGrid,
    fixed: Any,  # noqa: ANN401 - what `untangle` takes for such a grid
    deadline: Deadline,
    backend: str | None,
) -> tuple[SomeGrid, str]:
    """Return the start, untangled if it was folded, and what must be reported of that."""
    if quality(grid).valid:
        return grid, ""
    refusal = "adaptation needs a valid start, and this one is folded"
    try:
        mended = untangle(grid, fixed=fixed, time_limit=deadline.check(), backend=backend)
        if mended.stopped_by is StopReason.USER:
            raise KeyboardInterrupt
        if not mended.converged:
            deadline.check()
            raise GridgenError(f"{refusal}: {mended.message}")
    except StopRequest as stop:
        raise GridgenError(f"{refusal}: {stop} before it was untangled") from stop
    return mended.grid, "The start was folded and was untangled first: "
