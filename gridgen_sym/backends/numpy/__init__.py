"""Kernels in NumPy, for machines without a C compiler. Its templates are in `templates/numpy`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...codegen.backend import Backend, Function
from ...codegen.facts import KernelFacts

if TYPE_CHECKING:
    from ...codegen.kernel import Kernel


class NumpyBackend:
    """Prints NumPy and runs it."""

    name = "numpy"
    suffix = ".py"

    def missing(self) -> str:
        """Return nothing: NumPy is always there."""
        return ""

    def render(self, kernel: Kernel) -> str:
        """Return the source of a kernel: the arithmetic on which the loops of `loops.py` work."""
        from .printer import render

        return render(kernel)

    def load(self, facts: KernelFacts, source: str) -> Mapping[str, Function]:
        """Run the source, and bind the loops to it."""
        from .loader import load

        return load(facts, source)


BACKEND: Backend = NumpyBackend()
