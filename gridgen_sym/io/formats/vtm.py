"""VTK XML multi-block files (.vtm): one structured grid (.vts) for each block, in a folder of the same name.

Source: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import PurePosixPath
from typing import BinaryIO

from ...errors import GridgenError, quoted
from ..block_names import check_block_names
from ..format import Blocks, Format, Storage
from ..vtk_parts import xml_root
from . import vts

_KIND = "vtkMultiBlockDataSet"


def encode(blocks: Blocks, words: Collection[str] = (), *, stem: str) -> dict[str, bytes | Iterator[bytes]]:
    """Return the file of a folder `stem`, and the structured grids in this, by their names.

    Raises:
        GridgenError: for names of blocks that are empty or cannot be printed.
    """
    check_block_names([name for name, _ in blocks.described], "a VTK file")
    files = {f"block_{number}.vts": vts.encode(grid, words) for number, grid in enumerate(blocks.grids)}
    index = _index([name for name, _ in blocks.described], [f"{stem}/{file}" for file in files])
    return {"": index, **files}


def _index(names: Sequence[str], files: Sequence[str]) -> bytes:
    """Return a multi-block file that names these files."""
    from xml.sax.saxutils import quoteattr  # It loads all that opens a URL, a third of `import gridgen_sym`.

    lines = [
        f'<DataSet index="{index}" name={quoteattr(name)} file={quoteattr(file)}/>'
        for index, (name, file) in enumerate(zip(names, files, strict=True))
    ]
    head = f'<VTKFile type="{_KIND}" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
    body = ['<?xml version="1.0"?>', head, f"<{_KIND}>", *lines, f"</{_KIND}>", "</VTKFile>", ""]
    return "\n".join(body).encode("utf-8")


def decode(
    data: bytes, words: Collection[str] = (), *, beside: Callable[[str], AbstractContextManager[BinaryIO]]
) -> Blocks:
    """Return the blocks that a multi-block file names.

    Args:
        data: the file.
        words: ignored: a file says itself what it is.
        beside: opens a file whose path is relative to it.

    Raises:
        GridgenError: for another kind of file, no blocks, or blocks that are no structured grids (.vts).
    """
    files = _files(data)
    grids = []
    for file in files.values():
        with beside(file) as stream:
            try:
                grids.append(vts.decode(stream))
            except GridgenError as error:
                raise GridgenError(f"its block {file}: {error}") from error
    return Blocks(tuple(grids), tuple(files))


def _files(data: bytes) -> Mapping[str, str]:
    """Return the files of the blocks, relative to the multi-block file, by the names of these."""
    found: dict[str, str] = {}
    for number, entry in enumerate(xml_root(data, _KIND).iter("DataSet")):
        file, name = entry.get("file", ""), entry.get("name") or str(number)
        if PurePosixPath(file).suffix.lower() != ".vts":
            raise GridgenError(f"its block {number} is in the file {quoted(file)}; expected a structured grid (.vts)")
        if name in found:
            raise GridgenError(f"two of its blocks have the name {quoted(name)}: name them differently")
        found[name] = file
    if not found:
        raise GridgenError("it has no blocks; expected a DataSet for each")
    return found


FORMAT = Format(
    name="VTK XML multi-block file",
    suffixes=(".vtm",),
    decode=decode,
    encode=encode,
    several=True,
    storage=Storage.FILE_AND_FOLDER,
    forms=vts.FORMS,
    dimensions="planes of constant z",
    writes="`out.vtm`, and the folder `out` with a `.vts` for each block",
    reads="blocks in `.vts` files",
    test="tests/io/test_layouts.py::test_vtk_reads_several_blocks",
)
