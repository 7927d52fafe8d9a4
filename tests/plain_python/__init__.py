"""A back end from outside of the package: loops in plain Python, which no solver needs and anybody can read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from gridgen_sym import Backend
from gridgen_sym.codegen.backend import Function
from gridgen_sym.codegen.facts import KernelFacts

if TYPE_CHECKING:
    from gridgen_sym.codegen.kernel import Kernel


class PlainPython:
    """Prints functions of numbers, and calls them corner by corner."""

    name = "plain"
    suffix = ".py"

    def missing(self) -> str:
        """Return nothing: it needs Python only."""
        return ""

    def render(self, kernel: Kernel) -> str:
        """Return the arithmetic of a kernel."""
        from .printer import render

        return render(kernel)

    def load(self, facts: KernelFacts, source: str) -> Mapping[str, Function]:
        """Return the loops, bound to that arithmetic."""
        from .loops import bind

        return bind(facts, source)


BACKEND: Backend = PlainPython()
