"""PLOT3D grid files, whole: text, Fortran unformatted and C binary, of one block or several.

Written by default: the multi-block, three-dimensional text with one k plane, which most programs take: the number of
blocks, a line ``ni nj 1`` for each, then for each all x, all y and all z (zeros), i running fastest. Read: every form,
by content: with and without the number of blocks, two or three sizes, either byte order and precision, iblank, a plane
of constant i, j or k in any coordinate plane. VTK and ParaView cannot distinguish these forms in text: switch 'Multi
Grid' on there.
Source: P. P. Walatka et al., PLOT3D User's Manual, NASA TM-101067 (1990), chapter 8.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import BinaryIO

from ...arrays import Mask
from ...errors import GridgenError
from ...messages import report
from ..format import Blocks, Format
from ..plot3d_binary import read_binary
from ..plot3d_forms import WORDS, check_words
from ..plot3d_planes import Plane, plane_of
from ..plot3d_text import read_text
from ..plot3d_writing import written

#: The sizes in the header of a file that is no text have zeros in their first bytes.
_HEAD = 16


def decode(stream: BinaryIO, words: Collection[str] = ()) -> Blocks:
    """Return the blocks of a PLOT3D file. An iblank that is ignored, an unusual plane and a doubt are reported.

    Args:
        stream: the file.
        words: restrict the forms that it may have; `holes` keeps nodes that iblank blanks out.

    Raises:
        GridgenError: for a word that is no number, a volume, a surface that is not plane, nodes blanked out by iblank,
            or a length that does not fit the header.
    """
    check_words(words)
    head = stream.read(_HEAD)
    stream.seek(0)
    is_text = "ascii" in words or (b"\0" not in head and not {"fortran", "binary"} & {*words})
    form, values = (read_text if is_text else read_binary)(stream, words)
    planes: list[Plane] = []
    for number, (block, sizes) in enumerate(zip(values, form.sizes, strict=True), start=1):
        try:
            planes.append(plane_of(block, sizes, form.dimension, holes="holes" in words))
        except GridgenError as error:
            raise GridgenError(f"block {number}: {error}" if len(form.sizes) > 1 else str(error)) from error
    if len({plane.coordinates for plane in planes}) > 1:
        raise GridgenError("its blocks lie in different coordinate planes; expected one for all")
    for remark in dict.fromkeys(plane.remark for plane in planes if plane.remark):
        report(remark)
    return Blocks(tuple(plane.grid for plane in planes), masks=_masks(planes))


def _masks(planes: list[Plane]) -> tuple[Mask, ...] | None:
    """Return the masks of iblank; where there are no holes it is reported that it is ignored."""
    masks = tuple(plane.blanked for plane in planes if plane.blanked is not None)
    if masks and all(mask.all() for mask in masks):
        report("the file's iblank is ignored: it marks no holes")
    return masks or None


FORMAT = Format(
    name="PLOT3D grid",
    suffixes=(".xyz", ".x", ".p3d", ".p3dfmt", ".g", ".grid"),
    decode=decode,
    encode=written,
    streamed=True,
    several=True,
    forms=WORDS,
    dimensions="planes: one i, j or k plane, or one layer of cells, in any coordinate plane, which is reported",
    writes="multi-block, three-dimensional text; other forms by the words below",
    reads="every form below, by content; numbers as Fortran writes them: `3*0.5`, `1.5D+02`, `1.5-120`; iblank without "
    "holes",
    test="tests/io/test_plot3d.py::test_every_form_is_read_by_its_content",
)
