"""Turn generated sources into callable functions: a compiled library through ctypes, or a NumPy module."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
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


#: Functions that are compiled together, by the name of the part in C and for the user. Optimising the whole file takes
#: the compiler several seconds, and a solver needs two or three parts of it.
PARTS = {
    ("ENERGY", "energy and gradient"): ("energy", "energy_gradient"),
    ("HESSIAN", "Hessian"): ("hessian",),
    ("SEMIDEFINITE", "semidefinite Hessian"): ("semidefinite_hessian",),
    ("PRODUCTS", "Hessian times a vector"): ("hessian_vector", "semidefinite_hessian_vector"),
    ("SWEEP", "sweep over nodes"): ("sweep",),
    ("EQUATIONS", "Euler–Lagrange equations"): (
        "euler_lagrange_residual",
        "euler_lagrange_jacobian",
        "euler_lagrange_frozen_jacobian",
        "euler_lagrange_relaxation",
    ),
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
        """Compile (or find in the cache) and load the energy, which shows a bad compiler; other parts when called."""
        source = c_source()
        functions: dict[str, Callable[..., None]] = {}
        for (macro, part), names in PARTS.items():
            text = f"#define ONLY_A_PART\n#define ONLY_{macro}\n{source}"
            library = cache(lambda text=text, part=part: open_library(kernel, text, part))
            if macro == "ENERGY":
                library()
            available = [name for name in names if f"{kernel}_{name}" in module]
            functions |= {name: _Function(library, f"{kernel}_{name}", SIGNATURES[name]) for name in available}
        return functions


class NumpyBackend:
    """Functions of the NumPy module, as they are."""

    name = "numpy"

    def load(self, kernel: str, c_source: Callable[[], str], module: dict[str, Any]) -> dict[str, Callable[..., None]]:
        """Pick the functions out of the module."""
        return {name: module[f"{kernel}_{name}"] for name in SIGNATURES if f"{kernel}_{name}" in module}


@dataclass(slots=True)
class _Function:
    """A function of a library that is loaded at the first call.

    Arrays go as plain pointers, which is ten times faster than ndpointer.

    Attributes:
        library: loads it.
        name: of the function there.
        kinds: of its arguments, as in `SIGNATURES`.
    """

    library: Callable[[], ctypes.CDLL]
    name: str
    kinds: str
    _loaded: Any = None

    def __call__(self, block: Block, *arguments: Any) -> None:  # noqa: ANN401
        if self._loaded is None:
            self._load()
        self._loaded(
            ctypes.byref(block),
            *(value.ctypes.data if isinstance(value, np.ndarray) else value for value in arguments),
        )

    def _load(self) -> None:
        types = {"a": ctypes.c_void_p, "i": ctypes.c_int64, "d": ctypes.c_double}
        function = getattr(self.library(), self.name)
        function.argtypes = [ctypes.POINTER(Block), *(types[kind] for kind in self.kinds)]
        function.restype = None
        self._loaded = function


def load_module(path: Path | str, text: str) -> dict[str, Any]:
    """Return the names of a generated NumPy module; it is run from its text, so nothing is written beside it."""
    names: dict[str, Any] = {"__name__": "gridgen_sym.generated", "__file__": str(path)}
    exec(compile(text, str(path), "exec"), names)
    return names
