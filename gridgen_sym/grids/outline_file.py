"""The text of an outline file: comment lines, the header x,y, and one line for each point."""

from __future__ import annotations

import os

from ..errors import GridgenError


def parse_outline(text: str, path: str | os.PathLike[str]) -> tuple[str, list[int] | None, list[list[float]]]:
    """Return name (perhaps empty), corners (perhaps None) and points from the lines of an outline file at `path`.

    Raises:
        GridgenError: for a missing or malformed header, or a line that is no point, with its number.
    """
    name, corners, headed = "", None, False
    points: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        stripped, where = line.strip(), f"cannot read {path}: line {number}"
        if stripped.startswith("#"):
            key, _, value = stripped[1:].partition(":")
            if key.strip() == "name":
                name = value.strip()
            elif key.strip() == "corners":
                corners = _parsed_corners(value, where)
        elif not headed and stripped:
            if stripped.replace(" ", "").lower() != "x,y":
                raise GridgenError(f"{where} is {stripped[:60]!r}; expected the header 'x,y' before the points")
            headed = True
        elif stripped:
            points.append(_parsed_point(stripped, where))
    if not headed:
        raise GridgenError(f"cannot read {path}: it has no points; expected the header 'x,y' and a line for each")
    return name, corners, points


def _parsed_corners(value: str, where: str) -> list[int]:
    """Return the corners of a comment line."""
    try:
        corners = [int(word) for word in value.split()]
    except ValueError:
        corners = []
    if len(corners) != 4:
        raise GridgenError(f"{where} has the corners {value.strip()!r}; expected four whole numbers, as '0 10 20 30'")
    return corners


def _parsed_point(line: str, where: str) -> list[float]:
    """Return the point of a line."""
    try:
        x, y = (float(word) for word in line.split(","))
    except ValueError as error:
        raise GridgenError(f"{where} is {line[:60]!r}; expected two numbers with a comma between") from error
    return [x, y]
