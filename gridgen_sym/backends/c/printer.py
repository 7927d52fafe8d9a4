"""Print kernels as C99."""

from __future__ import annotations

from collections.abc import Mapping

from ...codegen.kernel import Kernel
from ...codegen.printer import Printer
from ...codegen.render import render_kernel


class CPrinter(Printer):
    """Prints C99."""

    functions: Mapping[str, str] = {
        name: name
        for name in (
            *("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh"),
            *("asin", "acos", "atan", "atan2", "sign"),
        )
    } | {"Abs": "fabs"}

    def _general_power(self, base: str, exponent: str) -> str:
        return f"pow({base}, {exponent})"

    def _choice(self, test: str, first: str, second: str) -> str:
        return f"({test}) ? ({first}) : ({second})"


def render(kernel: Kernel) -> str:
    """Return the source of a kernel."""
    return render_kernel("c/kernel.c.jinja", kernel, CPrinter())
