"""Checks before a solver begins: the grid, the mask of fixed nodes, the options."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Mask
from ...errors import GridgenError, quoted
from ...grids import Grid
from .progress import Callback

#: Coordinates beyond this size overflow in densities of the fourth degree, and in their squares; grids below the other
#: underflow there.
_LARGEST, _SMALLEST = 1e30, 1e-30


def check_size(grid: Grid) -> None:
    """Refuse a grid so large or so small that the densities overflow or underflow."""
    largest = max(grid.planes.max(), -grid.planes.min())
    if largest > _LARGEST:
        raise GridgenError(
            f"the grid's coordinates reach {largest:.3g}, and powers of them overflow: scale them to "
            f"a size of about 1 (at most {_LARGEST:g} is allowed)"
        )
    extent = np.ptp(grid.planes, axis=(1, 2)).max()
    if 0 < extent < _SMALLEST:
        raise GridgenError(
            f"the grid's extent is {extent:.3g}, and powers of it underflow to zero: "
            f"scale it to a size of about 1 (at least {_SMALLEST:g} is needed)"
        )


def fixed_mask(grid: Grid, fixed: npt.ArrayLike | None) -> Mask:
    """Return the mask of nodes that do not move: the boundary, and inner nodes where `fixed` is true.

    Raises:
        GridgenError: if `fixed` has another shape than the grid.
    """
    mask = np.zeros(grid.shape, dtype=np.uint8)
    if fixed is not None:
        try:
            given: npt.NDArray[Any] = np.asarray(fixed)
        except ValueError as error:
            raise GridgenError(f"fixed must be a mask of the grid's shape {grid.shape}; came {error}") from error
        if given.shape != grid.shape or given.dtype.kind not in "biu":
            raise GridgenError(
                f"fixed must be a mask of the grid's shape {grid.shape}, true at nodes that do not move; "
                f"came shape {given.shape}, type {given.dtype}"
            )
        mask |= given != 0
    mask[0], mask[-1], mask[:, 0], mask[:, -1] = 1, 1, 1, 1
    return mask


def check_controls(
    tolerance: float, max_iterations: int | None, callback: Callback | None, time_limit: float | None
) -> None:
    """Refuse a bad tolerance, number of iterations, callback or time limit."""
    if not isinstance(tolerance, (int, float, np.number)) or not 0 < tolerance < 1:
        raise GridgenError(
            f"tolerance is the factor by which the gradient must fall: between 0 and 1; came {quoted(tolerance)}"
        )
    if max_iterations is not None and (
        isinstance(max_iterations, bool) or not isinstance(max_iterations, (int, np.integer))
    ):
        raise GridgenError(f"max_iterations must be a whole number; came {quoted(max_iterations)}")
    if max_iterations is not None and max_iterations < 0:
        raise GridgenError(f"max_iterations must not be negative; came {max_iterations}")
    if callback is not None and not callable(callback):
        raise GridgenError(f"callback must be a function of one Step; came {quoted(callback)}")
    check_time_limit(time_limit)


def check_time_limit(time_limit: float | None) -> None:
    """Refuse a bad time limit."""
    if time_limit is not None and not (isinstance(time_limit, (int, float, np.number)) and time_limit > 0):
        raise GridgenError(f"time_limit must be a positive number of seconds; came {quoted(time_limit)}")
