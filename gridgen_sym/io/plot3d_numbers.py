"""The numbers of a PLOT3D file, with the shorthands of Fortran's output understood."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import islice, repeat

import numpy as np
from numpy.typing import NDArray

from ..archives import check_packing
from ..arrays import Array
from ..errors import GridgenError, quoted, shortened
from ..parsing import number_in

EXPECTED = (
    "expected ASCII numbers: [count of blocks,] ni, nj, [1,] of each block, then for each all x, all y [and all z] "
    "[and all iblank]"
)
#: Fortran writes D for E, and leaves the letter out where the exponent has three digits: 1.5D+02, 1.5-120.
_LETTER = re.compile(r"[dDqQ](?<=[0-9.].)(?=[+-]?[0-9])")
_NO_LETTER = re.compile(r"[+-](?<=[0-9.].)(?=[0-9]{1,4}(?:\s|$))")
_MOST_DIGITS = 12  # Of a repeat count: its product with the size of a number stays a 64-bit integer.


@dataclass(frozen=True, slots=True)
class Numbers:
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


def numbers_in(text: str) -> Numbers:
    """Return all numbers of the file, with the shorthands of Fortran's output understood."""
    words = _NO_LETTER.sub(r"e\g<0>", _LETTER.sub("e", text.replace(",", " "))).split()
    if not words:
        raise GridgenError(f"it holds no numbers; {EXPECTED}")
    repeats = None
    if "*" in text:
        pairs = [_repeated(word) for word in words]
        repeats, words = np.array([count for count, _ in pairs], dtype=np.int64), [value for _, value in pairs]
    try:
        if "_" in text:  # NumPy takes 1_0 for ten.
            raise ValueError(f"{quoted(next(word for word in words if '_' in word))} is not a number")
        with np.errstate(all="ignore"):
            return Numbers(np.array(words, dtype=np.float64), repeats)
    except ValueError as error:
        raise GridgenError(f"{_line_of_fault(text)}{shortened(error)}; {EXPECTED}") from error


def _line_of_fault(text: str) -> str:
    """Return the line of the first word that is no number, for a message."""
    for number, line in enumerate(text.splitlines(), start=1):
        for word in line.replace(",", " ").split():
            try:
                number_in(_NO_LETTER.sub(r"e\g<0>", _LETTER.sub("e", word)).rpartition("*")[2])
            except ValueError:
                return f"line {number}: "
    return ""


def _repeated(word: str) -> tuple[int, str]:
    """Return how often a word stands for a number, and which: Fortran writes ``3*0.5`` for three equal ones."""
    count, star, value = word.partition("*")
    if not star:
        return 1, word
    if not count.isdigit() or len(count) > _MOST_DIGITS:
        raise GridgenError(
            f"the repeat count in {quoted(word)} is not a number of at most {_MOST_DIGITS} digits; {EXPECTED}"
        )
    return int(count), value
