"""The block of nodes that a kernel works on, as C and Python read it."""

from __future__ import annotations

import ctypes


class Block(ctypes.Structure):
    """A block of nodes and the rows of it to work on; `codegen.interface` says what the fields mean."""

    _fields_ = (
        *(
            (name, ctypes.c_int64)
            for name in ("ni", "nj", "row_begin", "row_end", "stride", "plane", "interior_only", "threads")
        ),
        *((name, ctypes.c_double) for name in ("h_xi", "h_eta")),
    )
