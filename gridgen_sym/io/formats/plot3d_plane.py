"""PLOT3D files of plane grids, without z (.p2dfmt), as in NASA's Turbulence Modeling Resource."""

from __future__ import annotations

from ..format import Blocks, Format
from .plot3d import decode, encoded


def encode(blocks: Blocks) -> bytes:
    """Return blocks as a PLOT3D file: multi-block, two-dimensional, ASCII."""
    return encoded(blocks.grids, "", lambda grid: (grid.x, grid.y))


FORMAT = Format(
    name="PLOT3D plane grid",
    suffixes=(".p2dfmt",),
    decode=decode,
    encode=encode,
    several=True,
    dimensions="planes",
    writes="ASCII, 17 digits, multi-block, two-dimensional",
    reads="as a PLOT3D grid",
    test="tests/io/test_files.py::test_all_forms_of_plot3d",
)
