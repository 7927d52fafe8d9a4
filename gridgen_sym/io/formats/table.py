"""Grids as tables: CSV with the columns i, j, x, y in any order, among others."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...errors import GridgenError, quoted, shortened
from ...grids.grid import Grid
from ..format import Format

HEADER = "i,j,x,y"
_COLUMNS = HEADER.split(",")
#: Bytes of a table that are read, and nodes that are written at once.
_PIECE, _ROWS = 1 << 20, 1 << 15
#: An index is below this.
_MOST = 1 << 31
Indices = NDArray[np.int32]


def encode(grid: Grid) -> Iterator[bytes]:
    """Return the pieces of a CSV table: the header ``i,j,x,y``, then one line for each node.

    The last node comes first: its line holds the size, so that a table cut short anywhere is noticed.
    """
    yield f"{HEADER}\n".encode("ascii")
    nj = grid.shape[1]
    for end in range(grid.x.size, 0, -_ROWS):
        places = np.arange(end - 1, max(0, end - _ROWS) - 1, -1)
        i, j = np.divmod(places, nj)
        rows = zip(i.tolist(), j.tolist(), grid.x[i, j].tolist(), grid.y[i, j].tolist(), strict=True)
        yield "".join([f"{i},{j},{x:.17g},{y:.17g}\n" for i, j, x, y in rows]).encode("ascii")


def decode(stream: BinaryIO) -> Grid:
    """Return the grid of a CSV table whose rows come in any order.

    Raises:
        GridgenError: for a wrong header, a row without four numbers, a node that is missing or comes twice,
            or a last line without an end: if that line was cut inside a number, what is left is still a
                number, but a wrong one.
    """
    header = stream.readline(_PIECE)
    columns = _columns(header)
    if columns is None:
        text = header.decode("utf-8-sig", errors="replace").strip()
        raise GridgenError(f"line 1 is {quoted(text, 60)}; expected the header '{HEADER}'")
    parts: list[tuple[Indices, Array]] = []
    line, rest = 2, b""
    while data := stream.read(_PIECE):
        piece, end, rest = (rest + data).rpartition(b"\n")
        if piece.strip():
            parts.append(_rows(piece, columns, line))
        line += piece.count(b"\n") + bool(end)
    if rest.strip():
        raise GridgenError("its last line has no end, so the file may be cut short; if it is whole, add a newline")
    if not parts:
        raise GridgenError("it has a header and no rows; expected one row for each node")
    return _grid_of_rows(parts)


def _columns(header: bytes) -> list[int] | None:
    """Return where i, j, x and y stand in a header; None where they do not."""
    text = header.decode("utf-8-sig", errors="replace")
    names = text.replace(" ", "").replace('"', "").strip().lower().split(",")
    return [names.index(name) for name in _COLUMNS] if {*_COLUMNS} <= {*names} else None


def _rows(piece: bytes, columns: list[int], line: int) -> tuple[Indices, Array]:
    """Return the indices (n, 2) and coordinates (n, 2) of some rows, the first of which is that line of the file."""
    try:
        text = piece.decode("ascii")
        rows = np.loadtxt(io.StringIO(text), delimiter=",", comments=None, ndmin=2, usecols=columns)
    except UnicodeDecodeError as error:
        raise GridgenError(f"a row after line {line - 1} is not text; expected numbers") from error
    except ValueError as error:
        raise GridgenError(
            f"{shortened(error)} (row 0 is line {line}); expected four numbers a row, those of '{HEADER}'"
        ) from error
    indices = rows[:, :2]
    if not ((indices >= 0) & (indices < _MOST) & (np.floor(indices) == indices)).all():
        raise GridgenError(f"the columns i and j must hold whole numbers from 0 on, below {_MOST}")
    return indices.astype(np.int32), rows[:, 2:].copy()


def _grid_of_rows(parts: list[tuple[Indices, Array]]) -> Grid:
    """Put rows (i, j, x, y) in their places, each of which must be filled once; the parts are used up."""
    ni, nj = (1 + max(int(indices[:, axis].max()) for indices, _ in parts) for axis in range(2))
    count = sum(len(indices) for indices, _ in parts)
    if ni * nj != count:  # Also keeps a wild index from asking for a huge array.
        raise GridgenError(
            f"its indices reach {ni} x {nj} nodes, but it has {count} rows; expected one for each node: "
            "the file may be cut short"
        )
    planes, filled = np.empty((2, ni, nj)), np.zeros((ni, nj), dtype=bool)
    while parts:
        indices, points = parts.pop()
        i, j = indices.T
        filled[i, j] = True
        planes[:, i, j] = points.T
    if not filled.all():
        missing = tuple(np.argwhere(~filled)[0].tolist())
        raise GridgenError(f"node {missing} is missing, and another comes twice; expected one row for each node")
    return Grid.from_planes(*planes)


def recognizes(start: bytes) -> bool:
    """Return whether a table has the header of a grid, and is no outline."""
    lines = [line for line in start.splitlines() if line.strip() and not line.startswith(b"#")]
    return bool(lines) and _columns(lines[0]) is not None


FORMAT = Format(
    name="table of nodes",
    suffixes=(".csv",),
    decode=decode,
    encode=encode,
    recognizes=recognizes,
    streamed=True,
    writes=f"a line for each node: `{HEADER}`",
    reads="rows and columns in any order, and other columns, which are ignored",
    test="tests/io/test_files.py::test_the_csv_text_and_rows_in_any_order",
)
