"""What the command `adapt` adapts to: a formula, or a file with a raster, samples or nodal values."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from ..atomic import read_bytes
from ..errors import GridgenError

if TYPE_CHECKING:
    from ..adaptation.source import Solution

_FORMS = (
    "Expected: a .npz file has arrays x (nx,), y (ny,) and values (nx, ny), or values (ni, nj) at the nodes of the "
    "start; a .csv file has the header x,y,value and one sample per line"
)
#: A cubic needs so many samples; its slopes are what most monitors look at.
_FEWEST_SMOOTH = 4


def field_of(text: str, *, smooth: bool) -> Solution:
    """Return what `--to` names: a function of x and y, a formula or nodal values.

    Args:
        text: the name of a .npz or .csv file, or a formula in x and y.
        smooth: interpolate samples by cubics, whose slopes are continuous.

    Raises:
        GridgenError: for a file that cannot be read, or holds something else.
    """
    suffix = Path(text).suffix.lower()
    if suffix not in (".npz", ".csv"):
        return text
    data = io.BytesIO(read_bytes(text))
    try:
        return _arrays(data, smooth) if suffix == ".npz" else _samples(data, smooth)
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise GridgenError(f"cannot read the field {text}: {error}. {_FORMS}") from error


def _arrays(data: io.BytesIO, smooth: bool) -> Solution:
    import numpy as np

    from ..fields import raster_field

    with np.load(data) as file:
        arrays = {name: file[name] for name in file.files}
    if set(arrays) == {"values"}:
        nodal: Solution = arrays["values"]
        return nodal
    if set(arrays) != {"x", "y", "values"}:
        raise GridgenError(f"it holds the arrays {', '.join(sorted(arrays)) or 'none'}")
    enough = min(arrays["x"].size, arrays["y"].size) >= _FEWEST_SMOOTH
    return raster_field(arrays["x"], arrays["y"], arrays["values"], smooth=smooth and enough)


def _samples(data: io.BytesIO, smooth: bool) -> Solution:
    import numpy as np

    from ..fields import scattered_field

    header, _, rows = data.getvalue().decode("utf-8-sig", errors="replace").partition("\n")
    if header.strip().lower().replace(" ", "") != "x,y,value":
        raise GridgenError(f"it begins with {header.strip()[:60]!r}")
    if not rows.strip():
        raise GridgenError("it has a header and no samples")
    samples = np.loadtxt(io.StringIO(rows), delimiter=",", ndmin=2)
    if samples.shape[1:] != (3,):
        raise GridgenError(f"it has {samples.shape[1]} columns")
    return scattered_field(samples[:, :2], samples[:, 2], smooth=smooth)
