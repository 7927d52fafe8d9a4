"""Choose the back end that runs the kernels: by the caller, the environment and the machine."""

from __future__ import annotations

import os

from ..codegen.backend import Backend, find_backend
from ..errors import GridgenError, quoted
from ..messages import report_once


def choose_backend(name: str | None = None) -> Backend:
    """Return the back end of this name; by default that of GRIDGEN_SYM_BACKEND, else compiled C, else NumPy.

    Raises:
        GridgenError: for an unknown name, or one that lacks something here, such as `c` without a compiler.
    """
    name = name or os.environ.get("GRIDGEN_SYM_BACKEND") or None
    if name is not None:
        chosen = find_backend(name)
        if lacking := chosen.missing():
            raise GridgenError(f"the backend {quoted(name)} needs {lacking}")
        return chosen
    compiled = find_backend("c")
    if not compiled.missing():
        return compiled
    report_once(
        "no C compiler was found, so the slower NumPy backend is used; install one (Debian: apt install gcc; "
        "macOS: xcode-select --install), or set GRIDGEN_SYM_BACKEND=numpy to silence this line"
    )
    return find_backend("numpy")
