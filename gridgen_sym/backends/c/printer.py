"""Print kernels as C99."""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from ...codegen.kernel import Kernel
from ...codegen.printer import Printer
from ...codegen.render import render_kernel


class CPrinter(Printer):
    """Prints C99."""

    functions: Mapping[str, str] = {
        name: name for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan")
    } | {"Abs": "fabs", "sign": "sign"}

    def _general_power(self, base: str, exponent: str) -> str:
        return f"pow({base}, {exponent})"

    def _choice(self, node: sympy.Piecewise) -> str:
        (first, condition), (second, _) = node.args
        test = f"{self.expression(condition.lhs)} {condition.rel_op} {self.expression(condition.rhs)}"
        return f"({test}) ? ({self.expression(first)}) : ({self.expression(second)})"


def render(kernel: Kernel) -> str:
    """Return the source of a kernel."""
    return render_kernel("c/kernel.c.jinja", kernel, CPrinter())
