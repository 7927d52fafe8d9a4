"""PLOT3D files, piece by piece, in every form."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import GridgenError
from ..grids.grid import Grid
from .format import Blocks
from .plot3d_forms import check_words

#: Numbers of a piece, and the bytes of a record that a length of four bytes can tell.
_PIECE, _LONGEST_RECORD = 1 << 16, (1 << 31) - 9


def written(blocks: Blocks, words: Collection[str] = ()) -> Iterator[bytes]:
    """Return the pieces of a PLOT3D file.

    Args:
        blocks: the grids; iblank is 1 where they have no masks.
        words: the form; by default `ascii`, `little`, `double`, `count`, `space` and `noiblank`.

    Raises:
        GridgenError: for words that exclude each other, several blocks without their number, a coordinate that single
            precision cannot hold, and a record of more than 2 GiB.
    """
    check_words(words)
    if "nocount" in words and len(blocks.grids) > 1:
        raise GridgenError(f"the form nocount has one block, and here are {len(blocks.grids)}: leave it out")
    if "single" in words and "ascii" not in words and {"fortran", "binary"} & {*words}:
        _check_single(blocks)
    if "fortran" in words:
        return _unformatted(blocks, words)
    return _binary(blocks, words) if "binary" in words else _text(blocks, words)


def _sizes(blocks: Blocks, words: Collection[str]) -> list[list[int]]:
    return [[*grid.shape, *([] if "plane" in words else [1])] for grid in blocks.grids]


def _planes(blocks: Blocks, block: int, words: Collection[str]) -> Iterator[Array | NDArray[np.int32]]:
    """Yield x, y, and what else there is of a block, flat, i running fastest."""
    grid: Grid = blocks.grids[block]
    yield grid.x.T.ravel()
    yield grid.y.T.ravel()
    if "plane" not in words:
        yield np.broadcast_to(0.0, grid.x.size)
    if "iblank" in words:
        mask = np.ones(grid.shape) if blocks.masks is None else blocks.masks[block]
        yield mask.T.ravel().astype(np.int32)


def _text(blocks: Blocks, words: Collection[str]) -> Iterator[bytes]:
    if "nocount" not in words:
        yield f"{len(blocks.grids)}\n".encode("ascii")
    yield "".join(f"{' '.join(map(str, sizes))}\n" for sizes in _sizes(blocks, words)).encode("ascii")
    for block in range(len(blocks.grids)):
        for plane in _planes(blocks, block, words):
            for begin in range(0, plane.size, _PIECE):
                values = plane[begin : begin + _PIECE].tolist()
                yield (("%.17g\n" * len(values)) % tuple(values)).encode("ascii")


def _header(blocks: Blocks, words: Collection[str], order: str) -> list[bytes]:
    """Return the records of the header."""
    count = [] if "nocount" in words else [np.array([len(blocks.grids)])]
    return [numbers.astype(f"{order}i4").tobytes() for numbers in (*count, np.array(_sizes(blocks, words)))]


def _kind(words: Collection[str]) -> tuple[str, np.dtype[np.floating]]:
    """Return the byte order, and the type of a coordinate."""
    order = ">" if "big" in words else "<"
    return order, np.dtype(f"{order}f{4 if 'single' in words else 8}")


def _body(blocks: Blocks, block: int, words: Collection[str]) -> Iterator[bytes]:
    order, coordinate = _kind(words)
    for plane in _planes(blocks, block, words):
        kind = f"{order}i4" if plane.dtype.kind == "i" else coordinate
        yield plane.astype(kind, copy=False).tobytes()


def _binary(blocks: Blocks, words: Collection[str]) -> Iterator[bytes]:
    yield from _header(blocks, words, _kind(words)[0])
    for block in range(len(blocks.grids)):
        yield from _body(blocks, block, words)


def _unformatted(blocks: Blocks, words: Collection[str]) -> Iterator[bytes]:
    order, coordinate = _kind(words)
    for record in _header(blocks, words, order):
        length = np.array(len(record), dtype=f"{order}i4").tobytes()
        yield length + record + length
    numbers = 2 if "plane" in words else 3
    for block, grid in enumerate(blocks.grids):
        size = grid.x.size * (numbers * coordinate.itemsize + 4 * ("iblank" in words))
        if size > _LONGEST_RECORD:
            raise GridgenError(
                f"the record of block {block + 1} would have {size} bytes, more than a length of 4 bytes can tell: "
                "take the form binary"
            )
        length = np.array(size, dtype=f"{order}i4").tobytes()
        yield length
        yield from _body(blocks, block, words)
        yield length


def _check_single(blocks: Blocks) -> None:
    """Refuse coordinates that single precision cannot hold."""
    largest = float(np.finfo(np.float32).max)
    for name, grid in blocks.described:
        found = float(np.abs(grid.planes).max())
        if found > largest:
            raise GridgenError(
                f"block {name} has the coordinate {found:g}, and single precision ends at {largest:g}: take the form "
                "double"
            )
