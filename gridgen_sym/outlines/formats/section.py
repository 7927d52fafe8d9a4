"""Sections of airfoils as outlines: Selig's and Lednicer's files (.dat)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...arrays import Array
from ...errors import GridgenError, quoted
from ...parsing import number_in
from ..content import OutlineContent
from ..format import OutlineFormat

EXPECTED = (
    "expected Selig's form: a line with the name, then a line 'x y' for each point, from the trailing edge over the "
    "upper side to the leading edge and back on the lower side; or Lednicer's: the name, the two numbers of points, "
    "and the points of the upper and of the lower side from the leading to the trailing edge"
)
#: Ends that are so near, in parts of the extent, are the same point.
_SHARP = 1e-6
#: Names of columns, with which a table of points begins.
_HEADERS = {"x", "lon", "longitude", "lat", "latitude", "easting"}
#: A name may be any text, but it is one line of it.
_LONGEST_NAME = 200


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the closed curve of a section; an open trailing edge is closed by a straight line.

    Ends that are one point but for rounding become one.

    Raises:
        GridgenError: for a line that is no point.
    """
    name, points = parse_section(data, path)
    if len(points) and np.abs(points[0] - points[-1]).max() <= _SHARP * np.ptp(points, axis=0).max():
        points = points[:-1]
    return OutlineContent(points, name)


def recognizes(data: bytes) -> bool:
    """Return whether the first line is a name and the second one two numbers, and no comment or header is there."""
    lines = [line.strip() for line in data[:4000].decode("latin-1").splitlines() if line.strip()][:2]
    if len(lines) < 2 or len(lines[0]) > _LONGEST_NAME or lines[0].startswith(("#", "%", "!")):
        return False
    if _HEADERS & set(lines[0].lower().replace(",", " ").replace('"', "").split()):
        return False
    name, first = (line.replace(",", " ").replace("*", " ").split() for line in lines)
    return not all(map(_is_number, name)) and len(first) == 2 and all(map(_is_number, first))


def parse_section(data: bytes, path: Path) -> tuple[str, Array]:
    """Return the name of a section and its points (n, 2), from the trailing edge around to the trailing edge.

    Coordinates stay what they are.

    Raises:
        GridgenError: for a line that is no point, or other numbers of points than a file of Lednicer's form announces.
    """
    lines = data.decode("latin-1").splitlines()
    rows = [words for words in (line.replace(",", " ").split() for line in lines) if words]
    named = not all(map(_is_number, rows[0])) if rows else False
    name = " ".join(rows[0]) if named else path.stem
    for number, words in enumerate(rows[named:], 1):
        if len(words) != 2 or not all(map(_is_number, words)):
            raise GridgenError(f"point {number} is {quoted(' '.join(words))}; {EXPECTED}")
    points = np.array([[float(word) for word in words] for words in rows[named:]]).reshape(-1, 2)
    if len(points) and 1.5 < points[0].min() <= points[0].max() < np.inf and (points[0] % 1 == 0).all():
        return name, _joined_sides(points)
    return name, points


def _joined_sides(rows: Array) -> Array:
    """Return the points of both sides as one curve; the first row counts those of the upper and of the lower side."""
    upper, lower = (int(count) for count in rows[0])
    points = rows[1:]
    if upper + lower != len(points):
        raise GridgenError(
            f"its first pair {upper} {lower} counts points, as in Lednicer's form, but {len(points)} follow; {EXPECTED}"
        )
    above, below = points[:upper], points[upper:]
    shared = int((above[0] == below[0]).all())
    return np.concatenate((above[::-1], below[shared:]))


def _is_number(word: str) -> bool:
    try:
        number_in(word)
    except ValueError:
        return False
    return True


FORMAT = OutlineFormat(
    "section of an airfoil",
    (".dat",),
    decode,
    "Selig's and Lednicer's form, whose first line is the name; an open trailing edge is closed by a line",
    recognizes=recognizes,
    test="tests/outlines/test_text.py::test_sections_of_both_forms_are_one_curve",
)
