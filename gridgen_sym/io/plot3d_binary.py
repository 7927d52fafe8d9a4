"""PLOT3D files that are no text: unformatted by Fortran, or binary as C writes them, of any order and precision."""

from __future__ import annotations

import io
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import GridgenError
from .plot3d_forms import MOST_BLOCKS, Form, allows, chosen_form, is_plausible, unfit

_EXPECTED = (
    "expected whole numbers of 4 bytes, [count of blocks,] ni, nj, [nk] of each block, then for each all x, all y [and "
    "all z] of 4 or 8 bytes [and all iblank of 4], with or without the records of Fortran"
)


@dataclass(frozen=True, slots=True)
class _Source:
    """A file, and how many bytes it has."""

    stream: BinaryIO
    size: int

    def integers(self, offset: int, count: int, order: str, width: int = 4) -> list[int]:
        """Return whole numbers at an offset; fewer where the file ends."""
        self.stream.seek(offset)
        data = self.stream.read(count * width)
        found: list[int] = np.frombuffer(data[: len(data) // width * width], dtype=f"{order}i{width}").tolist()
        return found

    def record(self, offset: int, order: str, width: int) -> int:
        """Return the length of the record of Fortran at an offset; -1 where there is none."""
        first = self.integers(offset, 1, order, width)
        if not first or not 0 < first[0] <= self.size - offset - 2 * width:
            return -1
        return first[0] if self.integers(offset + width + first[0], 1, order, width) == first else -1


def read_binary(stream: BinaryIO, words: Collection[str]) -> tuple[Form, Iterator[list[Array]]]:
    """Return the form of a file that is no text, and for each block all x, all y, and what else there is, flat.

    Nothing is allocated before the length of the file has been found to be that of its form.

    Raises:
        GridgenError: if the length fits no form.
    """
    source = _Source(stream, stream.seek(0, io.SEEK_END))
    forms = [form for form in _forms(source) if allows(words, form)]
    fitting = [form for form in forms if form.count == source.size]
    if not fitting:
        raise unfit(forms, source.size, f"its {source.size} bytes fit no header of PLOT3D that it may have", _EXPECTED)
    form = chosen_form(fitting, lambda form: next(_blocks(stream, form)))
    if form.kind == "binary" and "binary" not in words and not is_plausible(form, next(_blocks(stream, form))):
        # Without records the length is all that was checked; a file cut short may have that of another form.
        raise GridgenError(
            f"its {source.size} bytes would fit {form.described}, but then its numbers are none of a grid: it may be "
            f"cut short. If it is whole, read it with the form '{' '.join(form.words)}'"
        )
    return form, _blocks(stream, form)


def _forms(source: _Source) -> Iterator[Form]:
    """Yield what the header may mean: records, where there are any, else every way to read the first numbers."""
    found = [form for order, marker in product("<>", (4, 8)) for form in _of_records(source, order, marker)]
    yield from found or (form for order in "<>" for form in _of_numbers(source, order))


def _of_records(source: _Source, order: str, marker: int) -> Iterator[Form]:
    """Yield the forms that the first records of Fortran allow."""
    counted = source.record(0, order, marker) == 4
    offset = (4 + 2 * marker) * counted
    blocks = source.integers(marker, 1, order)[0] if counted else 1
    length = source.record(offset, order, marker)
    for dimension in (3, 2):
        if 0 < blocks <= MOST_BLOCKS and length == 4 * dimension * blocks:
            head = source.integers(offset + marker, dimension * blocks, order)
            yield from _with_planes(head, dimension, "fortran", order, counted=counted, marker=marker)


def _of_numbers(source: _Source, order: str) -> Iterator[Form]:
    """Yield the forms that the first numbers of a file without records allow."""
    for counted, dimension in product((True, False), (3, 2)):
        blocks = source.integers(0, 1, order)[0] if counted and source.size >= 4 else 1
        if 0 < blocks <= MOST_BLOCKS:
            head = source.integers(4 * counted, dimension * blocks, order)
            yield from _with_planes(head, dimension, "binary", order, counted=counted)


def _with_planes(
    head: list[int], dimension: int, kind: str, order: str, *, counted: bool, marker: int = 4
) -> Iterator[Form]:
    """Yield the forms of a header: either precision, with iblank or not."""
    if len(head) < dimension or len(head) % dimension or min(head) < 1:
        return
    rows = [head[k : k + dimension] for k in range(0, len(head), dimension)]
    sizes = tuple((row[0], row[1], row[2] if dimension == 3 else 1) for row in rows)
    for blanked, precision in product((False, True), (8, 4)):
        yield Form(sizes, dimension, blanked, counted, kind, order, precision, marker)


def _blocks(stream: BinaryIO, form: Form) -> Iterator[list[Array]]:
    """Yield the planes of each block; a record that is not as long as these are is refused."""
    marker = form.marker if form.kind == "fortran" else 0
    stream.seek(4 * form.header + 2 * marker * (form.counted + 1))
    coordinate, whole = np.dtype(f"{form.order}f{form.precision}"), np.dtype(f"{form.order}i4")
    for number, (ni, nj, nk) in enumerate(form.sizes, start=1):
        count = ni * nj * nk
        length = count * (form.dimension * form.precision + 4 * form.blanked)
        _check_length(stream, form, marker, length, number)
        kinds = [coordinate] * form.dimension + [whole] * form.blanked
        yield [_plane(stream, count, kind) for kind in kinds]
        _check_length(stream, form, marker, length, number)


def _check_length(stream: BinaryIO, form: Form, marker: int, length: int, block: int) -> None:
    """Read the length before or after a record, if there are records."""
    if marker:
        found = int(np.frombuffer(stream.read(marker), dtype=f"{form.order}i{marker}")[0])
        if found != length:
            raise GridgenError(
                f"the record of block {block} has {found} bytes; expected {length}: write the file again"
            )


def _plane(stream: BinaryIO, count: int, kind: np.dtype[np.generic]) -> Array:
    """Return the next numbers of a file, in the byte order of the machine."""
    values: NDArray[Any] = np.frombuffer(stream.read(count * kind.itemsize), dtype=kind)
    return values.astype(kind.newbyteorder("="), copy=False)
