"""Print kernels as NumPy."""

from __future__ import annotations

from collections.abc import Mapping

from ...codegen.kernel import Kernel
from ...codegen.printer import Printer
from ...codegen.render import render_kernel


class NumpyPrinter(Printer):
    """Prints NumPy on arrays."""

    functions: Mapping[str, str] = {
        name: f"np.{name}" for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh")
    } | {
        **{"Abs": "np.abs", "sign": "np.sign"},
        **{"asin": "np.arcsin", "acos": "np.arccos", "atan": "np.arctan", "atan2": "np.arctan2"},
    }

    def _general_power(self, base: str, exponent: str) -> str:
        return f"({base})**({exponent})"

    def _choice(self, test: str, first: str, second: str) -> str:
        return f"np.where({test}, {first}, {second})"


def render(kernel: Kernel) -> str:
    """Return the source of a kernel."""
    return render_kernel("numpy/kernel.py.jinja", kernel, NumpyPrinter())
