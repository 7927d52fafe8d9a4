"""Files of several blocks: blocks from one file, connections and names from the neutral map file beside it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from ..atomic import read_bytes, shown
from ..errors import GridgenError
from ..grids.grid import Grid
from ..messages import report
from ..topology.coincidence import coinciding_parts
from ..topology.connection import Connection, SidePart
from ..topology.multiblock import MultiBlock
from . import nmf
from .format import Blocks

_SUFFIX = ".nmf"


def map_path(path: str | os.PathLike[str]) -> Path:
    """Return the path of the neutral map file that belongs to a grid file."""
    return Path(path).with_suffix(_SUFFIX)


def assembled(blocks: Blocks, path: str | os.PathLike[str]) -> MultiBlock:
    """Return the layout of the blocks of a file.

    Args:
        blocks: what the file holds.
        path: of the file. Where it says nothing of connections and boundaries, the neutral map file beside it does.
            Without both, nodes that coincide are connected.

    Raises:
        GridgenError: if the map does not fit the blocks, or their connected nodes do not coincide.
    """
    beside = None if blocks.bonds is not None or blocks.boundaries else _map_beside(path)
    if beside is None:
        return _of_file(blocks, path)
    try:
        found = nmf.decode(read_bytes(beside), [grid.shape for grid in blocks.grids])
        named = dict(zip(blocks.names or found.names, blocks.grids, strict=True))
        if len(named) < len(blocks.grids):
            raise GridgenError("two blocks have one name: name them differently")
        layout = _connected(named, found)
    except GridgenError as error:
        raise GridgenError(f"cannot read {shown(beside)} as a neutral map file: {error}") from error
    _report_silence(layout, beside)
    return layout


def _report_silence(layout: MultiBlock, path: Path) -> None:
    """Report sides that coincide and of which a map says nothing, as where it is cut short: they are not connected."""
    parts = [part for bond in layout.bonds for part in (bond.one, bond.other)]
    parts += [part for named in layout.boundaries.values() for part in named]
    told = {(part.block, part.side) for part in parts}
    try:
        pairs = coinciding_parts(layout.blocks, layout.names)
    except GridgenError:  # Several sides at one place: only the map can tell what they are.
        return
    silent = [pair for pair in pairs if not any((part.block, part.side) in told for part in pair)]
    if silent:
        one, other = (part.described(layout.names) for part in silent[0])
        report(
            f"{shown(path)} does not tell of sides whose nodes coincide, such as {one} and "
            f"{other}: they are not connected ({len(silent)} in all); see whether the map is complete"
        )


def tells_connections(blocks: Blocks, path: str | os.PathLike[str]) -> bool:
    """Return whether a file, or the map beside it, tells of connections or of names of boundaries."""
    return bool(blocks.bonds or blocks.boundaries) or (blocks.bonds is None and _map_beside(path) is not None)


def _map_beside(path: str | os.PathLike[str]) -> Path | None:
    """Return the neutral map file that lies beside a grid file, if there is one."""
    return next((p for p in (map_path(path), map_path(path).with_suffix(_SUFFIX.upper())) if p.is_file()), None)


def _of_file(blocks: Blocks, path: str | os.PathLike[str]) -> MultiBlock:
    """Return the layout of what the file itself says; where it says nothing, coinciding nodes are connected."""
    connections: Sequence[Connection] | Literal["auto"] = "auto"
    if blocks.bonds is not None:
        connections = [
            Connection(_given(bond.one), _given(bond.other), rotation=bond.motion.angle, translation=bond.motion.shift)
            for bond in blocks.bonds
        ]
    boundaries = {name: [_given(part) for part in parts] for name, parts in blocks.boundaries.items()}
    try:
        return MultiBlock(dict(blocks.described), connections, boundaries=boundaries)
    except GridgenError as error:
        raise GridgenError(f"cannot connect the blocks of {shown(path)}: {error}") from error


def _given(part: SidePart) -> tuple[object, ...]:
    """Return a part as users write it."""
    return part.block, part.side, (part.first, part.last)


def _connected(blocks: dict[str, Grid], found: nmf.NeutralMap) -> MultiBlock:
    """Return the layout of a map; an error names the first line that makes it."""
    connections = [connection for _, connection in found.connections]
    boundaries: dict[str, list[tuple[object, ...]]] = {}
    for _, name, part in found.boundaries:
        boundaries.setdefault(name, []).append(_given(part))
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
            MultiBlock(blocks, connections, boundaries={name: [_given(part)]})
        except GridgenError:
            return line
    return 0
