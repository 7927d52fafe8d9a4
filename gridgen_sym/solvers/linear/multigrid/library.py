"""The compiled part of the multigrid: its C files, put together for a kind of stencil."""

from __future__ import annotations

import ctypes
import re
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from ....runtime import open_library

Stencil = Literal["symmetric", "general", "blocks", "blocks_in_double"]
#: What is added to the name of a library in double precision.
_IN_DOUBLE = "_in_double"
#: The C files of one translation unit, in their order.
_LEVELS, _KRYLOV = ("operators", "lines", "cycle"), ("v_cycle", "products", "fields", "vectors")
_BLOCKS = ("blocks", "crossing_lines", "block_levels", "block_gradients")
_PARTS = {
    "symmetric": ("level", "symmetric", *_LEVELS, *_KRYLOV, "conjugate_gradient_vectors", "conjugate_gradients"),
    "general": ("level", "general", *_LEVELS, *_KRYLOV, "bicgstab"),
    "blocks": ("level", "symmetric", *_LEVELS, "products", "fields", "conjugate_gradient_vectors", *_BLOCKS),
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
        *((name, ctypes.c_void_p) for name in ("kept_i", "kept_j")),
    )


def library_source(stencil: Stencil) -> str:
    """Return the C source for a kind of stencil, as one translation unit."""
    folder, parts = Path(__file__).parent, _PARTS[stencil.removesuffix(_IN_DOUBLE)]
    source = "\n".join((folder / f"{part}.c").read_text(encoding="utf-8") for part in parts)
    return re.sub(r"\bfloat\b", "double", source) if stencil.endswith(_IN_DOUBLE) else source


_POINTER, _INTEGER, _NUMBER = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
_COMMON: dict[str, tuple[list[Any], Any]] = {
    "take_planes": ([_POINTER, _POINTER, _NUMBER], None),
    "coarsen": ([_POINTER] * 3, None),
    "factor": ([_POINTER], _INTEGER),
}
_SOLVE = [_POINTER, _INTEGER, _POINTER, _POINTER, _POINTER, _NUMBER, _INTEGER, _NUMBER, _POINTER]
#: The functions that each library has beside them: the types of their arguments and of their result.
_OWN: dict[str, dict[str, tuple[list[Any], Any]]] = {
    "symmetric": {"solve": (_SOLVE, _INTEGER)},
    "general": {"solve": (_SOLVE, _INTEGER)},
    "blocks": {
        "find_rows": ([_POINTER], None),
        "take_blocks": ([_POINTER, _POINTER, _NUMBER], None),
        "coarsen_blocks": ([_POINTER, _POINTER, _POINTER, _INTEGER], None),
        "factor_blocks": ([_POINTER], _INTEGER),
        "coupling_sizes": ([_POINTER, _INTEGER, _POINTER], None),
        "cycle_down": ([_POINTER, _INTEGER], None),
        "cycle_up": ([_POINTER, _INTEGER], None),
        "begin_blocks": ([_POINTER] * 3, _NUMBER),
        "step_blocks": ([_POINTER, _POINTER, _NUMBER, _NUMBER], _NUMBER),
        "product_of_blocks": ([_POINTER] * 2, _NUMBER),
        "multiply_blocks": ([_POINTER, _POINTER, _NUMBER], _NUMBER),
        "give_blocks": ([_POINTER, _POINTER, _INTEGER, _NUMBER, _POINTER], None),
    },
}


@lru_cache(maxsize=4)
def load_library(stencil: Stencil) -> ctypes.CDLL:
    """Compile and load for symmetric stencils, with conjugate gradients, for general ones, with BiCGStab, or blocks."""
    library = open_library(f"multigrid_{stencil}", library_source(stencil))
    signatures = _COMMON | _OWN[stencil.removesuffix(_IN_DOUBLE)]
    for name, (arguments, result) in signatures.items():
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, result
    return library
