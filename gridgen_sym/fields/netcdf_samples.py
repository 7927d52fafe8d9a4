"""Samples from netCDF files: a variable over two axes, or over points with two coordinates each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..ocean.netcdf import NetcdfFile, opened

_EAST = ({"x", "lon", "longitude", "easting"}, ("degrees_east", "degree_east"), "X")
_NORTH = ({"y", "lat", "latitude", "northing"}, ("degrees_north", "degree_north"), "Y")
#: Names of what rises upwards, where no attribute says so.
_UPWARD = {"elevation", "z", "topo", "topography", "altitude", "height", "band1", "orog", "bedrock"}


@dataclass(frozen=True, slots=True, eq=False)
class NetcdfSamples:
    """Samples of a variable.

    Attributes:
        name: of the variable.
        x: (nx,), or one for each sample (n,).
        y: (ny,), or (n,).
        values: (nx, ny), or (n,); NaN where there are none.
        upward: whether they are heights, which are positive above the sea.
    """

    name: str
    x: Array
    y: Array
    values: Array
    upward: bool


def read_samples(data: bytes, name: str = "") -> NetcdfSamples:
    """Read a variable of a netCDF file; axes of length 1, such as one time, are left out.

    Args:
        data: the file.
        name: of the variable; without it the only one over two axes is taken.

    Raises:
        GridgenError: for a damaged file, a variable that is not there, is not over two axes or has no coordinates, or
            several without a name.
        MissingExtraError: if netCDF4 is not installed.
    """
    with opened(data) as file:
        chosen = name or _only(file)
        values = file.numbers(chosen, len(data))
        dimensions = [
            one for one, size in zip(file.variables[chosen].dimensions, values.shape, strict=True) if size > 1
        ]
        values, upward = np.squeeze(values), _is_upward(file, chosen)
        if values.ndim != 2:
            shape = ", ".join(f"{one} {size}" for one, size in zip(dimensions, values.shape, strict=True))
            raise GridgenError(f"its variable {quoted(chosen)} has the axes {shape or 'of one value'}; expected two")
        if all(axis in file.variables for axis in dimensions):
            first, second = dimensions
            if _is(file, first, *_EAST) or _is(file, second, *_NORTH):
                values = values.T
                first, second = second, first
            y, x = (file.numbers(axis, len(data)) for axis in (first, second))
            x, values = _around(x, values.T)
            return NetcdfSamples(chosen, x, y, values, upward)
        x, y = (file.numbers(one, len(data)) for one in _coordinates(file, chosen))
        if x.shape != values.shape or y.shape != values.shape:
            raise GridgenError(f"the coordinates of {quoted(chosen)} have the shapes {x.shape}, {y.shape}, not its own")
        known = np.isfinite(values) & np.isfinite(x) & np.isfinite(y)
        return NetcdfSamples(chosen, x[known], y[known], values[known], upward)


def _around(x: Array, values: Array) -> tuple[Array, Array]:
    """Return samples (nx, ny) at longitudes that go around the Earth with one column more at either end.

    So nothing is missing between the last longitude and the first.
    """
    step = (x[-1] - x[0]) / max(1, len(x) - 1)
    if abs(abs(x[-1] - x[0] + step) - 360) > abs(step) / 100:
        return x, values
    turn = 360 * np.sign(step)
    wide = np.concatenate(([x[-1] - turn], x, [x[0] + turn]))
    return wide, np.concatenate((values[-1:], values, values[:1]))


def _only(file: NetcdfFile) -> str:
    """Return the only variable over two axes."""
    found = [
        name
        for name, one in file.variables.items()
        if sum(size > 1 for size in one.shape) == 2 and not _is(file, name, *_EAST) and not _is(file, name, *_NORTH)
    ]
    if len(found) != 1:
        many = ", ".join(found[:12]) or "none"
        raise GridgenError(f"name one of its variables over two axes, as in FILE.nc:NAME; they are {many}")
    return found[0]


def _coordinates(file: NetcdfFile, name: str) -> tuple[str, str]:
    """Return the variables with x and y of the points of a variable, by its attribute `coordinates`."""
    listed = [one for one in file.attribute(name, "coordinates").split() if one in file.variables]
    x = [one for one in listed if _is(file, one, *_EAST)]
    y = [one for one in listed if _is(file, one, *_NORTH)]
    if len(x) != 1 or len(y) != 1:
        raise GridgenError(
            f"its variable {quoted(name)} has no coordinates: axes with values, or an attribute that names"
        )
    return x[0], y[0]


def _is(file: NetcdfFile, name: str, names: set[str], units: tuple[str, ...], axis: str) -> bool:
    """Return whether a variable is a coordinate of a kind: by unit, by the attribute `axis`, or by name."""
    plain = name.lower().partition("_")[0]
    return file.attribute(name, "units") in units or file.attribute(name, "axis") == axis or plain in names


def _is_upward(file: NetcdfFile, name: str) -> bool:
    positive = file.attribute(name, "positive").lower()
    if positive in ("up", "down"):
        return positive == "up"
    standard = file.attribute(name, "standard_name")
    if "depth" in standard or "below" in standard:
        return False
    return "altitude" in standard or "height" in standard or name.lower() in _UPWARD
