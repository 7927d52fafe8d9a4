"""Which column of a table of points holds what: by the names of a header, or by the numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted

#: Names of columns, without blanks, underscores, units and quotes.
_PLANE = (
    {"x", "xcoord", "xcoordinate", "coordx", "pointx", "easting", "east", "e", "xm", "xutm", "utmx"},
    {"y", "ycoord", "ycoordinate", "coordy", "pointy", "northing", "north", "n", "ym", "yutm", "utmy"},
)
_GEOGRAPHIC = (
    {"lon", "long", "lng", "longitude", "degreeseast", "londeg", "longitudedeg"},
    {"lat", "latitude", "degreesnorth", "latdeg", "latitudedeg"},
)
_MARKS = {"beta", "corner", "corners", "iscorner", "cornerflag", "mark", "marks", "turn", "turns", "flag"}
_OTHER = {
    *("", "i", "k", "id", "fid", "gid", "oid", "no", "nr", "num", "number", "index", "idx", "point", "node", "vertex"),
    *("vertexindex", "vertexpart", "unnamed:0", "name", "z", "elevation", "depth", "height", "h", "s", "distance"),
}


@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of a table: where x, y and the marks of corners stand.

    Attributes:
        x: index of the column.
        y: the same.
        mark: the same; None without marks.
        count: how many columns a line has; None if it may lack the mark.
        geographic: whether x and y are longitude and latitude; None if nothing says so.
        doubt: what was assumed, to be reported; empty if the names are clear.
    """

    x: int
    y: int
    mark: int | None = None
    count: int | None = None
    geographic: bool | None = None
    doubt: str = ""


def columns_of_header(words: Sequence[str]) -> Columns:
    """Return the columns that a header names, in whatever order.

    Raises:
        GridgenError: if it does not name a column for x and one for y, each once.
    """
    names = [_plain(word) for word in words]
    mark = next((k for k, name in enumerate(names) if name in _MARKS), None)
    for kinds, geographic in ((_PLANE, False), (_GEOGRAPHIC, True)):
        found = [[k for k, name in enumerate(names) if name in kind] for kind in kinds]
        if all(len(places) == 1 for places in found):
            return Columns(found[0][0], found[1][0], mark, len(names), geographic or None)
    free = [k for k, name in enumerate(names) if k != mark and name not in _OTHER]
    if len(free) == 2 and not any(names[k] in kind for k in free for kind in (*_PLANE, *_GEOGRAPHIC)):
        taken = " and ".join(quoted(words[k], 30) for k in free)
        return Columns(free[0], free[1], mark, len(names), None, f"the columns {taken} are taken for x and y")
    raise GridgenError(
        "expected the header 'x,y', or 'lon,lat', among other names once each, in any order (put # before a line "
        "that is no header)"
    )


def columns_of_numbers(rows: Array) -> Columns:
    """Return the columns of a table without a header, from its numbers, NaN where a line lacks the third.

    Three columns are a number of the point, x and y, or x, y and the marks of corners, which sum to 4, or a z that is
    constant.

    Raises:
        GridgenError: if nothing shows what the columns are.
    """
    count = rows.shape[1]
    if count == 2:
        return Columns(0, 1)
    last = np.nan_to_num(rows[:, -1])
    closed = bool((rows[0, count - 3 : -1] == rows[-1, count - 3 : -1]).all())  # The copy may be marked, too.
    sums = [last.sum(), last[:-1].sum()] if closed else [last.sum()]
    marked = any(abs(one - 4) < 1e-6 for one in sums) and bool((np.abs(last) < 3).all()) and len(rows) > 3
    numbered = bool(len(rows) > 2 and (np.diff(rows[:, 0]) == 1).all() and rows[0, 0] in (0, 1))
    if count == 3 and marked:
        return Columns(0, 1, 2)
    if not np.isnan(rows).any():
        if count == 3 and numbered:
            return Columns(1, 2)
        if count == 4 and numbered and marked:
            return Columns(1, 2, 3)
        if count == 3 and (last == last[0]).all():
            return Columns(0, 1)
    raise GridgenError(
        f"nothing shows what its {count} columns are: x, y and marks of corners, whose sum is 4, or the number of the "
        "point, x and y; put a header such as 'x,y,beta' above them"
    )


def _plain(word: str) -> str:
    """Return the name of a column without its unit, quotes, blanks and underscores."""
    name = re.sub(r"[\[(].*", "", word.strip().strip("\"'").lower())
    name = re.sub(r"[_ ](m|km|deg|degrees|ft)$", "", name.strip())
    return re.sub(r"[\s_-]", "", name)
