"""PLOT3D grid files (.xyz, .p2dfmt), ASCII and whole, of one block or several.

Written: the multi-block, three-dimensional form with one k plane, which most programs take: the number of blocks,
a line ``ni nj 1`` for each, then for each all x, all y and all z (zeros), i running fastest; to ``.p2dfmt``, the
suffix of NASA's plane grids, the two-dimensional one: ``ni nj``, and no z. Read: both, one block also without the
count, and with iblank after the coordinates where no node is blanked out.
VTK and ParaView cannot distinguish these forms in ASCII: switch 'Multi Grid' on there.
Source: P. P. Walatka et al., PLOT3D User's Manual, NASA TM-101067 (1990), chapter 8.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...errors import GridgenError
from ...grids.grid import Grid
from ...messages import report
from ..checks import plane_grid
from ..format import Blocks, Format
from ..plot3d_numbers import EXPECTED, Numbers, numbers_in

_MOST_BLOCKS = 100_000  # A first number that is larger counts no blocks.


def encode(blocks: Blocks) -> bytes:
    """Return blocks as a PLOT3D file: multi-block, three-dimensional, ASCII."""
    return encoded(blocks.grids, " 1", lambda grid: (grid.x, grid.y, np.zeros(grid.shape)))


def encoded(grids: Sequence[Grid], depth: str, planes_of: Callable[[Grid], tuple[Array, ...]]) -> bytes:
    """Return the text of a file of these planes, whose headers end with `depth`."""
    sizes = "".join(f"{ni} {nj}{depth}\n" for ni, nj in (grid.shape for grid in grids))
    values = np.concatenate([plane.T.ravel() for grid in grids for plane in planes_of(grid)])
    body = ("%.17g\n" * values.size) % tuple(values.tolist())
    return f"{len(grids)}\n{sizes}{body}".encode("ascii")


def decode(data: bytes) -> Blocks:
    """Return the grids of a PLOT3D file, block by block. That an iblank is ignored is reported.

    Raises:
        GridgenError: for binary data, a word that is no number, a volume, z that varies, nodes blanked out by iblank,
            or a count of numbers that does not fit the header.
    """
    try:
        text = data.decode("ascii")
    except UnicodeDecodeError as error:
        raise GridgenError(f"byte {error.start} is not ASCII text, so the file may be binary; {EXPECTED}") from error
    numbers = numbers_in(text)
    forms = list(_forms(text, numbers))
    for form in forms:
        if numbers.count == form.count:
            return Blocks(tuple(_grids(numbers.all(), form)))
    counts = ", repeat counts included," if numbers.repeats is not None else ""
    needed = " or ".join(dict.fromkeys(f"{form.described} needs {form.count}" for form in forms))
    raise GridgenError(
        f"its {numbers.count} numbers{counts} do not fit its header, which begins {numbers.head(3)}"
        f"{f' ({needed})' if needed else ''}; {EXPECTED}. The file may be cut short: write it again"
    )


@dataclass(frozen=True, slots=True)
class _Form:
    """What a header may mean.

    Attributes:
        skip: how many numbers the header has.
        sizes: (ni, nj, nk) of every block.
        dimension: how many coordinates a node has.
        blanked: whether each block has a plane of iblank.
    """

    skip: int
    sizes: tuple[tuple[int, int, int], ...]
    dimension: int
    blanked: bool

    @property
    def planes(self) -> int:
        """How many numbers a node has."""
        return self.dimension + self.blanked

    @property
    def count(self) -> int:
        """How many numbers the file has."""
        return self.skip + self.planes * sum(ni * nj * nk for ni, nj, nk in self.sizes)

    @property
    def described(self) -> str:
        """The form in words for a message."""
        ni, nj, nk = self.sizes[0]
        first = f"{ni} x {nj}" + f" x {nk}" * (self.dimension == 3)
        blocks = f"{len(self.sizes)} blocks, the first of {first} nodes," if len(self.sizes) > 1 else f"{first} nodes"
        return f"{blocks} in {self.dimension} dimensions" + " with iblank" * self.blanked


def _forms(text: str, numbers: Numbers) -> Iterator[_Form]:
    """Yield what the header may mean, the likeliest first."""
    count, alone = numbers.head(1)[0], len(text.split("\n", 1)[0].split()) == 1
    # No side of a grid has one node, so that 1 counts blocks; a number alone in its line most likely does so, too.
    counted = [True] if count == 1 else [True, False] if alone else [False, True]
    for has_count in counted:
        blocks = count if has_count else 1
        if not 0 < blocks <= min(_MOST_BLOCKS, numbers.count):
            continue
        dimensions = _dimensions(text, blocks, has_count=has_count)
        # Where the lines of the header do not give the dimension, iblank cannot be distinguished from z.
        for blanked in (False, True) if len(dimensions) == 1 else (False,):
            for dimension in dimensions:
                skip = has_count + dimension * blocks
                head = np.array(numbers.head(skip)[has_count:], dtype=object).reshape(blocks, dimension)
                sizes = tuple((ni, nj, rest[0] if rest else 1) for ni, nj, *rest in head.tolist())
                if min(min(size) for size in sizes) > 0:
                    yield _Form(skip, sizes, dimension, blanked)


def _dimensions(text: str, blocks: int, *, has_count: bool) -> tuple[int, ...]:
    """Return the dimensions that the file may have: the words in the header's lines give it, if it has lines.

    The count of all numbers would nearly do, but a three-dimensional file cut short can pass for a whole
    two-dimensional one.
    """
    lines = text.split("\n", 2)
    words = len(lines[0].split()) - has_count
    if words == 0 and len(lines) > 1:
        words = len(lines[1].split())
    known = {3 * blocks: 3, 2 * blocks: 2, 3: 3, 2: 2}  # All sizes in one line, or those of one block.
    return (known[words],) if words in known else (3, 2)


def _grids(values: Array, form: _Form) -> list[Grid]:
    """Return the grids of all numbers of a file."""
    grids, begin = [], form.skip
    for number, (ni, nj, nk) in enumerate(form.sizes, start=1):
        end = begin + form.planes * ni * nj * nk
        try:
            grids.append(_grid(values[begin:end].reshape(form.planes, nk, nj, ni), form.dimension))
        except GridgenError as error:
            if len(form.sizes) == 1:
                raise
            raise GridgenError(f"block {number}: {error}") from error
        begin = end
    if form.blanked:
        report("the file's iblank is ignored: it marks no holes")
    return grids


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
        raise GridgenError(f"a plane of iblank would fit its header, but its numbers are not whole; {EXPECTED}")
    holes = np.argwhere(iblank == 0)
    if len(holes):
        i, j = holes[0].tolist()
        raise GridgenError(
            f"its iblank marks {len(holes)} nodes as holes (0), the first of which is node ({i}, {j}): holes cannot be "
            "represented here. Cut out a block without any"
        )


FORMAT = Format(
    name="PLOT3D grid",
    suffixes=(".xyz",),
    decode=decode,
    encode=encode,
    several=True,
    dimensions="planes: one k plane of constant z",
    writes="ASCII, 17 digits, multi-block, three-dimensional",
    reads="also without the count of blocks, without z, with iblank (no holes); numbers as Fortran writes them",
    test="tests/io/test_files.py::test_all_forms_of_plot3d",
)
