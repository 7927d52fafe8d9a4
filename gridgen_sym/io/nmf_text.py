"""The text of a neutral map file for blocks in the plane, as NASA writes them: one layer of cells in direction i."""

from __future__ import annotations

import json
from collections.abc import Sequence

from ..errors import GridgenError, quoted
from ..topology.connection import SidePart
from ..topology.copies import Bond
from ..topology.multiblock import MultiBlock
from .nmf import ONE_TO_ONE
from .nmf_faces import ALONG, FACES, LAYER, PLANE_FACES

#: What the two faces of the layer are called: symmetry planes, by the name that FUN3D has for them.
_PLANE_NAME = "symmetry_y_strong"
_TYPE = f"'{ONE_TO_ONE}'"
_RULE = f"# {'-' * 82}"
_TITLE = f"# {' Neutral Map File written by gridgen_sym ':=^82}"


def encode(layout: MultiBlock) -> bytes:
    """Return the connections and the names of the boundaries of a layout as a neutral map file.

    Parts of the outer boundary without a name are not in it.

    Raises:
        GridgenError: for a name that the format cannot hold.
    """
    lines = [_TITLE, "# Block#   IDIM   JDIM   KDIM", _RULE, f"{len(layout):7d}", ""]
    for number, grid in enumerate(layout.blocks, start=1):
        ni, nj = grid.shape
        lines.append(f"{number:7d}{LAYER.depth:7d}{ni:7d}{nj:7d}")
    lines.append("")
    lines += [
        f"# gridgen-sym: block {number} is named {json.dumps(name)}"
        for number, name in enumerate(layout.names, start=1)
        if name != str(number - 1)
    ]
    lines += [
        "# Type                        B1  F1    S1    E1    S2    E2    B2  F2    S1    E1    S2    E2  Swap",
        _RULE,
    ]
    for face in PLANE_FACES:  # The ranges of these are those of j and k.
        for number, grid in enumerate(layout.blocks, start=1):
            ni, nj = grid.shape
            lines.append(f"{_quoted_name(_PLANE_NAME):<28}{number:4d}{face:4d}{1:6d}{ni:6d}{1:6d}{nj:6d}")
    for name, parts in layout.boundaries.items():
        lines += [f"{_quoted_name(name):<28}{_range(part)}" for part in parts]
    for bond in layout.bonds:
        lines += _bond(bond)
    return ("\n".join(lines) + "\n").encode("utf-8")


def _quoted_name(name: str) -> str:
    """Return a name as a word of the file."""
    marks = [mark for mark in "'\"" if mark not in name]
    if not name or not marks or not name.isprintable() or name.lower().replace("_", "-") == ONE_TO_ONE:
        raise GridgenError(
            f"a neutral map file (.nmf) cannot hold the boundary name {quoted(name)}: take one without quotation marks "
            f"or line breaks, and not {ONE_TO_ONE}"
        )
    return f"{marks[0]}{name}{marks[0]}"


def _bond(bond: Bond) -> list[str]:
    """Return the lines of a connection."""
    swap = ALONG[bond.one.side] != ALONG[bond.other.side]
    ranges = f"{_range(bond.one)}  {_range(bond.other, backwards=bond.reversed)}"
    line = f"{_TYPE:<28}{ranges}  {str(swap).lower()}"
    (x, y), angle = bond.motion.shift, bond.motion.angle
    if (angle, x, y) == (0, 0, 0):
        return [line]
    return [f"# gridgen-sym: the next connection turns by {angle!r} degrees and moves by {x!r} {y!r}", line]


def _range(part: SidePart, *, backwards: bool = False) -> str:
    """Return block, face and the two ranges of a part."""
    ends = (part.last + 1, part.first + 1) if backwards else (part.first + 1, part.last + 1)
    ranges: Sequence[int] = (1, LAYER.depth)
    ranges = (*ends, *ranges) if ALONG[part.side] == 0 else (*ranges, *ends)
    return f"{part.block + 1:4d}{FACES[part.side]:4d}" + "".join(f"{number:6d}" for number in ranges)
