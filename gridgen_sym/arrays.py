"""The arrays that all packages exchange, and the one check of what a user gives as numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import GridgenError

#: Real numbers in double precision; the docstring of whatever takes or returns one gives its shape.
Array = NDArray[np.float64]
#: Zero or one per node.
Mask = NDArray[np.uint8]


def real_array(values: ArrayLike, what: str, *, copy: bool = True) -> Array:
    """Return `values` as float64, without `copy` perhaps themselves, or say which type came instead of real numbers.

    Raises:
        GridgenError: for ragged, complex, textual or otherwise non-numeric values, and for masked ones; `what` names
            them.
    """
    if isinstance(values, np.ma.MaskedArray) and np.any(values.mask):
        missing = int(np.sum(values.mask))
        raise GridgenError(f"{what} must all be there, but {missing} of the numbers are masked: fill them")
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "biufO":  # A complex or a textual array would be converted by NumPy, lossily.
            raise TypeError(f"numbers of type {array.dtype} came")
        with np.errstate(over="ignore"):  # A too large long double becomes inf, which is reported as such.
            return array.astype(np.float64, copy=copy)
    except (TypeError, ValueError, OverflowError) as error:
        raise GridgenError(f"{what} must be an array of real numbers: {error}") from error
