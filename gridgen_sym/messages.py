"""Report to the user what is going on, on standard error, without getting in the way of programs."""

from __future__ import annotations

import os
import sys

_reported: set[str] = set()


def report(message: str) -> None:
    """Print one line to standard error, unless GRIDGEN_SYM_QUIET is set."""
    if not os.environ.get("GRIDGEN_SYM_QUIET"):
        print(f"gridgen_sym: {message}", file=sys.stderr, flush=True)


def report_once(message: str) -> None:
    """Print a line at most once per process."""
    if message not in _reported:
        _reported.add(message)
        report(message)
