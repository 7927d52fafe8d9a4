"""What an adaptation refuses before it begins."""

from __future__ import annotations

from typing import get_args

import numpy as np

from ..errors import GridgenError, quoted
from ..grids import Grid
from ..grids.grid import check_grid
from ..solvers.run.checks import check_size, check_time_limit
from .progress import Callback
from .sides import Boundary


def check_arguments(
    grid: Grid,
    steps: int,
    moves: int | None,
    damping: float,
    tolerance: float,
    boundary: str,
    callback: Callback | None,
    time_limit: float | None,
) -> None:
    """Refuse arguments that mean nothing."""
    check_grid(grid)
    check_size(grid)
    for name, count, least in (("steps", steps, 0), ("moves", moves, 1)):
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
