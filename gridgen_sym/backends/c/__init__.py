"""Kernels in C99, compiled when first used. Its templates are in `templates/c`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...codegen.backend import Backend, Function
from ...codegen.facts import KernelFacts

if TYPE_CHECKING:
    from ...codegen.kernel import Kernel


class CBackend:
    """Prints C and calls it through ctypes."""

    name = "c"
    suffix = ".c"

    def missing(self) -> str:
        """Return what to do where there is no compiler."""
        from ...runtime.toolchain import find_compiler

        return "" if find_compiler() else "a C compiler: install one (cc, gcc or clang), or set CC to its path"

    def render(self, kernel: Kernel) -> str:
        """Return the source of a kernel; it includes `common.h` and `loops.h`."""
        from .printer import render

        return render(kernel)

    def load(self, facts: KernelFacts, source: str) -> Mapping[str, Function]:
        """Compile (or find in the cache) the energy, which shows a bad compiler; other parts when they are called."""
        from .loader import load

        return load(facts, source)


BACKEND: Backend = CBackend()
