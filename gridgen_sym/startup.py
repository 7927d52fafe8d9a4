"""Ctrl-C while the command line loads: it ends with exit code 130, without a traceback of imports.

This is loaded before anything heavy, and does something only in the program `gridgen-sym` (or `python -m gridgen_sym`):
a library leaves signals alone.
"""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType

_PROGRAM = "gridgen-sym"


def _is_program() -> bool:
    """Return whether this process is the command line: by its name, or as `python -m gridgen_sym`."""
    program = sys.argv[0] if getattr(sys, "argv", None) else ""
    if program == "-m":  # As long as the package is being loaded, before its __main__.
        return sys.orig_argv[sys.orig_argv.index("-m") + 1 :][:1] == [__package__]
    return os.path.basename(program).partition(".")[0] == _PROGRAM


def _leave(number: int, frame: FrameType | None) -> None:
    """End the process at once: an exception could be swallowed by whatever is being imported."""
    os.write(2, b"\ninterrupted\n")
    os._exit(130)


def loaded() -> None:
    """Let Ctrl-C be an exception from now on, which a running command answers."""
    if signal.getsignal(signal.SIGINT) is _leave:
        signal.signal(signal.SIGINT, signal.default_int_handler)


if _is_program() and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, _leave)
