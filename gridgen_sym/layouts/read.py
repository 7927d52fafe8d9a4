"""Read a layout from a description, by the suffix of its file."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from ..atomic import file_name, read_bytes, shown
from ..boundary.wall import Wall
from ..errors import GridgenError, quoted
from ..topology import MultiBlock
from . import description, gmsh, mfem
from .quadrilaterals import layout_of_mesh

#: What reads a mesh, by the suffix of its file.
_MESHES = {".mesh": mfem.decode, ".msh": gmsh.decode}
#: Cells along each side of a quadrilateral of a mesh.
_CELLS = 4


def read_layout(path: str | os.PathLike[str], *, refine: int | None = None) -> MultiBlock:
    """Return the start of the layout that a file describes; for files that have the nodes of blocks see `read`.

    Args:
        path: of a description in TOML (`.toml`): points, curves, blocks, cells, boundaries, walls (which `read_walls`
            returns); or of a mesh of
            quadrilaterals (`.mesh`, MFEM; `.msh`, Gmsh), each of which becomes a block.
        refine: a factor for all numbers of cells of a description, 1 without it; of a mesh the cells along each side of
            a quadrilateral, 4 without it.

    Returns:
        The blocks by transfinite interpolation, those of a mesh by its own curved or bilinear maps; they may be folded.

    Raises:
        GridgenError: for a file that is missing, of another kind or describes no layout; the message names the path.
    """
    suffix = Path(file_name(path)).suffix.lower()
    if suffix not in (".toml", *_MESHES):
        raise GridgenError(
            f"cannot read a layout from {shown(path)}: expected a description (.toml) or a mesh of quadrilaterals "
            "(.mesh, MFEM; .msh, Gmsh); files of grids are read by gridgen_sym.read"
        )
    least = 1 if suffix == ".toml" else 2
    if refine is not None and (not isinstance(refine, int | np.integer) or isinstance(refine, bool) or refine < least):
        raise GridgenError(f"refine must be a whole number, at least {least} for {suffix}; came {quoted(refine)}")
    data = read_bytes(path)
    try:
        if suffix == ".toml":
            return description.decode(data, Path(path).parent)[0].layout(int(refine or 1))
        return layout_of_mesh(_MESHES[suffix](data), int(refine or _CELLS))
    except GridgenError as error:
        raise GridgenError(f"cannot read the layout {shown(path)}: {error}") from error


def read_walls(path: str | os.PathLike[str]) -> dict[str, Wall]:
    """Return the walls of a layout's description in TOML by the names of boundaries, as `optimize` takes them.

    Args:
        path: of the description (`.toml`).

    Returns:
        What its table `walls` says; nothing where there is none.

    Raises:
        GridgenError: as `read_layout`.
    """
    if Path(file_name(path)).suffix.lower() != ".toml":
        raise GridgenError(f"cannot read walls from {shown(path)}: expected a layout's description (.toml)")
    try:
        return description.decode(read_bytes(path), Path(path).parent)[1]
    except GridgenError as error:
        raise GridgenError(f"cannot read the layout {shown(path)}: {error}") from error
