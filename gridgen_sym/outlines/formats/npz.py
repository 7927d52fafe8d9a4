"""Outlines as NumPy archives (.npz): x and y, one number for each point."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np

from ...archives import ARCHIVE_FAULTS, read_arrays
from ...errors import GridgenError
from ..content import OutlineContent
from ..format import OutlineFormat

_AXES = (("x", "y"), ("lon", "lat"), ("longitude", "latitude"))
_CORNERS = ("corners", "beta")
_FORMS = (*((*axes, more) for axes in _AXES for more in _CORNERS), *_AXES, ("xy", "corners"), ("xy",))
_EXPECTED = "expected the arrays 'x' and 'y' (N,), or 'lon' and 'lat', and perhaps 'corners' (4,) or 'beta' (N,)"


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the outline of an archive with one-dimensional arrays, or with the array ``xy`` (N, 2).

    Raises:
        GridgenError: if the archive is damaged, or its arrays have other shapes.
    """
    arrays = read_arrays(data, _FORMS, _EXPECTED)
    corners = next((arrays[name].tolist() for name in _CORNERS if name in arrays), None)
    if "xy" in arrays:
        points, geographic = arrays["xy"], None
    else:
        axes = next(axes for axes in _AXES if axes[0] in arrays)
        x, y = (arrays[name] for name in axes)
        if x.ndim != 1 or x.shape != y.shape:
            raise GridgenError(
                f"its arrays {axes[0]} and {axes[1]} have the shapes {x.shape} and {y.shape}; {_EXPECTED}"
            )
        points, geographic = np.stack((x, y), axis=-1).astype(float), axes != _AXES[0] or None
    if points.ndim != 2:
        raise GridgenError(f"its array xy has the shape {points.shape}; {_EXPECTED}")
    return OutlineContent(points, "", corners, (), geographic)


def recognizes(data: bytes) -> bool:
    """Return whether an archive holds a curve and no grid: by the number of axes of its first coordinate."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            names = {name.removesuffix(".npy"): name for name in archive.namelist()}
            first = next((names[name] for name in ("xy", *(axes[0] for axes in _AXES)) if name in names), None)
            if first is None:
                return False
            with archive.open(first) as stream:
                head = stream.read(200)
    except ARCHIVE_FAULTS:
        return False
    shape = head.partition(b"'shape': (")[2].partition(b")")[0]
    axes = len([part for part in shape.split(b",") if part.strip()])
    return axes == (2 if first.startswith("xy") else 1)


FORMAT = OutlineFormat(
    "NumPy archive",
    (".npz",),
    decode,
    "arrays `x` and `y` (N,), or `lon` and `lat`, or `xy` (N, 2), and perhaps `corners` (4,) or `beta` (N,)",
    recognizes=recognizes,
    test="tests/outlines/test_text.py::test_archives",
)
