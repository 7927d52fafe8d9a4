"""A VTK XML file without its numbers: the XML, and where the content of each data array is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import BinaryIO
from xml.etree import ElementTree

from ..errors import GridgenError, quoted, shortened
from .windows import Window, find

DAMAGED = "the file may be cut short or damaged: write it again"
#: How far the end of a tag is from its beginning, at most.
_LONGEST_TAG = 1 << 14


@dataclass(frozen=True, slots=True)
class Parts:
    """The parts of a file.

    Attributes:
        xml: without the content of data arrays, and without appended data.
        arrays: the content of each data array, in their order.
        appended: the content of <AppendedData> after its underscore.
    """

    xml: bytes
    arrays: tuple[Window, ...]
    appended: Window


def parts_of(stream: BinaryIO) -> Parts:
    """Return the parts of a file, of which only the XML is read."""
    end = stream.seek(0, 2)
    appended, limit = _appended(stream, end)
    pieces: list[bytes] = []
    arrays: list[Window] = []
    place = 0
    while 0 <= (start := find(stream, b"<DataArray", place)) < limit:
        closing = find(stream, b">", start)
        if not start < closing < start + _LONGEST_TAG:
            break
        pieces.append(Window(stream, place, closing + 1).read())
        place = closing + 1
        if pieces[-1].endswith(b"/>"):
            arrays.append(Window(stream, place, place))
            continue
        close = find(stream, b"<", place)  # An end tag, or a child, such as VTK's own <InformationKey>.
        if close < 0:
            break
        arrays.append(Window(stream, place, close))
        place = close
    pieces.append(Window(stream, place, limit).read())
    pieces.append(Window(stream, appended.end, end).read())
    return Parts(b"".join(pieces), tuple(arrays), appended)


def _appended(stream: BinaryIO, end: int) -> tuple[Window, int]:
    """Return the content of <AppendedData>, which may be raw and no XML at all, and where the XML before it ends."""
    start = find(stream, b"<AppendedData", 0)
    tag = find(stream, b">", start) if start >= 0 else -1
    mark = find(stream, b"_", tag) if tag >= 0 else -1
    if mark < 0:
        return Window(stream, end, end), end
    tail = Window(stream, max(mark, end - _LONGEST_TAG), end)
    first = tail.begin
    close = tail.read().rfind(b"</AppendedData>")
    if close < 0:
        return Window(stream, end, end), end
    return Window(stream, mark + 1, first + close), mark


def xml_root(xml: bytes, kind: str) -> ElementTree.Element:
    """Return the root of a VTK XML file of a kind.

    Raises:
        GridgenError: for broken XML, or another kind.
    """
    if b"<!DOCTYPE" in xml or b"\0" in xml:  # Entities could expand without bound; UTF-16 would hide them.
        raise GridgenError(f"it declares a document type, or is no plain text, which no VTK file does; {DAMAGED}")
    try:
        root = ElementTree.fromstring(xml)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise GridgenError(f"its XML is broken ({error}); {DAMAGED}") from error
    if root.tag != "VTKFile" or root.get("type") != kind:
        raise GridgenError(
            f"its root is <{shortened(root.tag)} type={quoted(root.get('type'))}>; expected a VTKFile of type {kind}"
        )
    return root
