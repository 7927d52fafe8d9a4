"""The numbers of a PLOT3D text, read piece by piece, with the shorthands of Fortran's output understood."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from itertools import islice, repeat
from typing import Protocol

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
#: Bytes that are read at once, and those of a word that is surely no number.
_PIECE, _LONGEST_WORD = 1 << 20, 1 << 16
#: Lines of a text that may be its header, and characters of these.
_HEAD_LINES, _LONGEST_HEAD = 3, 1 << 22
_COMMAS = bytes.maketrans(b",", b" ")
_BLANK = b" \t\n\r\v\f"
_IS_BLANK = np.zeros(256, dtype=bool)
_IS_BLANK[list(_BLANK)] = True
#: Text of these alone is read by NumPy as a whole.
_PLAIN = b"0123456789+-.eE" + _BLANK


class Readable(Protocol):
    """What is read piece by piece."""

    def read(self, count: int = ..., /) -> bytes:
        """Return the next bytes, at most so many."""


class Numbers:
    """The numbers of a file, those that Fortran wrote once for several not yet written out.

    Attributes:
        head_text: the first lines of the text, which give the dimension, and perhaps more.
        count: how many numbers there are.
        repeated: whether some stand for several.
    """

    def __init__(self, stream: Readable, expected: str = EXPECTED, line: int | None = 0) -> None:
        """Read all numbers of a stream.

        Args:
            stream: the text.
            expected: what it should be, for messages.
            line: how many lines stand before it in its file; None where they cannot be counted.

        Raises:
            GridgenError: for bytes that are no text, words that are no numbers, and no numbers at all.
        """
        self._pieces: list[tuple[Array, NDArray[np.int64] | None]] = []
        self.head_text = ""
        offset, lines = 0, line
        for piece in _pieces(stream, expected):
            if self.head_text.count("\n") < _HEAD_LINES and len(self.head_text) < _LONGEST_HEAD:
                self.head_text += piece.decode("ascii", errors="replace").replace(",", " ")
            self._pieces.append(_parsed(piece, offset, lines, expected))
            offset += len(piece)
            lines = None if lines is None else lines + piece.count(b"\n")
        self.repeated = any(repeats is not None for _, repeats in self._pieces)
        words = sum(len(values) for values, _ in self._pieces)
        # Python's whole numbers do not overflow.
        self.count = sum(len(values) if repeats is None else sum(repeats.tolist()) for values, repeats in self._pieces)
        self._packed = 8 * words
        if not words:
            raise GridgenError(f"it holds no numbers; {expected}")

    def head(self, count: int) -> list[int]:
        """Return the first numbers as whole ones, 0 for any other, and for those that are not there."""
        written = (
            value
            for values, repeats in self._pieces
            for value, n in zip(values.tolist(), repeat(1) if repeats is None else repeats.tolist(), strict=False)
            for _ in range(n)
        )
        first = [int(value) if value.is_integer() else 0 for value in islice(written, count)]
        return first + [0] * (count - len(first))

    def check_size(self) -> None:
        """Refuse repeat counts that no grid has; call it before `take`, once `count` is known to fit the header."""
        if self.repeated:
            check_packing(self._packed, 8 * self.count, "what its repeat counts stand for")

    def first(self, count: int) -> Array:
        """Return the first numbers, which are kept."""
        pieces = list(self._pieces)
        taken = self.take(count)
        self._pieces = pieces
        return taken

    def take(self, count: int) -> Array:
        """Return the next numbers, which are not kept."""
        taken, filled = np.empty(count), 0
        if not self.repeated and count == sum(len(values) for values, _ in self._pieces):
            while self._pieces:  # The last first, so that the system gets back what is freed.
                values, _ = self._pieces.pop()
                taken[count - filled - len(values) : count - filled] = values
                filled += len(values)
        while filled < count:
            values, repeats = self._pieces.pop(0)
            if repeats is not None:
                values = np.repeat(values, repeats)
            here = min(count - filled, len(values))
            taken[filled : filled + here] = values[:here]
            filled += here
            if here < len(values):
                self._pieces.insert(0, (values[here:], None))
        return taken


def _pieces(stream: Readable, expected: str) -> Iterator[bytes]:
    """Yield the text in pieces that end between two words."""
    rest = b""
    while data := stream.read(_PIECE):
        data = rest + data
        cut = 1 + max(data.rfind(sign) for sign in (b" ", b"\n", b",", b"\t", b"\r"))
        rest = data[cut:]
        if len(rest) > _LONGEST_WORD:
            word = shortened(rest.decode("ascii", errors="replace"))
            raise GridgenError(f"could not convert to a number: {word}; {expected}")
        if cut:
            yield data[:cut]
    if rest:
        yield rest


def _parsed(piece: bytes, offset: int, lines: int | None, expected: str) -> tuple[Array, NDArray[np.int64] | None]:
    """Return the numbers of a piece of the text, and how often each stands there; None for once each.

    Args:
        piece: the text.
        offset: how many bytes come before it.
        lines: how many lines; None where they cannot be counted.
        expected: what the text should be, for messages.
    """
    plain = piece.translate(_COMMAS)
    if not plain.translate(None, _PLAIN):
        blank = _IS_BLANK[np.frombuffer(plain, dtype=np.uint8)]
        words = np.count_nonzero(blank[:-1] & ~blank[1:]) + (not blank[0])
        values = _read_at_once(plain) if words else np.empty(0)
        if len(values) == words:  # Fewer, or more where one word is read as two: 1.5-120.
            return values, None
    try:
        return _parsed_word_by_word(plain.decode("ascii"))
    except UnicodeDecodeError as error:
        where = offset + error.start
        raise GridgenError(f"byte {where} is not ASCII text, so the file may be binary; {expected}") from error
    except ValueError as error:
        if isinstance(error, GridgenError):
            raise
        raise GridgenError(f"{_line_of_fault(plain.decode('ascii'), lines)}{shortened(error)}; {expected}") from error


def _read_at_once(text: bytes) -> Array:
    """Return the numbers before the first word that is none, if not nothing at all."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Of NumPy before 2.3, which stops there.
        try:
            return np.fromstring(text, sep=" ")
        except ValueError:
            return np.empty(0)


def _parsed_word_by_word(text: str) -> tuple[Array, NDArray[np.int64] | None]:
    """Return the numbers of a text with Fortran's shorthands."""
    words = _NO_LETTER.sub(r"e\g<0>", _LETTER.sub("e", text)).split()
    repeats = None
    if "*" in text:
        pairs = [_repeated(word) for word in words]
        repeats, words = np.array([count for count, _ in pairs], dtype=np.int64), [value for _, value in pairs]
    if "_" in text:  # NumPy takes 1_0 for ten.
        raise ValueError(f"{quoted(next(word for word in words if '_' in word))} is not a number")
    with np.errstate(all="ignore"):
        return np.array(words, dtype=np.float64), repeats


def _line_of_fault(text: str, lines: int | None) -> str:
    """Return the line of the first word that is no number, for a message."""
    if lines is None:
        return ""
    for number, line in enumerate(text.split("\n"), start=1 + lines):
        for word in line.split():
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
            f"the repeat count in {quoted(word)} is not a number of at most {_MOST_DIGITS} digits, as in 3*0.5"
        )
    return int(count), value
