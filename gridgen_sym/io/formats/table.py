"""Grids as tables: CSV with the columns i, j, x, y."""

from __future__ import annotations

import io

import numpy as np

from ...arrays import Array
from ...errors import GridgenError, quoted, shortened
from ...grids.grid import Grid
from ..format import Format

HEADER = "i,j,x,y"


def encode(grid: Grid) -> bytes:
    """Return the grid as a CSV table: the header ``i,j,x,y``, then one line for each node.

    The last node comes first: its line holds the size, so that a table cut short anywhere is noticed.
    """
    columns = (*np.indices(grid.shape), grid.x, grid.y)
    rows = zip(*(column.ravel()[::-1].tolist() for column in columns), strict=True)
    lines = [HEADER, *(f"{i},{j},{x:.17g},{y:.17g}" for i, j, x, y in rows), ""]
    return "\n".join(lines).encode("ascii")


def decode(data: bytes) -> Grid:
    """Return the grid of a CSV table whose rows come in any order.

    Raises:
        GridgenError: for a wrong header, a row without four numbers, a node that is missing or comes twice,
            or a last line without an end: if that line was cut inside a number, what is left is still a
                number, but a wrong one.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise GridgenError(f"byte {error.start} is not text; expected the header '{HEADER}'") from error
    header, _, body = text.partition("\n")
    if header.replace(" ", "").strip().lower() != HEADER:
        raise GridgenError(f"line 1 is {quoted(header.strip(), 60)}; expected the header '{HEADER}'")
    if not body.strip():
        raise GridgenError("it has a header and no rows; expected one row for each node")
    if not body.endswith("\n"):
        raise GridgenError("its last line has no end, so the file may be cut short; if it is whole, add a newline")
    try:
        rows = np.loadtxt(io.StringIO(body), delimiter=",", comments=None, ndmin=2)
    except ValueError as error:
        raise GridgenError(
            f"{shortened(error)} (row 0 is the first below the header); expected four numbers a row"
        ) from error
    if rows.shape[1] != 4:
        raise GridgenError(f"its rows have {rows.shape[1]} columns; expected the four of '{HEADER}'")
    return _grid_of_rows(rows)


def _grid_of_rows(rows: Array) -> Grid:
    """Put rows (i, j, x, y) in their places, each of which must be filled once."""
    if not (np.isfinite(rows[:, :2]).all() and (rows[:, :2] >= 0).all() and (rows[:, :2] % 1 == 0).all()):
        raise GridgenError("the columns i and j must hold whole numbers from 0 on")
    ni, nj = (int(top) + 1 for top in rows[:, :2].max(axis=0))
    if ni * nj != len(rows):  # Also keeps a wild index from asking for a huge array.
        raise GridgenError(
            f"its indices reach {ni} x {nj} nodes, but it has {len(rows)} rows; expected one for each node: "
            "the file may be cut short"
        )
    place = (rows[:, 0] * nj + rows[:, 1]).astype(np.intp)
    counts = np.bincount(place, minlength=ni * nj)
    if (counts != 1).any():
        missing = divmod(int(np.argmin(counts)), nj)
        raise GridgenError(f"node {missing} is missing, and another comes twice; expected one row for each node")
    xy = np.empty((ni * nj, 2))
    xy[place] = rows[:, 2:]
    return Grid(xy.reshape(ni, nj, 2))


def recognizes(start: bytes) -> bool:
    """Return whether a table has the header of a grid, and is no outline."""
    lines = start.decode("utf-8-sig", errors="replace").splitlines()
    header = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    return header.replace(" ", "").lower() == HEADER


FORMAT = Format(
    name="table of nodes",
    suffixes=(".csv",),
    decode=decode,
    encode=encode,
    recognizes=recognizes,
    writes=f"a line for each node: `{HEADER}`",
    reads="rows in any order",
    test="tests/io/test_files.py::test_the_csv_text_and_rows_in_any_order",
)
