"""The values of a description: tables with known keys, numbers and pairs of numbers."""

from __future__ import annotations

import difflib
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import GridgenError, quoted


def table(given: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return a table of a description; empty where there is none.

    Raises:
        GridgenError: if it is none.
    """
    found = given.get(name, {})
    if not isinstance(found, dict):
        raise GridgenError(f"{name} must be a table; came {quoted(found)}")
    return found


def check_keys(given: object, known: Sequence[str], what: str, required: Sequence[str] = ()) -> None:
    """Refuse what is no table, has an unknown key, or lacks one.

    Raises:
        GridgenError: with the known keys, and the closest of them.
    """
    if not isinstance(given, dict):
        raise GridgenError(f"{what} must be a table with {', '.join(known)}; came {quoted(given)}")
    for key in given:
        if key not in known:
            close = difflib.get_close_matches(key, known, n=1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise GridgenError(f"unknown key {quoted(key)} in {what}; known: {', '.join(known)}.{hint}")
    for key in required:
        if key not in given:
            raise GridgenError(f"{what} has no {key}; expected at least {' and '.join(required)}")


def real(value: object, what: str) -> float:
    """Return a finite number.

    Raises:
        GridgenError: if it is none.
    """
    if not isinstance(value, int | float) or isinstance(value, bool) or not abs(value) <= sys.float_info.max:
        raise GridgenError(f"{what} must be a finite number; came {quoted(value)}")
    return float(value)


def pair(value: object, what: str) -> tuple[float, float]:
    """Return two finite numbers.

    Raises:
        GridgenError: if they are none.
    """
    if not isinstance(value, list) or len(value) != 2:
        raise GridgenError(f"{what} must be two numbers [x, y]; came {quoted(value)}")
    return real(value[0], f"x of {what}"), real(value[1], f"y of {what}")
