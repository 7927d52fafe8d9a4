"""Tecplot data files in text (.tec, .dat): one ordered zone for each block, by blocks of numbers or point by point.

Source: Tecplot 360 Data Format Guide, chapter 4, "ASCII Data".
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import BinaryIO

from ...arrays import Array
from ...errors import GridgenError, quoted
from ...messages import report
from ..block_names import check_block_names
from ..format import Blocks, Format
from ..plot3d_numbers import Numbers
from ..plot3d_planes import Plane, plane_of
from ..tecplot_records import EXPECTED, Zone, records_of
from ..windows import Window

#: Numbers of a piece that is written.
_PIECE = 1 << 16
#: How coordinates may be called, in lower case and without a unit.
_COORDINATES = (("x", "coordinatex"), ("y", "coordinatey"), ("z", "coordinatez"))
_REFUSED = {
    "VARSHARELIST": "shares variables with another zone",
    "PASSIVEVARLIST": "has passive variables",
    "ET": "is unstructured",
}


def encode(blocks: Blocks) -> Iterator[bytes]:
    """Return the pieces of a data file: for each block all x, then all y, i running fastest.

    Raises:
        GridgenError: for names of blocks that no title of a zone can have.
    """
    check_block_names([name for name, _ in blocks.described], "a Tecplot text")
    return _pieces(blocks)


def _pieces(blocks: Blocks) -> Iterator[bytes]:
    yield b'TITLE = "grid"\nVARIABLES = "x" "y"\n'
    for name, grid in blocks.described:
        ni, nj = grid.shape
        title = name.replace("\\", "\\\\").replace('"', '\\"')
        yield f'ZONE T="{title}", I={ni}, J={nj}, ZONETYPE=ORDERED, DATAPACKING=BLOCK, DT=(DOUBLE DOUBLE)\n'.encode()
        for plane in (grid.x, grid.y):
            flat = plane.T.ravel()
            for begin in range(0, flat.size, _PIECE):
                values = flat[begin : begin + _PIECE].tolist()
                yield (("%.17g\n" * len(values)) % tuple(values)).encode("ascii")


def decode(stream: BinaryIO) -> Blocks:
    """Return the blocks of a data file: its ordered zones, each of which must be plane; lines are left out.

    Raises:
        GridgenError: for a text without coordinates, zones that are unstructured, have cell-centered or shared
            variables or another count of numbers, and surfaces that are not plane.
    """
    variables, zones = records_of(stream)
    names = [re.split(r"[\s\[(]", name.strip().lower())[0] for name in variables]
    places = [next((names.index(name) for name in known if name in names), -1) for known in _COORDINATES]
    if -1 in places[:2]:
        raise GridgenError(f"its variables are {', '.join(map(quoted, variables))}; {EXPECTED}")
    planes: dict[str, Plane] = {}
    lines: list[str] = []
    for zone in zones:
        sizes = zone.sizes
        if sizes.count(1) > 1:
            lines.append(zone.name)
            continue
        values = _values(stream, zone, len(variables), [place for place in places if place >= 0])
        try:
            plane = plane_of(values, sizes, len(values), holes=False)
        except GridgenError as error:
            raise GridgenError(f"zone {zone.number}: {error}") from error
        planes[zone.name if zone.name not in planes else f"{zone.name} {zone.number}"] = plane
    if not planes:
        raise GridgenError(f"all of its zones are lines; {EXPECTED}")
    if lines:
        report(f"zones that are lines are left out: {quoted(', '.join(lines))}")
    for remark in dict.fromkeys(plane.remark for plane in planes.values() if plane.remark):
        report(remark)
    return Blocks(tuple(plane.grid for plane in planes.values()), tuple(planes))


def _values(stream: BinaryIO, zone: Zone, variables: int, places: Sequence[int]) -> list[Array]:
    """Return the coordinates of a zone, flat, i running fastest."""
    entries = zone.entries
    for key, what in _REFUSED.items():
        if key in entries:
            raise GridgenError(f"zone {zone.number} {what} ({key}): write it without")
    if entries.get("ZONETYPE", "ORDERED").upper() != "ORDERED" or entries.get("F", "").upper().startswith("FE"):
        raise GridgenError(f"zone {zone.number} is unstructured; {EXPECTED}")
    if re.search(r"CELLCENTERED", entries.get("VARLOCATION", ""), re.IGNORECASE):
        raise GridgenError(f"zone {zone.number} has cell-centered variables (VARLOCATION): write values at nodes")
    nodes = math.prod(zone.sizes)
    numbers = Numbers(Window(stream, zone.begin, zone.end), EXPECTED, zone.line)
    over = numbers.count - variables * nodes
    if over:
        raise GridgenError(
            f"zone {zone.number} has {numbers.count} numbers, and {variables} variables at {nodes} nodes need "
            f"{variables * nodes}, so that {abs(over)} are {'too many' if over > 0 else 'missing'}: write it again"
        )
    numbers.check_size()
    if _is_by_point(entries, numbers, variables):
        rows = numbers.take(variables * nodes).reshape(nodes, variables)
        return [rows[:, place].copy() for place in places]
    taken = {place: numbers.take(nodes) for place in range(max(places) + 1)}
    return [taken[place] for place in places]


def _is_by_point(entries: Mapping[str, str], numbers: Numbers, variables: int) -> bool:
    """Return whether the numbers of a node stand together; where the header does not say, one node is a line."""
    packing = entries.get("DATAPACKING") or entries.get("F")
    if packing:
        return packing.upper() == "POINT"
    return len(numbers.head_text.split("\n", 1)[0].split()) == variables


def recognizes(start: bytes) -> bool:
    """Return whether a file begins as a Tecplot text does, and is no outline or section of an airfoil."""
    return bool(re.search(rb"^\s*(TITLE|VARIABLES)\s*=", start, re.IGNORECASE | re.MULTILINE))


FORMAT = Format(
    name="Tecplot text",
    suffixes=(".tec", ".dat"),
    decode=decode,
    encode=encode,
    recognizes=recognizes,
    streamed=True,
    several=True,
    dimensions="as a PLOT3D grid",
    writes="an ordered zone for each block, all x, then all y, 17 digits",
    reads="also point by point, with other variables, which are ignored; lines are left out",
    test="tests/io/test_tecplot.py::test_a_text_of_another_writer",
)
