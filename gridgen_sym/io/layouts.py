"""Files of several blocks: blocks from one file, connections and names from the neutral map file beside it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ..atomic import read_bytes, shown
from ..errors import GridgenError
from ..grids.grid import Grid
from ..topology.connection import Connection
from ..topology.multiblock import MultiBlock
from . import nmf

_SUFFIX = ".nmf"


def map_path(path: str | os.PathLike[str]) -> Path:
    """Return the path of the neutral map file that belongs to a grid file."""
    return Path(path).with_suffix(_SUFFIX)


def assembled(blocks: Sequence[Grid], path: str | os.PathLike[str], names: Sequence[str] | None = None) -> MultiBlock:
    """Return the layout of the blocks of a file.

    Args:
        blocks: the grids.
        path: of the file; where a neutral map file stands beside it, that gives the connections and names of the
            boundaries. Otherwise nodes that coincide are connected.
        names: of the blocks, if the file has names.

    Raises:
        GridgenError: if the map does not fit the blocks, or their connected nodes do not coincide.
    """
    beside = next((p for p in (map_path(path), map_path(path).with_suffix(_SUFFIX.upper())) if p.is_file()), None)
    if beside is None:
        try:
            return MultiBlock(dict(zip(names, blocks, strict=True)) if names else blocks)
        except GridgenError as error:
            raise GridgenError(f"cannot connect the blocks of {shown(path)}: {error}") from error
    try:
        found = nmf.decode(read_bytes(beside), [grid.shape for grid in blocks])
        named = dict(zip(names or found.names, blocks, strict=True))
        if len(named) < len(blocks):
            raise GridgenError("two blocks have one name: name them differently")
        return _connected(named, found)
    except GridgenError as error:
        raise GridgenError(f"cannot read {shown(beside)} as a neutral map file: {error}") from error


def _connected(blocks: dict[str, Grid], found: nmf.NeutralMap) -> MultiBlock:
    """Return the layout of a map; an error names the first line that makes it."""
    connections = [connection for _, connection in found.connections]
    boundaries: dict[str, list[tuple[object, ...]]] = {}
    for _, name, part in found.boundaries:
        boundaries.setdefault(name, []).append((part.block, part.side, (part.first, part.last)))
    try:
        return MultiBlock(blocks, connections, boundaries=boundaries)
    except GridgenError as error:
        line = _first_wrong_line(blocks, found, connections)
        raise GridgenError(f"line {line}: {error}" if line else str(error)) from error


def _first_wrong_line(blocks: dict[str, Grid], found: nmf.NeutralMap, connections: Sequence[Connection]) -> int:
    """Return the line without which, and all after it, there is no error; 0 for none."""
    for count, (line, _) in enumerate(found.connections, start=1):
        try:
            MultiBlock(blocks, connections[:count])
        except GridgenError:
            return line
    for line, name, part in found.boundaries:
        try:
            MultiBlock(blocks, connections, boundaries={name: [(part.block, part.side, (part.first, part.last))]})
        except GridgenError:
            return line
    return 0
