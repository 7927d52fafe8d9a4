"""Print kernels as NumPy."""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from ...codegen.kernel import Kernel
from ...codegen.printer import Printer
from ...codegen.render import render_kernel


class NumpyPrinter(Printer):
    """Prints NumPy on arrays."""

    functions: Mapping[str, str] = {
        name: f"np.{name}" for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh")
    } | {"Abs": "np.abs", "sign": "np.sign", "atan": "np.arctan"}

    def _general_power(self, base: str, exponent: str) -> str:
        return f"({base})**({exponent})"

    def _choice(self, node: sympy.Piecewise) -> str:
        (first, condition), (second, _) = node.args
        test = f"{self.expression(condition.lhs)} {condition.rel_op} {self.expression(condition.rhs)}"
        return f"np.where({test}, {self.expression(first)}, {self.expression(second)})"


def render(kernel: Kernel) -> str:
    """Return the source of a kernel."""
    return render_kernel("numpy/kernel.py.jinja", kernel, NumpyPrinter())
