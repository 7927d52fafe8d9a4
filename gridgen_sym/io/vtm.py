"""VTK XML multi-block files (.vtm): one structured grid (.vts) for each block, in a folder of the same name.

Source: VTK File Formats, https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from ..errors import GridgenError, quoted
from .vtk import xml_root

_KIND = "vtkMultiBlockDataSet"


def block_files(folder: str, count: int) -> list[str]:
    """Return the files of the blocks, relative to the multi-block file."""
    return [f"{folder}/block_{number}.vts" for number in range(count)]


def encode(names: Sequence[str], files: Sequence[str]) -> bytes:
    """Return a multi-block file that names these files."""
    from xml.sax.saxutils import quoteattr  # It loads all that opens a URL, a third of `import gridgen_sym`.

    lines = [
        f'<DataSet index="{index}" name={quoteattr(name)} file={quoteattr(file)}/>'
        for index, (name, file) in enumerate(zip(names, files, strict=True))
    ]
    head = f'<VTKFile type="{_KIND}" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
    body = ['<?xml version="1.0"?>', head, f"<{_KIND}>", *lines, f"</{_KIND}>", "</VTKFile>", ""]
    return "\n".join(body).encode("utf-8")


def decode(data: bytes) -> dict[str, str]:
    """Return the files of the blocks, relative to the multi-block file, by the names of these.

    Raises:
        GridgenError: for another kind of file, no blocks, or blocks that are no structured grids (.vts).
    """
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
