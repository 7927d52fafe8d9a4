"""Formulas and files of samples on the command line: rasters and points, in .npz, .csv and netCDF."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..atomic import read_bytes
from ..errors import GridgenError, MissingExtraError, quoted, shortened
from ..messages import report

if TYPE_CHECKING:
    from ..fields import SampledField
    from ..fields.netcdf_samples import NetcdfSamples
    from ..fields.outside import Outside
    from ..geography import Projection

#: Suffixes of netCDF files, of which a variable is named: bathy.nc:depth.
_NETCDF = (".nc", ".nc4", ".cdf", ".grd")
_FILES = (
    "a field is a formula in x and y, FILE.nc:VARIABLE, or a .npz or .csv file with a raster, samples or values at the "
    "nodes"
)
_ARRAYS = "expected the arrays x (nx,), y (ny,) and values (nx, ny), or values (ni, nj) at the nodes of the start"
_SAMPLES = "expected the header x,y,value and one sample per line"
#: A cubic needs so many samples; its slopes are what most monitors look at.
_FEWEST_SMOOTH = 4


def source_of(text: str, *, smooth: bool, outside: Outside, projection: Projection | None = None) -> Any:  # noqa: ANN401
    """Return a formula as it is, and what a file holds; a tuple of what has several values per sample.

    Args:
        text: a formula, or the name of a file.
        smooth: interpolate samples by cubics, whose slopes are continuous.
        outside: whether nodes outside of samples are refused, or have the nearest value.
        projection: onto the plane, of files whose samples are in longitude and latitude.

    Raises:
        GridgenError: for a file that cannot be read, or holds something else.
    """
    return _placed(_source(text, smooth, outside), projection)


def _source(text: str, smooth: bool, outside: Outside) -> Any:  # noqa: ANN401
    if _netcdf_name(text)[0]:
        return _netcdf_field(text, smooth, outside)
    suffix = Path(text).suffix.lower()
    if suffix not in (".npz", ".csv"):
        if _is_other_file(text, suffix):
            raise GridgenError(f"cannot read the field {shortened(text)}: {_FILES}")
        return text
    data = read_bytes(text)
    try:
        return (_arrays if suffix == ".npz" else _samples)(data, smooth, outside)
    except GridgenError as error:
        raise GridgenError(f"cannot read the field {text}: {error}") from error


def depth_of(text: str, outside: Outside, projection: Projection | None) -> SampledField:
    """Return the depth that a file holds, positive downwards; heights of a netCDF file are turned, and reported.

    Raises:
        GridgenError: for what is no file of samples.
    """
    from ..fields import SampledField
    from ..fields.sampled import negative

    found = source_of(text, smooth=False, outside=outside, projection=projection)
    if not isinstance(found, SampledField):
        raise GridgenError(
            f"--depth takes a file with a raster or samples, such as bathy.nc:depth; came {quoted(text)}"
        )
    name, _ = _netcdf_name(text)
    if name and _netcdf_samples(text).upward:
        report(f"{text} holds heights, positive upwards: depths are taken as their negatives")
        return negative(found)
    return found


def _placed(found: Any, projection: Projection | None) -> Any:  # noqa: ANN401
    """Return samples in longitude and latitude as a field of the plane; what has no samples as it is."""
    from ..fields import SampledField

    if projection is None:
        return found
    if isinstance(found, tuple):
        return tuple(_placed(one, projection) for one in found)
    return found.on_plane(projection) if isinstance(found, SampledField) else found


def _is_other_file(text: str, suffix: str) -> bool:
    """Return whether a text names a file that holds no field, and not a formula."""
    from ..io import known_suffixes

    return suffix in known_suffixes() or (os.path.isfile(text) and not _is_formula(text))


def _is_formula(text: str) -> bool:
    from ..fields.field import VARIABLES
    from ..fields.formula import Formula

    for variables in VARIABLES.values():
        try:
            Formula(text, variables)
        except GridgenError:
            continue
        return True
    return False


def _arrays(data: bytes, smooth: bool, outside: Outside) -> Any:  # noqa: ANN401
    from ..archives import read_arrays
    from ..fields import raster_field

    arrays = read_arrays(data, (("x", "y", "values"), ("values",)), _ARRAYS)
    if "x" not in arrays:
        return arrays["values"]
    x, y, values = (arrays[name] for name in ("x", "y", "values"))
    cubic = smooth and min(x.size, y.size) >= _FEWEST_SMOOTH
    if values.ndim == 3:
        return tuple(raster_field(x, y, one, smooth=cubic, outside=outside) for one in values)
    return raster_field(x, y, values, smooth=cubic, outside=outside)


def _samples(data: bytes, smooth: bool, outside: Outside) -> Any:  # noqa: ANN401
    import numpy as np

    from ..fields import scattered_field

    header, _, rows = data.decode("utf-8-sig", errors="replace").partition("\n")
    columns = header.strip().lower().replace(" ", "").split(",")
    places = columns[:2] in (["x", "y"], ["lon", "lat"], ["longitude", "latitude"])
    if not places or len(columns) < 3 or (len(columns) == 3 and columns[2] != "value"):
        raise GridgenError(f"it begins with {quoted(header.strip())}; {_SAMPLES}")
    if not rows.strip():
        raise GridgenError(f"it has a header and no samples; {_SAMPLES}")
    try:
        samples = np.loadtxt(io.StringIO(rows), delimiter=",", ndmin=2)
    except ValueError as error:
        raise GridgenError(f"{shortened(error)}; {_SAMPLES}") from error
    if samples.shape[1:] != (len(columns),):
        raise GridgenError(f"it has {samples.shape[1]} columns; {_SAMPLES}")
    points = samples[:, :2]
    made = tuple(scattered_field(points, one, smooth=smooth, outside=outside) for one in samples[:, 2:].T)
    return made if len(made) > 1 else made[0]


def _netcdf_name(text: str) -> tuple[str, str]:
    """Return file and variable of `FILE.nc:VARIABLE`; no file for other texts."""
    path, colon, variable = text.rpartition(":")
    file, name = (path, variable) if colon and Path(path).suffix.lower() in _NETCDF else (text, "")
    return (file, name.strip()) if Path(file).suffix.lower() in _NETCDF else ("", "")


def _netcdf_samples(text: str) -> NetcdfSamples:
    """Return the samples of `FILE.nc:VARIABLE`."""
    from ..fields.netcdf_samples import read_samples

    path, name = _netcdf_name(text)
    data = read_bytes(path)
    try:
        return read_samples(data, name)
    except MissingExtraError:
        raise
    except GridgenError as error:
        raise GridgenError(f"cannot read the field {text}: {error}") from error


def _netcdf_field(text: str, smooth: bool, outside: Outside) -> Any:  # noqa: ANN401
    """Return the field that the samples of a netCDF file make."""
    import numpy as np

    from ..fields import raster_field, scattered_field

    found = _netcdf_samples(text)
    if found.values.ndim == 1:
        return scattered_field(np.stack((found.x, found.y), axis=-1), found.values, smooth=smooth, outside=outside)
    cubic = smooth and min(found.values.shape) >= _FEWEST_SMOOTH
    return raster_field(found.x, found.y, found.values, smooth=cubic, outside=outside)
