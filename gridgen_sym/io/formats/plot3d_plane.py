"""PLOT3D files of plane grids, without z (.p2dfmt), as in NASA's Turbulence Modeling Resource."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..format import Blocks, Format
from ..plot3d_forms import WORDS
from ..plot3d_writing import written
from .plot3d import decode


def encode(blocks: Blocks, words: Collection[str] = ()) -> Iterator[bytes]:
    """Return the pieces of a PLOT3D file, by default multi-block, two-dimensional text; see `written`."""
    return written(blocks, {*words} if "space" in words else {*words, "plane"})


FORMAT = Format(
    name="PLOT3D plane grid",
    suffixes=(".p2dfmt",),
    decode=decode,
    encode=encode,
    streamed=True,
    several=True,
    forms=WORDS,
    dimensions="as a PLOT3D grid",
    writes="multi-block, two-dimensional text, as in NASA's Turbulence Modeling Resource; other forms as a PLOT3D grid",
    test="tests/io/test_plot3d.py::test_every_form_is_read_by_its_content",
)
