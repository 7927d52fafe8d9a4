"""Grid files: one table from the suffix to the functions that turn bytes into a grid and back."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..atomic import read_bytes, shown, write_bytes
from ..errors import GridgenError, MissingExtraError, quoted
from ..grids.grid import Grid
from . import cgns, npz, plot3d, tables, vtk


@dataclass(frozen=True, slots=True)
class _Format:
    """A kind of file: its name, and two functions that know nothing of the disk."""

    name: str
    decode: Callable[[bytes], Grid]
    encode: Callable[[Grid], bytes]


_FORMATS = {
    ".vts": _Format("VTK XML structured grid", vtk.decode, vtk.encode),
    ".xyz": _Format("PLOT3D grid", plot3d.decode, plot3d.encode),
    ".p2dfmt": _Format("PLOT3D plane grid", plot3d.decode, plot3d.encode_plane),
    ".csv": _Format("table of nodes", tables.decode_csv, tables.encode_csv),
    ".npz": _Format("NumPy archive", npz.decode, npz.encode),
    ".cgns": _Format("CGNS file", cgns.decode, cgns.encode),
}


def known_suffixes() -> list[str]:
    """Return the suffixes of the grid files that can be read and written."""
    return list(_FORMATS)


def read(path: str | os.PathLike[str]) -> Grid:
    """Read a grid, from the kind of file that the suffix names.

    Args:
        path: ends in ``.vts`` (VTK XML structured grid), ``.xyz`` (PLOT3D, ASCII), ``.p2dfmt`` (the same
            without z), ``.csv`` (columns i, j, x, y), ``.npz`` (NumPy archive with an array ``xy``, or ``x`` and ``y``)
            or ``.cgns`` (CGNS on HDF5). Upper and lower case are alike.

    Raises:
        GridgenError: for an unknown suffix, a file that is missing, empty, cut short or not of its kind, or
            coordinates that are no grid; the message names the path.
        MissingExtraError: for ``.cgns``, if h5py is not installed.
    """
    form = _format_of(path)
    data = read_bytes(path)
    try:
        return form.decode(data)
    except MissingExtraError:
        raise
    except GridgenError as error:
        raise GridgenError(f"cannot read {shown(path)} as a {form.name}: {error}") from error


def write(grid: Grid, path: str | os.PathLike[str]) -> None:
    """Write a grid to the kind of file that the suffix names, completely or not at all.

    Numbers have 17 significant digits (or are binary), so that reading gives back the same grid bit by bit.

    Args:
        grid: the grid.
        path: as for `read`; an existing file is replaced.

    Raises:
        GridgenError: for an unknown suffix, or a path at which no file can be written.
        MissingExtraError: for ``.cgns``, if h5py is not installed.
    """
    write_bytes(path, _format_of(path).encode(grid))


def _format_of(path: str | os.PathLike[str]) -> _Format:
    """Return the format for a path."""
    try:
        text = os.fspath(path)
    except TypeError:
        text = None
    if not isinstance(text, str) or "\0" in text:
        raise GridgenError(f"a file name must be text or a path, but is {quoted(path)}")
    suffix = Path(text).suffix.lower()
    if suffix not in _FORMATS:
        known = ", ".join(f"{key} ({form.name})" for key, form in _FORMATS.items())
        what = f"the suffix '{suffix}' is unknown" if suffix else "it has no suffix"
        raise GridgenError(f"unknown format of the grid file {shown(text)}: {what}; use one of {known}")
    return _FORMATS[suffix]
