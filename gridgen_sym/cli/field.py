"""A field on the command line: a formula, or a file with a raster, samples or nodal values."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from ..atomic import read_bytes
from ..errors import GridgenError, quoted, shortened

if TYPE_CHECKING:
    from ..fields.scalar import Source

_ARRAYS = "expected the arrays x (nx,), y (ny,) and values (nx, ny), or values (ni, nj) at the nodes of the start"
_SAMPLES = "expected the header x,y,value and one sample per line"
#: A cubic needs so many samples; its slopes are what most monitors look at.
_FEWEST_SMOOTH = 4


def field_of(text: str, *, smooth: bool) -> Source:
    """Return what `--to` or `--weight` names, as `as_scalar` takes it: a formula, samples, or numbers of one grid.

    Args:
        text: the name of a .npz or .csv file, or a formula in x and y.
        smooth: interpolate samples by cubics, whose slopes are continuous.

    Raises:
        GridgenError: for a file that cannot be read, or holds something else.
    """
    suffix = Path(text).suffix.lower()
    if suffix not in (".npz", ".csv"):
        return text
    data = read_bytes(text)
    try:
        return _arrays(data, smooth) if suffix == ".npz" else _samples(data, smooth)
    except GridgenError as error:
        raise GridgenError(f"cannot read the field {text}: {error}") from error


def _arrays(data: bytes, smooth: bool) -> Source:
    from ..fields import raster_field
    from ..io.npz import read_arrays

    arrays = read_arrays(data, (("x", "y", "values"), ("values",)), _ARRAYS)
    if "x" not in arrays:
        return arrays["values"]
    enough = min(arrays["x"].size, arrays["y"].size) >= _FEWEST_SMOOTH
    return raster_field(arrays["x"], arrays["y"], arrays["values"], smooth=smooth and enough)


def _samples(data: bytes, smooth: bool) -> Source:
    import numpy as np

    from ..fields import scattered_field

    header, _, rows = data.decode("utf-8-sig", errors="replace").partition("\n")
    if header.strip().lower().replace(" ", "") != "x,y,value":
        raise GridgenError(f"it begins with {quoted(header.strip())}; {_SAMPLES}")
    if not rows.strip():
        raise GridgenError(f"it has a header and no samples; {_SAMPLES}")
    try:
        samples = np.loadtxt(io.StringIO(rows), delimiter=",", ndmin=2)
    except ValueError as error:
        raise GridgenError(f"{shortened(error)}; {_SAMPLES}") from error
    if samples.shape[1:] != (3,):
        raise GridgenError(f"it has {samples.shape[1]} columns; {_SAMPLES}")
    return scattered_field(samples[:, :2], samples[:, 2], smooth=smooth)
