"""The records of a Tecplot text: names of variables, and zones with their entries and where their numbers are."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import BinaryIO

from ..errors import GridgenError, quoted
from ..parsing import whole_number_in

EXPECTED = 'expected VARIABLES = "x" "y" and ordered zones: ZONE I=..., J=..., F=BLOCK or POINT, then the numbers'
#: Bytes that are read at once, and those of a header.
_PIECE, _LONGEST_HEADER = 1 << 20, 1 << 14
#: Lines that begin a record.
_RECORD = re.compile(
    rb"^[ \t]*(TITLE|VARIABLES|ZONE|TEXT|GEOMETRY|CUSTOMLABELS|DATASETAUXDATA|VARAUXDATA|FILETYPE)\b", re.I | re.M
)
_NUMBERS = re.compile(rb"\n[ \t]*[0-9.+-]")
#: An entry of a zone: T="name", I=5, DT=(DOUBLE DOUBLE), VARLOCATION=([3]=CELLCENTERED).
_ENTRY = re.compile(r'([A-Za-z]+)\s*=\s*("(?:[^"\\]|\\.)*"|\((?:[^()]|\([^()]{0,99}\)){0,999}\)|[^\s,"()]+)')
_NAME = re.compile(r'"((?:[^"\\]|\\.)*)"|([^\s,"=]+)')


@dataclass(frozen=True, slots=True)
class Zone:
    """A zone of a text.

    Attributes:
        number: of the zone, from 1.
        entries: of its header, by their names in capitals, without quotation marks.
        begin: where its numbers begin in the file.
        end: where they end.
        line: how many lines stand before them.
    """

    number: int
    entries: Mapping[str, str]
    begin: int
    end: int
    line: int

    @property
    def name(self) -> str:
        """Its title; a zone without one has its number."""
        return self.entries.get("T", "").strip() or str(self.number - 1)

    @property
    def sizes(self) -> tuple[int, int, int]:
        """The numbers of nodes along its indices."""
        found = []
        for key in ("I", "J", "K"):
            word = self.entries.get(key, "1")
            try:
                found.append(whole_number_in(word))
            except ValueError:
                found.append(0)
            if found[-1] < 1:
                raise GridgenError(f"zone {self.number} has {key}={quoted(word)}; expected a whole number from 1 on")
        return found[0], found[1], found[2]


def records_of(stream: BinaryIO) -> tuple[list[str], list[Zone]]:
    """Return the names of the variables, and the zones.

    Raises:
        GridgenError: for a text without variables or zones, or with a header that does not end.
    """
    names: list[str] = []
    zones: list[Zone] = []
    found = list(_places(stream)) or [(b"", 0, 0)]
    ends = [place for _, place, _ in found[1:]] + [stream.seek(0, 2)]
    for (kind, begin, line), end in zip(found, ends, strict=True):
        stream.seek(begin)
        head = stream.read(min(end - begin, _LONGEST_HEADER))
        if kind == b"VARIABLES" and not names:
            text = head.decode("utf-8", errors="replace").partition("=")[2]
            names = [one or other for one, other in _NAME.findall(text)]
        elif kind == b"ZONE":
            zones.append(_zone(len(zones) + 1, head, begin, end, line))
    if not names or not zones:
        raise GridgenError(f"it has no {'zones' if names else 'names of variables'}; {EXPECTED}")
    return names, zones


def _places(stream: BinaryIO) -> Iterator[tuple[bytes, int, int]]:
    """Yield the kind of each record, where it begins, and how many lines stand before it."""
    offset = lines = 0
    rest = b""
    while data := stream.read(_PIECE):
        piece, _, rest = (rest + data).rpartition(b"\n")
        piece += b"\n"
        for match in _RECORD.finditer(piece):
            yield match[1].upper(), offset + match.start(), lines + piece.count(b"\n", 0, match.start())
        offset, lines = offset + len(piece), lines + piece.count(b"\n")


def _zone(number: int, head: bytes, begin: int, end: int, line: int) -> Zone:
    """Return the zone of a header, after which its numbers stand."""
    numbers = _NUMBERS.search(head)
    if numbers is None:
        raise GridgenError(f"line {line + 1}: no numbers follow the header of zone {number}; {EXPECTED}")
    text = head[: numbers.start()].decode("utf-8", errors="replace")
    entries = {key.upper(): _plain(value) for key, value in _ENTRY.findall(text)}
    return Zone(number, entries, begin + numbers.start() + 1, end, line + text.count("\n") + 1)


def _plain(value: str) -> str:
    """Return the value of an entry without quotation marks."""
    return re.sub(r"\\(.)", r"\1", value[1:-1]) if value.startswith('"') else value
