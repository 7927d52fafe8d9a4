"""Kernels as data: a small language-free intermediate representation.

A `Program` is straight-line arithmetic on doubles: assignments of expressions to names. It can express
sums, products, whole and half powers, reciprocals, the functions of `FUNCTION_NAMES` and choices between
two values by a comparison of two others. It cannot express loops, arrays, integers, branches, calls of user code or
anything that depends on more than one point of the grid: loops and neighbors belong to the templates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy
from sympy import Expr

from ..errors import GridgenError
from ..functionals.choices import maximum, minimum
from ..functionals.metric import function_types, sympy_functions
from .facts import KernelFacts


class reciprocal(sympy.Function):  # type: ignore[misc] # noqa: N801 - a SymPy function is named in lower case
    """One division, 1/argument; what a negative power is lowered to."""

    nargs = 1


@dataclass(frozen=True, slots=True)
class Assignment:
    """One name and its value, an expression in names assigned before and in the inputs."""

    name: str
    value: Expr


@dataclass(frozen=True, slots=True)
class Program:
    """Straight-line arithmetic from inputs to outputs.

    Attributes:
        name: what it computes, for example `corner_slopes`.
        inputs: names of its arguments, in order.
        parameters: names of the functional's parameters, read from an array in this order.
        outputs: names of its results, in order; each is assigned exactly once.
        assignments: in the order of evaluation.
        operations: number of additions, multiplications, divisions and function calls.
    """

    name: str
    inputs: tuple[str, ...]
    parameters: tuple[str, ...]
    outputs: tuple[str, ...]
    assignments: tuple[Assignment, ...]
    operations: Mapping[str, int]

    def __post_init__(self) -> None:
        """Check that every name is assigned once, before its use, and every node can be printed."""
        known = {*self.inputs, *self.parameters}
        for assignment in self.assignments:
            check_expressible(assignment.value)
            unknown = {symbol.name for symbol in assignment.value.free_symbols} - known
            if unknown or assignment.name in known:
                raise AssertionError(f"{self.name}: {assignment} uses {unknown} or assigns twice")
            known.add(assignment.name)
        assert set(self.outputs) <= known, f"{self.name}: outputs {set(self.outputs) - known} are not assigned"


@dataclass(frozen=True, slots=True)
class Kernel:
    """Everything that a back end needs to print the kernels of one functional in one variant.

    Attributes:
        facts: what is known of it without its programs.
        programs: by name.
    """

    facts: KernelFacts
    programs: Mapping[str, Program]


def check_expressible(expression: Expr) -> None:
    """Refuse an expression that the intermediate representation cannot express.

    Raises:
        GridgenError: naming the part.
    """
    arithmetic = (sympy.Symbol, sympy.Rational, sympy.Add, sympy.Mul, sympy.Pow, reciprocal)
    functions = tuple(function for function in function_types() if function not in (maximum, minimum))
    for node in sympy.preorder_traversal(expression):
        expressible = isinstance(node, (*arithmetic, *functions)) or node in (sympy.pi, sympy.E)
        if not expressible:
            raise GridgenError(
                f"no kernel can be generated from {node} (a {type(node).__name__}): write the density with "
                f"+ - * / **, and {', '.join(sorted(sympy_functions()))}"
            )
