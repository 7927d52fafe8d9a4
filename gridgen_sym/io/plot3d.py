"""PLOT3D grid files (.xyz), ASCII and whole.

Written: the multi-block, three-dimensional form with one block and one k plane, which most programs take:
the line ``1``, the line ``ni nj 1``, then all x, all y and all z (zeros), i running fastest. Read: also
without the block count, and two-dimensional (no z). VTK and ParaView cannot tell these forms apart in
ASCII: switch 'Multi Grid' on there.
Source: P. P. Walatka et al., PLOT3D User's Manual, NASA TM-101067 (1990), chapter 8.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..errors import GridgenError
from ..grids.grid import Grid

_EXPECTED = "expected ASCII numbers: [1,] ni, nj, [1,] then all x, all y [and all z]"


def encode(grid: Grid) -> bytes:
    """Return the grid as a PLOT3D file: multi-block, three-dimensional, ASCII."""
    ni, nj = grid.shape
    values = np.concatenate((grid.x.T.ravel(), grid.y.T.ravel(), np.zeros(ni * nj)))
    body = ("%.17g\n" * values.size) % tuple(values.tolist())
    return f"1\n{ni} {nj} 1\n{body}".encode("ascii")


def decode(data: bytes) -> Grid:
    """Return the grid of a PLOT3D file of one block.

    Raises:
        GridgenError: for binary data, a word that is no number, several blocks, a volume, z that varies, or a
            count of numbers that does not fit the header.
    """
    try:
        text = data.decode("ascii")
    except UnicodeDecodeError as error:
        raise GridgenError(f"byte {error.start} is not ASCII text, so the file may be binary; {_EXPECTED}") from error
    numbers = _numbers(text)
    head = [int(value) if value.is_integer() else 0 for value in numbers[:4].tolist()]
    head += [0] * (4 - len(head))
    counted = head[0] == 1  # No side of a grid has one node, so this is a count of blocks.
    ni, nj, nk = head[1:] if counted else head[:3]
    for dimension in _dimensions(text, counted):
        depth = nk if dimension == 3 else 1
        skip = counted + dimension
        if min(ni, nj, depth) > 0 and numbers.size == skip + dimension * ni * nj * depth:
            return _grid(numbers[skip:].reshape(dimension, depth, nj, ni))
    several = " (the first number may count several blocks: split the file)" if head[0] > 1 else ""
    raise GridgenError(
        f"its {numbers.size} numbers do not fit its header, which begins {head[:3]}{several}; {_EXPECTED}. "
        "The file may be cut short: write it again"
    )


def _dimensions(text: str, counted: bool) -> tuple[int, ...]:
    """Return the dimensions that the file may have: the words in the header's lines say it, if it has lines.

    The count of all numbers would nearly do, but a three-dimensional file cut short can pass for a whole
    two-dimensional one.
    """
    lines = text.split("\n", 2)
    header = lines[0].split()
    if counted and len(header) == 1 and len(lines) > 1:
        header += lines[1].split()
    sizes = len(header) - counted
    return (sizes,) if sizes in (2, 3) else (3, 2)


def _grid(planes: Array) -> Grid:
    """Return the grid of coordinate planes of shape (2 or 3, nk, nj, ni)."""
    if planes.shape[1] != 1:
        raise GridgenError(f"the block is a volume with {planes.shape[1]} k planes; expected 1: cut out one plane")
    if len(planes) == 3 and np.ptp(planes[2]) != 0:
        raise GridgenError("the block is a surface in space, its z varies; expected a plane grid")
    return Grid.from_planes(planes[0, 0].T, planes[1, 0].T)


def _numbers(text: str) -> Array:
    """Return all numbers of the file, with the shorthands of Fortran's list-directed output written out."""
    words = text.replace(",", " ").replace("D", "e").replace("d", "e").split()
    if "*" in text:
        words = [part for word in words for part in _repeated(word)]
    if not words:
        raise GridgenError(f"it holds no numbers; {_EXPECTED}")
    try:
        with np.errstate(all="ignore"):
            return np.array(words, dtype=np.float64)
    except ValueError as error:
        raise GridgenError(f"{error}; {_EXPECTED}") from error


def _repeated(word: str) -> list[str]:
    """Write out Fortran's ``3*0.5`` as three words."""
    count, star, value = word.partition("*")
    if not star:
        return [word]
    if not count.isdigit() or len(count) > 7:
        raise GridgenError(f"the repeat count in '{word}' is not a number below 10 million; {_EXPECTED}")
    return [value] * int(count)
