"""Numbers in text, as files and command lines have them: written as everyone writes them, and read alike everywhere."""

from __future__ import annotations

import re

_WHOLE = re.compile(r"[+-]?[0-9]{1,18}")
_NUMBER = re.compile(r"[+-]?(([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?|inf(inity)?|nan)", re.IGNORECASE | re.ASCII)


def number_in(text: str) -> float:
    """Return the number that a text is, apart from blanks around it.

    Python's `float` also takes digits of other scripts, and `1_0` for ten.

    Raises:
        ValueError: if it is none.
    """
    if not _NUMBER.fullmatch(text.strip()):
        raise ValueError("it is not a number")
    return float(text)


def whole_number_in(text: str) -> int:
    """Return the whole number, of at most 18 digits, that a text is, apart from blanks around it.

    Raises:
        ValueError: if it is none.
    """
    if not _WHOLE.fullmatch(text.strip()):
        raise ValueError("it is not a whole number")
    return int(text)
