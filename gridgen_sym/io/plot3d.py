"""PLOT3D grid files (.xyz, .p2dfmt), ASCII and whole.

Written: the multi-block, three-dimensional form with one block and one k plane, which most programs take:
the line ``1``, the line ``ni nj 1``, then all x, all y and all z (zeros), i running fastest; to
``.p2dfmt``, the suffix of NASA's plane grids, the two-dimensional one: ``ni nj``, and no z. Read: both, also
without the block count, and with iblank after the coordinates where no node is blanked out.
VTK and ParaView cannot distinguish these forms in ASCII: switch 'Multi Grid' on there.
Source: P. P. Walatka et al., PLOT3D User's Manual, NASA TM-101067 (1990), chapter 8.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import islice, repeat

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import GridgenError, quoted, shortened
from ..grids.grid import Grid
from ..messages import report
from .checks import check_packing, plane_grid

_EXPECTED = "expected ASCII numbers: [1,] ni, nj, [1,] then all x, all y [and all z] [and all iblank]"
#: Fortran writes D for E, and leaves the letter out where the exponent has three digits: 1.5D+02, 1.5-120.
_LETTER = re.compile(r"[dDqQ](?<=[0-9.].)(?=[+-]?[0-9])")
_NO_LETTER = re.compile(r"[+-](?<=[0-9.].)(?=[0-9]{1,4}(?:\s|$))")
_MOST_DIGITS = 12  # Of a repeat count: its product with the size of a number stays a 64-bit integer.


def encode(grid: Grid) -> bytes:
    """Return the grid as a PLOT3D file: multi-block, three-dimensional, ASCII."""
    ni, nj = grid.shape
    values = np.concatenate((grid.x.T.ravel(), grid.y.T.ravel(), np.zeros(ni * nj)))
    body = ("%.17g\n" * values.size) % tuple(values.tolist())
    return f"1\n{ni} {nj} 1\n{body}".encode("ascii")


def encode_plane(grid: Grid) -> bytes:
    """Return the grid as a PLOT3D file: multi-block, two-dimensional, ASCII."""
    ni, nj = grid.shape
    values = np.concatenate((grid.x.T.ravel(), grid.y.T.ravel()))
    body = ("%.17g\n" * values.size) % tuple(values.tolist())
    return f"1\n{ni} {nj}\n{body}".encode("ascii")


def decode(data: bytes) -> Grid:
    """Return the grid of a PLOT3D file of one block. That an iblank is ignored is reported.

    Raises:
        GridgenError: for binary data, a word that is no number, several blocks, a volume, z that varies, nodes
            blanked out by iblank, or a count of numbers that does not fit the header.
    """
    try:
        text = data.decode("ascii")
    except UnicodeDecodeError as error:
        raise GridgenError(f"byte {error.start} is not ASCII text, so the file may be binary; {_EXPECTED}") from error
    numbers = _numbers(text)
    head = numbers.head(4)
    counted = head[0] == 1  # No side of a grid has one node, so this is a count of blocks.
    ni, nj, nk = head[1:] if counted else head[:3]
    dimensions = _dimensions(text, counted)
    # Where the lines of the header do not give the dimension, planes of iblank cannot be distinguished from those of z.
    for blanked in (False, True) if len(dimensions) == 1 else (False,):
        for dimension in dimensions:
            depth = nk if dimension == 3 else 1
            skip, planes = counted + dimension, dimension + blanked
            if min(ni, nj, depth) > 0 and numbers.count == skip + planes * ni * nj * depth:
                return _grid(numbers.all()[skip:].reshape(planes, depth, nj, ni), dimension)
    several = " (the first number may count several blocks: split the file)" if head[0] > 1 else ""
    counts = ", repeat counts included," if numbers.repeats is not None else ""
    raise GridgenError(
        f"its {numbers.count} numbers{counts} do not fit its header, which begins {head[:3]}{several}; {_EXPECTED}. "
        "The file may be cut short: write it again"
    )


def _dimensions(text: str, counted: bool) -> tuple[int, ...]:
    """Return the dimensions that the file may have: the words in the header's lines give it, if it has lines.

    The count of all numbers would nearly do, but a three-dimensional file cut short can pass for a whole
    two-dimensional one.
    """
    lines = text.split("\n", 2)
    header = lines[0].split()
    if counted and len(header) == 1 and len(lines) > 1:
        header += lines[1].split()
    sizes = len(header) - counted
    return (sizes,) if sizes in (2, 3) else (3, 2)


def _grid(planes: Array, dimension: int) -> Grid:
    """Return the grid of planes of shape (n, nk, nj, ni): coordinates, and perhaps iblank."""
    if planes.shape[1] != 1:
        raise GridgenError(f"the block is a volume with {planes.shape[1]} k planes; expected 1: cut out one plane")
    x, y, *others = (plane[0].T for plane in planes)
    grid = plane_grid(x, y, others[0] if dimension == 3 else None)
    if len(planes) > dimension:
        _check_iblank(others[-1])
    return grid


def _check_iblank(iblank: Array) -> None:
    """Refuse holes, which iblank = 0 marks; other nodes are nodes of the grid, whatever iblank holds there."""
    if not (iblank % 1 == 0).all():
        raise GridgenError(f"a plane of iblank would fit its header, but its numbers are not whole; {_EXPECTED}")
    holes = np.argwhere(iblank == 0)
    if len(holes):
        i, j = holes[0].tolist()
        raise GridgenError(
            f"its iblank marks {len(holes)} nodes as holes (0), the first of which is node ({i}, {j}): holes cannot be "
            "represented here. Cut out a block without any"
        )
    report("the file's iblank is ignored: it marks no holes")


@dataclass(frozen=True, slots=True)
class _Numbers:
    """The numbers of a file, those that Fortran wrote once for several not yet written out.

    Attributes:
        values: one for each word.
        repeats: how often each is in the file; None for once each.
    """

    values: Array
    repeats: NDArray[np.int64] | None

    @property
    def count(self) -> int:
        """How many numbers there are."""
        # Python's whole numbers do not overflow.
        return len(self.values) if self.repeats is None else sum(self.repeats.tolist())

    def head(self, count: int) -> list[int]:
        """Return the first numbers as whole ones, 0 for any other, and for those that are not there."""
        times = repeat(1) if self.repeats is None else self.repeats.tolist()
        written = (value for value, n in zip(self.values.tolist(), times, strict=False) for _ in range(n))
        first = [int(value) if value.is_integer() else 0 for value in islice(written, count)]
        return first + [0] * (count - len(first))

    def all(self) -> Array:
        """Return all numbers, which `count` has been found to fit the header."""
        if self.repeats is None:
            return self.values
        check_packing(8 * len(self.values), 8 * self.count, "what its repeat counts stand for")
        return np.repeat(self.values, self.repeats)


def _numbers(text: str) -> _Numbers:
    """Return all numbers of the file, with the shorthands of Fortran's output understood."""
    words = _NO_LETTER.sub(r"e\g<0>", _LETTER.sub("e", text.replace(",", " "))).split()
    if not words:
        raise GridgenError(f"it holds no numbers; {_EXPECTED}")
    repeats = None
    if "*" in text:
        pairs = [_repeated(word) for word in words]
        repeats, words = np.array([count for count, _ in pairs], dtype=np.int64), [value for _, value in pairs]
    try:
        if "_" in text:  # NumPy takes 1_0 for ten.
            raise ValueError(f"{quoted(next(word for word in words if '_' in word))} is not a number")
        with np.errstate(all="ignore"):
            return _Numbers(np.array(words, dtype=np.float64), repeats)
    except ValueError as error:
        raise GridgenError(f"{shortened(error)}; {_EXPECTED}") from error


def _repeated(word: str) -> tuple[int, str]:
    """Return how often a word stands for a number, and which: Fortran writes ``3*0.5`` for three equal ones."""
    count, star, value = word.partition("*")
    if not star:
        return 1, word
    if not count.isdigit() or len(count) > _MOST_DIGITS:
        raise GridgenError(
            f"the repeat count in {quoted(word)} is not a number of at most {_MOST_DIGITS} digits; {_EXPECTED}"
        )
    return int(count), value
