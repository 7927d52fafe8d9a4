"""The tables of a layout's description in TOML, checked: points, curves, blocks, cells, boundaries, periodic, walls."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..boundary.wall import Wall
from ..errors import GridgenError, quoted
from ..topology.wireframe import Periodic, Wireframe
from .drawing import drawn
from .values import check_keys, pair, real, table
from .walls import described_walls

_TABLES = ("points", "curves", "blocks", "cells", "boundaries", "periodic", "walls")


def decode(data: bytes, folder: Path) -> tuple[Wireframe, dict[str, Wall]]:
    """Return the description of a layout, and its walls by the names of boundaries.

    Args:
        data: the text of the file.
        folder: what its own file names are relative to.

    Raises:
        GridgenError: for text that is no TOML, and tables that describe no layout.
    """
    try:
        given = tomllib.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:  # Also of whole numbers with thousands of digits.
        raise GridgenError(f"it is no TOML file: {error}") from None
    check_keys(given, _TABLES, "a layout", required=("blocks", "cells"))
    points = {name: pair(place, f"the point {name}") for name, place in table(given, "points").items()}
    for name in points:
        if "-" in name:
            raise GridgenError(f"the point {quoted(name)} has a dash in its name, which stands between two points")
    curves = {}
    for name, one in table(given, "curves").items():
        curves[name], places = drawn(name, one, points, folder)
        for end, (x, y) in zip(curves[name].ends, places.tolist(), strict=True):
            points.setdefault(end, (x, y))
    blocks, cells = table(given, "blocks"), table(given, "cells")
    boundaries = {name: _names(name, curves) for name, curves in table(given, "boundaries").items()}
    wireframe = Wireframe(points, curves, blocks, cells, boundaries, [_periodic(one) for one in _array(given)])
    return wireframe, described_walls(table(given, "walls"), boundaries)


def _names(boundary: str, given: object) -> list[str]:
    if not isinstance(given, list) or not given or not all(isinstance(name, str) for name in given):
        raise GridgenError(f"the boundary {boundary} must be a list of curves, such as ['A-B']; came {quoted(given)}")
    return given


def _array(given: Mapping[str, Any]) -> list[Any]:
    found = given.get("periodic", [])
    if not isinstance(found, list):
        raise GridgenError(f"periodic must be written [[periodic]], once for each pair; came {quoted(found)}")
    return found


def _periodic(given: Any) -> Periodic:  # noqa: ANN401
    check_keys(given, ("curves", "translation", "rotation", "center"), "periodic", required=("curves",))
    names = _names("periodic", given["curves"])
    if len(names) != 2:
        raise GridgenError(f"periodic takes two curves, the first of which moves to the second; came {quoted(names)}")
    read: dict[str, Callable[[Any, str], Any]] = {"translation": pair, "rotation": real, "center": pair}
    motion = {key: read[key](value, f"{key} of periodic") for key, value in given.items() if key in read}
    return Periodic((names[0], names[1]), **motion)
