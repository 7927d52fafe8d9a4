"""Neutral map files (.nmf): which parts of the sides of blocks are connected, and the names of the others.

Source: the files of NASA's Turbulence Modeling Resource, and geolab.larc.nasa.gov/Volume/Doc/nmf.htm.
What the format has no place for, names of blocks and periodic connections, stands in comments that begin
``# gridgen-sym:``; other programs skip them.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

from ..errors import GridgenError, quoted
from ..parsing import number_in, whole_number_in
from ..topology.connection import Connection, SidePart
from .nmf_faces import Frame, frame_of

#: The type of a line that connects; other programs write it in capitals, or with underscores.
ONE_TO_ONE = "one-to-one"
#: A word, in quotes or not; what follows a number sign is a comment, which has no word.
_WORDS = re.compile(r"'([^']*)'|\"([^\"]*)\"|([^\s#]+)|#.*")
_NAMED = re.compile(r"# gridgen-sym: block (\d+) is named (\".*\")")
_MOVED = re.compile(r"# gridgen-sym: the next connection turns by (\S+) degrees and moves by (\S+) (\S+)")
_SWAPS = {"true": True, ".true.": True, "t": True, "false": False, ".false.": False, "f": False}


@dataclass(frozen=True, slots=True)
class NeutralMap:
    """The content of a neutral map file for blocks in the plane.

    Attributes:
        names: of the blocks.
        connections: with the number of the line of each.
        boundaries: names of parts of sides, with the number of the line of each.
    """

    names: tuple[str, ...]
    connections: tuple[tuple[int, Connection], ...]
    boundaries: tuple[tuple[int, str, SidePart], ...]


@dataclass(frozen=True, slots=True)
class _Line:
    """The words of a line that is no comment, and its number."""

    number: int
    words: tuple[str, ...]

    def fault(self, text: str) -> NoReturn:
        """Raise an error that names the line."""
        raise GridgenError(f"line {self.number}: {text}")

    def whole_numbers(self, words: Sequence[str], expected: str) -> list[int]:
        """Return words as whole numbers."""
        try:
            return [whole_number_in(word) for word in words]
        except ValueError:
            self.fault(f"expected {expected}; came {quoted(' '.join(words))}")


def decode(data: bytes, shapes: Sequence[tuple[int, int]]) -> NeutralMap:
    """Return the content of a neutral map file.

    Args:
        data: the file.
        shapes: (ni, nj) of the blocks that it is about.

    Raises:
        GridgenError: for other blocks than these, an unknown face, a range outside a side, or connected parts that do
            not fit each other; the message names the line.
    """
    names, moved = [str(number) for number in range(len(shapes))], {}
    lines: list[_Line] = []
    for number, text in enumerate(data.decode("utf-8", errors="replace").splitlines(), start=1):
        if text.lstrip().startswith("#"):
            if found := _NAMED.match(text.strip()):
                _name(names, number, *found.groups())
            elif found := _MOVED.match(text.strip()):
                moved[len(lines)] = _motion(number, *found.groups())
            continue
        words = tuple(filter(None, ("".join(word) for word in _WORDS.findall(text.rstrip().removesuffix("\\")))))
        if words:
            lines.append(_Line(number, words))
    frames = _frames(lines, shapes)
    connections, boundaries = [], []
    for index, line in enumerate(lines[1 + len(shapes) :], start=1 + len(shapes)):
        name = line.words[0]
        if name.lower().replace("_", "-") == ONE_TO_ONE:
            parts = _connected(line, frames, shapes)
            if parts is not None:
                angle, shift = moved.get(index, (0.0, (0.0, 0.0)))
                given = [(part.block, part.side, (part.first, part.last)) for part in parts]
                connections.append((line.number, Connection(*given, rotation=angle, translation=shift)))
        else:
            found_part = _part(line, line.words[1:], frames, shapes, what="the name of a boundary and 6 numbers")
            if found_part is not None:
                boundaries.append((line.number, name, found_part.part))
    return NeutralMap(tuple(names), tuple(connections), tuple(boundaries))


def _name(names: list[str], line: int, block: str, text: str) -> None:
    """Set the name of a block from a comment."""
    try:
        name, number = json.loads(text), whole_number_in(block)
    except (ValueError, RecursionError):
        name, number = None, 0
    if not isinstance(name, str) or not 0 < number <= len(names):
        raise GridgenError(f"line {line}: expected a block from 1 to {len(names)} and its name in quotes")
    names[number - 1] = name


def _motion(line: int, *texts: str) -> tuple[float, tuple[float, float]]:
    """Return the angle and the shift that a comment gives."""
    try:
        angle, x, y = (number_in(text) for text in texts)
    except ValueError:
        raise GridgenError(f"line {line}: expected an angle and a shift, three numbers; came {quoted(texts)}") from None
    return angle, (x, y)


def _frames(lines: Sequence[_Line], shapes: Sequence[tuple[int, int]]) -> list[Frame]:
    """Return how each block lies in the file."""
    if not lines:
        raise GridgenError("it has no lines but comments; expected the number of blocks")
    (count,) = lines[0].whole_numbers(lines[0].words[:1], "the number of blocks")
    if count != len(shapes) or len(lines[0].words) > 1:
        lines[0].fault(
            f"expected {len(shapes)}, the number of blocks of the grid file; came {' '.join(lines[0].words)}"
        )
    if len(lines) < 1 + count:
        lines[-1].fault(f"the file ends after it; expected a line with the sizes of each of {count} blocks")
    faces = {line.words[2] for line in lines[1 + count :] if len(line.words) > 2}
    frames = []
    for block, (line, shape) in enumerate(zip(lines[1:], shapes, strict=False), start=1):
        expected = f"{block} and the sizes of block {block}, {shape[0]} x {shape[1]} nodes and 1 or 2 across"
        numbers = line.whole_numbers(line.words, expected)
        # Files for the plane count its four sides, and have no face 5 and 6.
        plane = len(numbers) == 4 and numbers[3] == 1 and not faces & {"5", "6"}
        sizes = (numbers[1], numbers[2], numbers[3]) if len(numbers) == 4 else (0, 0, 0)
        frame = frame_of(sizes, shape, plane=plane)
        if frame is None or numbers[0] != block:
            line.fault(f"expected {expected}; came {' '.join(line.words)}")
        frames.append(frame)
    return frames


@dataclass(frozen=True, slots=True)
class _Range:
    """A part of a side, whether it is given backwards, and which range of its face runs along it."""

    part: SidePart
    backwards: bool
    along: int


def _part(
    line: _Line, words: Sequence[str], frames: Sequence[Frame], shapes: Sequence[tuple[int, int]], *, what: str
) -> _Range | None:
    """Return the part of a side that six numbers give; None for a face that is the plane itself."""
    expected = f"{what}: block, face, S1, E1, S2, E2"
    if len(words) != 6:
        line.fault(f"expected {expected}; came {quoted(' '.join(line.words))}")
    block, face, *ends = line.whole_numbers(words, expected)
    if not 1 <= block <= len(shapes):
        line.fault(f"expected a block from 1 to {len(shapes)}; came {block}")
    if not 1 <= face <= 6:
        line.fault(f"expected a face from 1 to 6; came {face}")
    frame, (ni, nj) = frames[block - 1], shapes[block - 1]
    found = frame.face_range(face)
    if found is None:
        return None
    first, last = ends[2 * found.along : 2 * found.along + 2]
    across = sorted(ends[2 - 2 * found.along : 4 - 2 * found.along])
    count = ni if found.side in ("bottom", "top") else nj
    place = f"face {face} of block {block}"
    if across != [1, frame.depth]:
        line.fault(
            f"expected {place} in its whole depth, from 1 to {frame.depth}; came from {across[0]} to {across[1]}"
        )
    if not (1 <= min(first, last) < max(first, last) <= count):
        line.fault(f"expected two different nodes of {place}, from 1 to {count}; came {first} to {last}")
    return _Range(
        SidePart(block - 1, found.side, min(first, last) - 1, max(first, last) - 1), first > last, found.along
    )


def _connected(
    line: _Line, frames: Sequence[Frame], shapes: Sequence[tuple[int, int]]
) -> tuple[SidePart, SidePart] | None:
    """Return the two parts that a line connects; None where they are the plane itself."""
    swap = _SWAPS.get(line.words[-1].lower())
    if len(line.words) != 14 or swap is None:
        line.fault(
            f"expected {ONE_TO_ONE}, twice block, face, S1, E1, S2, E2, and whether they swap, true or false; came "
            f"{quoted(' '.join(line.words))}"
        )
    one, other = (_part(line, line.words[k : k + 6], frames, shapes, what="two parts of faces") for k in (1, 7))
    if one is None or other is None:
        if (one is None) != (other is None):
            line.fault("it connects a side of the plane with the plane itself; expected two sides")
        return None
    parts = one.part, other.part
    if parts[0].count != parts[1].count:
        line.fault(f"expected as many nodes on either side; came {parts[0].count} and {parts[1].count}")
    expected = one.along != other.along
    if swap is not expected:
        line.fault(
            f"expected swap {str(expected).lower()}, since the ranges along the sides are "
            f"{'one the first and one the second' if expected else 'both the first or both the second'} of their "
            f"faces; came {str(swap).lower()}"
        )
    if (one.backwards != other.backwards) != (parts[0].counterclockwise == parts[1].counterclockwise):
        line.fault(
            f"{parts[0].side} and {parts[1].side} of two blocks with positive Jacobians run in "
            f"{'opposite directions' if one.backwards == other.backwards else 'the same direction'}; came "
            f"{'the same' if one.backwards == other.backwards else 'opposite ones'}: exchange the ends of one range"
        )
    return parts
