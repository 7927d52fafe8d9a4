"""The compiled part of the multigrid: its C files, put together for a kind of stencil."""

from __future__ import annotations

import ctypes
from functools import lru_cache
from pathlib import Path
from typing import Literal

from ....runtime import open_library

Stencil = Literal["symmetric", "general"]
#: The C files of one translation unit, in their order.
_PARTS = {
    "symmetric": ("level", "symmetric", "operators", "lines", "cycle", "vectors", "conjugate_gradients"),
    "general": ("level", "general", "operators", "lines", "cycle", "vectors", "bicgstab"),
}


class Level(ctypes.Structure):
    """One level, as `level.c` declares it."""

    _fields_ = (
        *((name, ctypes.c_int64) for name in ("ni", "nj", "stride", "threads")),
        *(
            (name, ctypes.c_void_p)
            for name in ("operator", "pivots_i", "pivots_j", "right", "solution", "work", "fixed")
        ),
        *((name, ctypes.c_int64) for name in ("begin_i", "end_i", "begin_j", "end_j")),
    )


def library_source(stencil: Stencil) -> str:
    """Return the C source for a kind of stencil, as one translation unit."""
    folder = Path(__file__).parent
    return "\n".join((folder / f"{part}.c").read_text(encoding="utf-8") for part in _PARTS[stencil])


@lru_cache(maxsize=2)
def load_library(stencil: Stencil) -> ctypes.CDLL:
    """Compile and load for symmetric stencils, with conjugate gradients, or for general ones, with BiCGStab."""
    library = open_library(f"multigrid_{stencil}", library_source(stencil))
    pointer, integer, number = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
    signatures = {
        "take_planes": ([pointer, pointer, number], None),
        "coarsen": ([pointer] * 3, None),
        "factor": ([pointer], integer),
        "solve": ([pointer, integer, pointer, pointer, pointer, number, integer, number, pointer], integer),
    }
    for name, (arguments, result) in signatures.items():
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, result
    return library
