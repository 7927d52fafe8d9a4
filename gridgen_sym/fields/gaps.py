"""Rasters with gaps: samples that are NaN, as where a sea's raster has land."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError


def filled(values: Array) -> tuple[Array, npt.NDArray[np.bool_] | None]:
    """Return the samples of a raster with those of the nearest place instead of NaN, and where NaN was, if anywhere.

    Distances are counted in samples.

    Raises:
        GridgenError: if there is nothing but NaN.
    """
    gaps = np.isnan(values)
    if not gaps.any():
        return values, None
    if gaps.all():
        raise GridgenError("all samples of the raster are missing (NaN): is it the part of the map that is meant?")
    from scipy.ndimage import distance_transform_edt

    nearest = distance_transform_edt(gaps, return_distances=False, return_indices=True)
    return np.asarray(values[tuple(nearest)]), gaps


def gap_at(axes: list[Array], gaps: npt.NDArray[np.bool_]) -> Callable[[Array, Array], npt.NDArray[np.bool_]]:
    """Return the function that says of points whether the nearest sample of a raster, with rising axes, is missing."""
    between = [(axis[1:] + axis[:-1]) / 2 for axis in axes]
    return lambda x, y: gaps[np.searchsorted(between[0], x), np.searchsorted(between[1], y)]
