"""Turn generated sources into callable functions: a compiled library through ctypes, or a NumPy module."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from .compiler import open_library

#: Functions of every kernel file, without the prefix, with the kinds of their arguments: (a)rray, (i)nteger, (d)ouble.
SIGNATURES = {
    "energy": "aaaaa",
    "energy_gradient": "aaaaaa",
    "hessian": "aaaa",
    "semidefinite_hessian": "aaaa",
    "hessian_vector": "aaaaa",
    "semidefinite_hessian_vector": "aaaaa",
    "sweep": "aaaaidda",
    "euler_lagrange_residual": "aaaa",
    "euler_lagrange_jacobian": "aaaa",
    "euler_lagrange_frozen_jacobian": "aaaa",
    "euler_lagrange_relaxation": "aaaaid",
}


class Block(ctypes.Structure):
    """A block of nodes and the rows of it to work on; the same fields in C and in NumPy."""

    _fields_ = (
        *(
            (name, ctypes.c_int64)
            for name in ("ni", "nj", "row_begin", "row_end", "stride", "plane", "interior_only", "threads")
        ),
        *((name, ctypes.c_double) for name in ("h_xi", "h_eta")),
    )


class Backend(Protocol):
    """Makes callable functions from the two sources of a kernel file."""

    name: str

    def load(self, kernel: str, c_source: Callable[[], str], module: dict[str, Any]) -> dict[str, Callable[..., None]]:
        """Return the functions by name without prefix; each takes a `Block` and then what `SIGNATURES` says."""
        ...


class CompiledBackend:
    """Functions compiled from C, called through ctypes."""

    name = "c"

    def load(self, kernel: str, c_source: Callable[[], str], module: dict[str, Any]) -> dict[str, Callable[..., None]]:
        """Compile (or find in the cache) and load."""
        library = open_library(kernel, c_source())
        available = {name for name in SIGNATURES if f"{kernel}_{name}" in module}
        return {name: _wrapped(getattr(library, f"{kernel}_{name}"), SIGNATURES[name]) for name in available}


class NumpyBackend:
    """Functions of the NumPy module, as they are."""

    name = "numpy"

    def load(self, kernel: str, c_source: Callable[[], str], module: dict[str, Any]) -> dict[str, Callable[..., None]]:
        """Pick the functions out of the module."""
        return {name: module[f"{kernel}_{name}"] for name in SIGNATURES if f"{kernel}_{name}" in module}


def _wrapped(function: Any, kinds: str) -> Callable[..., None]:  # noqa: ANN401 - a ctypes function
    """Return a Python function that passes arrays as plain pointers, ten times faster than ndpointer does."""
    types = {"a": ctypes.c_void_p, "i": ctypes.c_int64, "d": ctypes.c_double}
    function.argtypes = [ctypes.POINTER(Block), *(types[kind] for kind in kinds)]
    function.restype = None

    def call(block: Block, *arguments: Any) -> None:  # noqa: ANN401
        function(
            ctypes.byref(block),
            *(value.ctypes.data if isinstance(value, np.ndarray) else value for value in arguments),
        )

    return call


def load_module(path: Path | str, text: str) -> dict[str, Any]:
    """Return the names of a generated NumPy module; it is run from its text, so nothing is written beside it."""
    names: dict[str, Any] = {"__name__": "gridgen_sym.generated", "__file__": str(path)}
    exec(compile(text, str(path), "exec"), names)
    return names
