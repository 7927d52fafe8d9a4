"""The text of an outline file: comment lines, perhaps the header x,y, and one line for each point."""

from __future__ import annotations

import os

from ..errors import GridgenError, quoted
from ..parsing import number_in, whole_number_in


def parse_outline(text: str, path: str | os.PathLike[str]) -> tuple[str, list[int] | None, list[list[float]]]:
    """Return name (perhaps empty), corners (perhaps None) and points from the lines of an outline file at `path`.

    The columns have commas, semicolons (then a comma may stand for the decimal point), tabs or blanks between them: the
    first line that is no comment decides.

    Raises:
        GridgenError: for a header other than x,y, or a line that is no point, with its number.
    """
    name, corners, separator = "", None, None
    points: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        stripped, where = line.strip(), f"cannot read {path}: line {number}"
        if stripped.startswith("#"):
            key, _, value = stripped[1:].partition(":")
            if key.strip() == "name":
                name = value.strip()
            elif key.strip() == "corners":
                corners = _parsed_corners(value, where)
        elif stripped:
            first, separator = separator is None, separator or _separator(stripped)
            if not (first and _is_header(stripped, separator)):
                points.append(_parsed_point(stripped, separator, first, where))
    if separator is None:
        raise GridgenError(f"cannot read {path}: it has no points; expected the header 'x,y' and a line for each")
    return name, corners, points


def _parsed_corners(value: str, where: str) -> list[int]:
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
    return next((mark for mark in ";,\t" if mark in line), " ")


def _is_header(line: str, separator: str) -> bool:
    return [word.strip(' "').lower() for word in _words(line, separator)] == ["x", "y"]


def _parsed_point(line: str, separator: str, first: bool, where: str) -> list[float]:
    """Return the point of a line; the first one may have been meant for a header."""
    try:
        x, y = (number_in(word) for word in _words(line, separator))
    except ValueError as error:
        between = {";": "a semicolon", ",": "a comma", "\t": "a tab", " ": "blanks"}[separator]
        wanted = "the header 'x,y' (put # before any other) or two numbers" if first else "two numbers"
        raise GridgenError(f"{where} is {quoted(line, 60)}; expected {wanted} with {between} between") from error
    return [x, y]


def _words(line: str, separator: str) -> list[str]:
    """Return the columns of a line; where semicolons separate them, a comma is a decimal point."""
    if separator == " ":
        return line.split()
    words = line.split(separator)
    return [word.replace(",", ".") for word in words] if separator == ";" else words
