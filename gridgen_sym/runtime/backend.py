"""Which backend runs the kernels: what the caller, the environment and the machine say."""

from __future__ import annotations

import os

from ..errors import GridgenError
from ..messages import say_once
from .compiler import find_compiler
from .load import Backend, CompiledBackend, NumpyBackend

_BACKENDS: dict[str, Backend] = {"c": CompiledBackend(), "numpy": NumpyBackend()}


def choose_backend(name: str | None = None) -> Backend:
    """Return the backend of this name; by default that of GRIDGEN_SYM_BACKEND, else compiled C, else NumPy.

    Raises:
        GridgenError: for an unknown name, or `c` where there is no compiler.
    """
    name = name or os.environ.get("GRIDGEN_SYM_BACKEND") or None
    if name is not None and (not isinstance(name, str) or name not in _BACKENDS):
        raise GridgenError(f"unknown backend {name!r}: GRIDGEN_SYM_BACKEND and backend= take 'c' or 'numpy'")
    if name == "c" and find_compiler() is None:
        raise GridgenError("the backend 'c' needs a C compiler: install one (cc, gcc or clang), or set CC to its path")
    if name is None and find_compiler() is None:
        say_once(
            "no C compiler was found, so the slower NumPy backend is used; install one (Debian: apt install gcc; "
            "macOS: xcode-select --install), or set GRIDGEN_SYM_BACKEND=numpy to silence this line"
        )
        name = "numpy"
    return _BACKENDS[name or "c"]
