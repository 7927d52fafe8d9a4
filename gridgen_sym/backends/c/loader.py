"""Turn generated C into callable functions: compiled part by part, called through ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...codegen.backend import Function
from ...codegen.facts import KernelFacts
from ...codegen.interface import FUNCTIONS
from ...resources import resource_folder
from ...runtime.block import Block
from ...runtime.compiler import open_library
from ...runtime.values import Values

#: Functions that are compiled together, by the name of the part in C and for the user. Optimizing the whole file takes
#: the compiler several seconds, and a solver needs two or three parts of it.
PARTS = {
    ("ENERGY", "energy and gradient"): ("energy", "energy_gradient"),
    ("HESSIAN", "Hessian"): ("hessian",),
    ("SEMIDEFINITE", "semidefinite Hessian"): ("semidefinite_hessian",),
    ("PRODUCTS", "Hessian times a vector"): ("hessian_vector", "semidefinite_hessian_vector"),
    ("MIXED", "mixed derivatives"): ("mixed",),
    ("SWEEP", "sweep over nodes"): ("sweep",),
    ("EQUATIONS", "Euler–Lagrange equations"): (
        "euler_lagrange_residual",
        "euler_lagrange_jacobian",
        "euler_lagrange_frozen_jacobian",
        "euler_lagrange_relaxation",
    ),
}
_TYPES = {"a": ctypes.c_void_p, "i": ctypes.c_int64, "d": ctypes.c_double}


def load(facts: KernelFacts, source: str) -> Mapping[str, Function]:
    """Compile (or find in the cache) and load the energy, which shows a bad compiler; other parts when called."""
    functions: dict[str, Function] = {}
    for (part, described), names in PARTS.items():
        text = part_of(source, part)
        library = cache(
            lambda text=text, described=described: open_library(facts.name, text, described, headers(), marked=True)
        )
        available = [name for name in names if name in facts.functions]
        if part == "ENERGY" and available:
            library()
        functions |= {name: _Function(library, f"{facts.name}_{name}", FUNCTIONS[name].arguments) for name in available}
    return functions


def part_of(source: str, part: str) -> str:
    """Return the source of one part of a kernel file, by its name in `PARTS`."""
    return f"#define PARTS PART_{part}\n{source}"


@lru_cache(maxsize=1)
def headers() -> Mapping[str, str]:
    """Return what kernel files include, by name."""
    folder = resource_folder("generated") / "c"
    return {path.name: path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.h"))}


@dataclass(slots=True)
class _Function:
    """A function of a library that is loaded at the first call.

    Arrays go as plain pointers, which is ten times faster than ndpointer.

    Attributes:
        library: loads it.
        name: of the function there.
        kinds: of its arguments after the block, as in `interface.FUNCTIONS`.
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
            *map(_argument, arguments),
        )

    def on_blocks(self, blocks: Any, threads: int, *arrays: Any) -> None:  # noqa: ANN401
        """Run on many blocks, as `runtime.BlockKernels` calls it.

        Args:
            blocks: an array of `Block`.
            threads: that share the blocks.
            arrays: addresses of the coordinates and of the values of each block (blocks,), the parameters of all, and
                addresses of what each block writes (blocks, arrays).
        """
        if self._loaded is None:
            self._load()
        kernel, size = ctypes.cast(self._loaded, ctypes.c_void_p), ctypes.sizeof(Block)
        addresses = map(_argument, arrays)
        _each_block().run_on_blocks(kernel, arrays[-1].shape[1], len(blocks), threads, blocks, size, *addresses)

    def _load(self) -> None:
        function = getattr(self.library(), self.name)
        function.argtypes = [ctypes.POINTER(Block), *(_TYPES[kind] for kind in self.kinds)]
        function.restype = None
        self._loaded = function


@lru_cache(maxsize=1)
def _each_block() -> ctypes.CDLL:
    library = open_library("each_block", Path(__file__).with_name("each_block.c").read_text(encoding="utf-8"))
    integer, pointer = ctypes.c_int64, ctypes.c_void_p
    library.run_on_blocks.argtypes = [pointer, integer, integer, integer, pointer, integer, *[pointer] * 4]
    library.run_on_blocks.restype = None
    return library


def _argument(value: Any) -> Any:  # noqa: ANN401
    """Return an argument as C takes it: the address of an array's first number, or of the first address of values."""
    array = value.pointers if isinstance(value, Values) else value
    # Three times as fast as `array.ctypes.data`, which counts where grids are small.
    return array.__array_interface__["data"][0] if isinstance(array, np.ndarray) else array
