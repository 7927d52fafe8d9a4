"""Outlines as text: comment lines, perhaps a header, and a line for each point; also gridgen-c's, SeaGrid's input."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...errors import GridgenError, quoted
from ...messages import report
from ...parsing import number_in, whole_number_in
from ..columns import Columns, columns_of_header, columns_of_numbers
from ..content import OutlineContent
from ..format import OutlineFormat
from ..loops import outline_of_loops

_COMMENTS = ("#", "%", "!")
_NUMBERS = {2: "two", 3: "three", 4: "four"}


@dataclass(slots=True)
class _Table:
    """The lines of one closed curve.

    Attributes:
        rows: words of each line of numbers, with its number.
        start: the point that an asterisk marks as the first corner, as gridgen-c has it.
    """

    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    start: int = 0


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the outline of a text, whose columns have commas, semicolons, tabs or blanks between them.

    The first line that is no comment decides which; with semicolons a comma may be the decimal point. After the comment
    line ``# island`` the points of an island follow. Lines of NaN part closed curves, as in files of coasts for Matlab:
    the largest is the outline, and those inside it are its islands.

    Raises:
        GridgenError: for columns that are neither named nor known, or a line that is no point, with its number.
    """
    name, corners, separator, header = "", None, None, None
    tables, parted = [_Table()], False
    for number, line in enumerate(data.decode("utf-8-sig", errors="replace").splitlines(), start=1):
        stripped = line.strip()
        if stripped.startswith(_COMMENTS):
            key, _, value = stripped[1:].partition(":")
            if key.strip() == "name":
                name = value.strip()
            elif key.strip() == "corners":
                corners = _corners(value, f"line {number}")
            elif key.strip() == "island" and tables[-1].rows:
                tables.append(_Table())
        elif stripped:
            first, separator = separator is None, separator or _separator(stripped)
            words = _words(stripped, separator)
            if all(word.lower() == "nan" for word in words):
                parted = True
                tables.append(_Table())
            elif first and not any(map(_is_number, words)):
                header = _header(words, number, stripped)
            else:
                _add(tables[-1], words, number)
    tables = [table for table in tables if table.rows]
    if not tables:
        raise GridgenError("it has no points; expected the header 'x,y' and a line for each")
    if header and header.doubt:
        report(f"{path}: {header.doubt}")
    found = _content(name, corners, tables, header, separator or " ")
    if not parted:
        return found
    loops = [curve for curve in (found.points, *found.islands) if len(curve) > 2]
    largest = outline_of_loops(loops, path, name, found.geographic)
    return OutlineContent(largest.points, name, corners, largest.islands, found.geographic)


def _content(
    name: str, corners: list[int] | None, tables: list[_Table], header: Columns | None, separator: str
) -> OutlineContent:
    """Return the outline and its islands, from the lines of each."""
    curves, marks = [], None
    for k, table in enumerate(tables):
        rows = _numbers(table, header, separator)
        columns = header or columns_of_numbers(rows)
        points = rows[:, [columns.x, columns.y]]
        if k == 0 and columns.mark is not None:
            points, given = _started(points, np.nan_to_num(rows[:, columns.mark]), table.start)
            marks = given.tolist() if given.any() else None
        curves.append(points)
    chosen = corners if corners is not None else marks
    return OutlineContent(curves[0], name, chosen, tuple(curves[1:]), header.geographic if header else None)


def _started(points: Array, marks: Array, start: int) -> tuple[Array, Array]:
    """Return points and marks from the point on that is the first corner; copies of point 0 at the end are left out."""
    while start and len(points) > 1 and (points[-1] == points[0]).all():
        marks[0] = marks[0] or marks[-1]
        points, marks = points[:-1], marks[:-1]
    return np.roll(points, -start, axis=0), np.roll(marks, -start)


def _add(table: _Table, words: list[str], number: int) -> None:
    if words[-1].endswith("*"):
        words[-1], table.start = words[-1].rstrip("* "), len(table.rows)
        words = [word for word in words if word]
    table.rows.append((number, words))


def _numbers(table: _Table, header: Columns | None, separator: str) -> Array:
    """Return the numbers of a table, (N, columns), of which a line without a header may lack the third.

    Raises:
        GridgenError: for a line with other columns, or a word in x, y or the marks that is no number.
    """
    count = (header and header.count) or max(2, min(4, max(len(words) for _, words in table.rows)))
    wanted = set(range(count)) if header is None else {header.x, header.y, header.mark}
    rows = np.full((len(table.rows), count), np.nan)
    for k, (number, words) in enumerate(table.rows):
        short = header is None and count == 3 and len(words) == 2
        try:
            if len(words) != count and not short:
                raise ValueError
            rows[k, : len(words)] = [number_in(word) if at in wanted else 0.0 for at, word in enumerate(words)]
        except ValueError:
            raise _no_point(number, words, separator, count, first=k == 0 and header is None) from None
    return rows


def _no_point(number: int, words: list[str], separator: str, count: int, *, first: bool) -> GridgenError:
    between = {";": "a semicolon", ",": "a comma", "\t": "a tab", " ": "blanks"}[separator]
    numbers = f"{_NUMBERS.get(count, str(count))} numbers"
    wanted = f"the header 'x,y' (put # before any other) or {numbers}" if first else numbers
    joined = (separator if separator != " " else " ").join(words)
    return GridgenError(f"line {number} is {quoted(joined, 60)}; expected {wanted} with {between} between")


def _header(words: list[str], number: int, line: str) -> Columns:
    try:
        return columns_of_header(words)
    except GridgenError as error:
        raise GridgenError(f"line {number} is {quoted(line, 60)}; {error}") from None


def _corners(value: str, where: str) -> list[int]:
    """Return the corners of a comment line."""
    try:
        corners = [whole_number_in(word) for word in value.replace(",", " ").split()]
    except ValueError:
        corners = []
    if len(corners) != 4:
        raise GridgenError(
            f"{where} has the corners {quoted(value.strip(), 60)}; expected four whole numbers, as '0 10 20 30'"
        )
    return corners


def _separator(line: str) -> str:
    """Return the separator of the columns of a line; a blank means any blanks."""
    found = next((mark for mark in ";,\t" if mark in line), " ")
    return " " if found == "\t" and all(map(_is_number, line.split())) else found


def _words(line: str, separator: str) -> list[str]:
    """Return the columns of a line; where semicolons separate them, a comma is a decimal point."""
    if separator == " ":
        return line.split()
    words = [word.strip() for word in line.split(separator)]
    words = [word[1:-1] if len(word) > 1 and word[0] == word[-1] == '"' else word for word in words]
    return [word.replace(",", ".") for word in words] if separator == ";" else words


def _is_number(word: str) -> bool:
    try:
        number_in(word.rstrip("* "))
    except ValueError:
        return False
    return True


FORMAT = OutlineFormat(
    "table of points",
    (".csv", ".txt", ".tsv", ".xy", ".dat"),
    decode,
    "points in lines, columns by the names of a header in any order (`x,y`, `lon,lat`, a number of the point, marks "
    "`beta`), or x, y and the marks of gridgen-c, pygridgen or SeaGrid in a third column; `# corners:`, `# island`",
    test="tests/outlines/test_text.py::test_columns_are_found_by_name_or_by_number",
)
