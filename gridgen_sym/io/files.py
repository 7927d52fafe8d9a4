"""Grid files: one table from the suffix to the functions that turn bytes into grids and back."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

from ..atomic import check_target, file_name, read_bytes, shown, write_bytes, write_folder
from ..errors import GridgenError, MissingExtraError
from ..grids.grid import Grid, check_grid
from . import cgns, npz, plot3d, tables, vtk, vtm

if TYPE_CHECKING:
    from ..topology import MultiBlock


@dataclass(frozen=True, slots=True)
class _Format:
    """A kind of file: its name, two functions that know nothing of the disk, and whether it can hold several blocks."""

    name: str
    decode: Callable[[bytes], Grid | list[Grid]]
    encode: Callable[..., bytes]
    several: bool = False


_FORMATS = {
    ".vts": _Format("VTK XML structured grid", vtk.decode, vtk.encode),
    ".xyz": _Format("PLOT3D grid", plot3d.decode, plot3d.encode, several=True),
    ".p2dfmt": _Format("PLOT3D plane grid", plot3d.decode, plot3d.encode_plane, several=True),
    ".csv": _Format("table of nodes", tables.decode_csv, tables.encode_csv),
    ".npz": _Format("NumPy archive", npz.decode, npz.encode),
    ".cgns": _Format("CGNS file", cgns.decode, cgns.encode),
}
#: Its blocks are files of their own.
_FOLDED = ".vtm"


def known_suffixes() -> list[str]:
    """Return the suffixes of the grid files that can be read and written."""
    return [*_FORMATS, _FOLDED]


def check_holds(path: str | os.PathLike[str], blocks: int) -> None:
    """Raise a `GridgenError` unless a file with the suffix of `path` can hold so many blocks."""
    suffix = _suffix_of(path)
    if blocks > 1 and suffix != _FOLDED and not _FORMATS[suffix].several:
        known = ", ".join([key for key, form in _FORMATS.items() if form.several] + [_FOLDED])
        raise GridgenError(
            f"cannot write {shown(path)}: a {_FORMATS[suffix].name} holds one block, and here are {blocks}; use one "
            f"of {known}, or write each of layout.blocks"
        )


@overload
def read(path: str | os.PathLike[str], *, layout: Literal[True]) -> MultiBlock: ...


@overload
def read(path: str | os.PathLike[str], *, layout: bool = False) -> Grid | Any: ...  # noqa: ANN401


def read(path: str | os.PathLike[str], *, layout: bool = False) -> Grid | MultiBlock | Any:
    """Read a grid of one or several blocks, from the kind of file that the suffix names.

    Args:
        path: ends in ``.vts`` (VTK XML structured grid), ``.xyz`` (PLOT3D, ASCII), ``.p2dfmt`` (the same
            without z), ``.csv`` (columns i, j, x, y), ``.npz`` (NumPy archive with an array ``xy``, or ``x`` and
            ``y``), ``.cgns`` (CGNS on HDF5) or ``.vtm`` (VTK XML, several blocks). Upper and lower case are alike.
        layout: return a `MultiBlock` also for a file of one block, so that its cut, as of a C-grid, is connected.

    Returns:
        A `Grid` for a file of one block, a `MultiBlock` for one of several. The connections and names of boundaries of
        a `MultiBlock` are those of the neutral map file (``.nmf``) of the same name in the same folder; where there is
        none, nodes that coincide are connected.

    Raises:
        GridgenError: for an unknown suffix, a file that is missing, empty, cut short or not of its kind,
            coordinates that are no grid, or a neutral map file that does not fit the blocks; the message names the
            path.
        MissingExtraError: for ``.cgns``, if h5py is not installed.
    """
    if _suffix_of(path) == _FOLDED:
        names, blocks = _read_folded(Path(path))
    else:
        names, blocks = None, _read_blocks(path)
    if len(blocks) == 1 and not layout:
        return blocks[0]
    from .layouts import assembled

    return assembled(blocks, path, names)


def _read_blocks(path: str | os.PathLike[str]) -> list[Grid]:
    """Return the blocks of one file."""
    form = _FORMATS[_suffix_of(path)]
    data = read_bytes(path)
    try:
        found = form.decode(data)
    except MissingExtraError:
        raise
    except GridgenError as error:
        raise GridgenError(f"cannot read {shown(path)} as a {form.name}: {error}") from error
    return [found] if isinstance(found, Grid) else found


def _read_folded(path: Path) -> tuple[list[str], list[Grid]]:
    """Return names and blocks of a file that names those of the blocks."""
    try:
        files = vtm.decode(read_bytes(path))
    except GridgenError as error:
        raise GridgenError(f"cannot read {shown(path)} as a VTK XML multi-block file: {error}") from error
    return list(files), [block for file in files.values() for block in _read_blocks(path.parent / file)]


def write(grid: Grid | MultiBlock, path: str | os.PathLike[str]) -> None:
    """Write a grid to the kind of file that the suffix names, completely or not at all.

    Numbers have 17 significant digits (or are binary), so that reading gives back the same grid bit by bit.

    Args:
        grid: the grid; of a `MultiBlock` connections and names go to a neutral map file (``.nmf``) of the same name in
            the same folder.
        path: as for `read`; an existing file is replaced. Several blocks go to ``.xyz``, ``.p2dfmt`` or ``.vtm``.

    Raises:
        GridgenError: for an unknown suffix or one whose files hold one block, a boundary name that a neutral map file
            cannot hold, or a path at which no file can be written.
        MissingExtraError: for ``.cgns``, if h5py is not installed.
    """
    from ..topology import MultiBlock

    suffix = _suffix_of(path)
    if not isinstance(grid, MultiBlock):
        check_grid(grid)
        _write_blocks({"0": grid}, Path(path), suffix)
        return
    from . import nmf_text
    from .layouts import map_path

    check_holds(path, len(grid))
    beside = nmf_text.encode(grid)
    check_target(map_path(path))
    _write_blocks(dict(zip(grid.names, grid.blocks, strict=True)), Path(path), suffix)
    write_bytes(map_path(path), beside)


def _write_blocks(blocks: dict[str, Grid], path: Path, suffix: str) -> None:
    """Write blocks to one file, or to one that names those in a folder beside it."""
    if suffix != _FOLDED:
        write_bytes(path, _FORMATS[suffix].encode(*blocks.values()))
        return
    check_target(path)
    files = vtm.block_files(path.stem, len(blocks))
    contents = zip(files, blocks.values(), strict=True)
    write_folder(path.with_suffix(""), {Path(file).name: vtk.encode(grid) for file, grid in contents})
    write_bytes(path, vtm.encode(list(blocks), files))


def _suffix_of(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a path, which must be that of a format."""
    text = file_name(path)
    suffix = Path(text).suffix.lower()
    if suffix not in known_suffixes():
        forms = {key: form.name for key, form in _FORMATS.items()} | {_FOLDED: "VTK XML multi-block file"}
        known = ", ".join(f"{key} ({name})" for key, name in forms.items())
        what = f"the suffix '{suffix}' is unknown" if suffix else "it has no suffix"
        if suffix in (".toml", ".mesh"):
            what = "it describes a layout, which gridgen_sym.read_layout reads"
        raise GridgenError(f"unknown format of the grid file {shown(text)}: {what}; use one of {known}")
    return suffix
