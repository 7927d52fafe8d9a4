"""Print programs as functions of numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from gridgen_sym.codegen.kernel import Kernel, Program
from gridgen_sym.codegen.printer import Printer


class PythonPrinter(Printer):
    """Prints Python with the functions of `math`."""

    functions: Mapping[str, str] = {
        name: f"math.{name}"
        for name in (
            *("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh"),
            *("asin", "acos", "atan", "atan2"),
        )
    } | {"Abs": "abs", "sign": "sign"}

    def _general_power(self, base: str, exponent: str) -> str:
        return f"({base})**({exponent})"

    def _choice(self, test: str, first: str, second: str) -> str:
        return f"(({first}) if {test} else ({second}))"


def render(kernel: Kernel) -> str:
    """Return a module with one function for each program; it returns its results by name."""
    head = f'"""{kernel.facts.name} in plain Python."""\n\nimport math\n\nsign = lambda a: (a > 0) - (a < 0)\n'
    return "\n\n".join([head, *("\n".join(_function(program)) for program in kernel.programs.values())]) + "\n"


def _function(program: Program) -> Iterator[str]:
    yield f"def {program.name}({', '.join(program.inputs)}, parameters):"
    for name, value in PythonPrinter().program(program):
        yield f"    {name} = {value}"
    yield f"    return dict({', '.join(f'{name}={name}' for name in program.outputs)})"
