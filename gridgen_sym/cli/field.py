"""What the command `adapt` adapts to: a formula, or a file with a raster, samples or nodal values."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from gridgen_sym.errors import GridgenError

if TYPE_CHECKING:
    from gridgen_sym.adaptation.source import Solution

_FORMS = (
    "a .npz file has arrays x (nx,), y (ny,) and values (nx, ny), or values (ni, nj) at the nodes of the start; a .csv "
    "file has the header x,y,value and one sample per line"
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
    try:
        return _arrays(text, smooth) if suffix == ".npz" else _samples(text, smooth)
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise GridgenError(f"cannot read the field {text}: {error}. Expected: {_FORMS}") from error


def _arrays(path: str, smooth: bool) -> Solution:
    import numpy as np

    from gridgen_sym.solvers import raster_field

    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    if set(arrays) == {"values"}:
        nodal: Solution = arrays["values"]
        return nodal
    if set(arrays) != {"x", "y", "values"}:
        raise GridgenError(f"{path} holds the arrays {', '.join(sorted(arrays)) or 'none'}: {_FORMS}")
    enough = min(arrays["x"].size, arrays["y"].size) >= _FEWEST_SMOOTH
    return raster_field(arrays["x"], arrays["y"], arrays["values"], smooth=smooth and enough)


def _samples(path: str, smooth: bool) -> Solution:
    import numpy as np

    from gridgen_sym.solvers import scattered_field

    with open(path, encoding="utf-8-sig") as file:
        header = file.readline().strip().lower().replace(" ", "")
        if header != "x,y,value":
            raise GridgenError(f"{path} begins with {header!r}: {_FORMS}")
        samples = np.loadtxt(file, delimiter=",", ndmin=2)
    if samples.shape[1:] != (3,):
        raise GridgenError(f"{path} has {samples.shape[1]} columns: {_FORMS}")
    return scattered_field(samples[:, :2], samples[:, 2], smooth=smooth)
