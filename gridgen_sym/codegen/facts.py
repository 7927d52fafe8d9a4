"""What is known of a kernel: data beside its source, read without SymPy and without running it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from ..functionals.definition import Functional
from ..functionals.variant import Variant
from ..functionals.variant import kernel_name as kernel_name


@dataclass(frozen=True, slots=True)
class KernelFacts:
    """What templates, back ends and solvers must know of the kernels of one functional in one variant.

    Attributes:
        name: of the kernel, for example `winslow` or `area_frozen`: its files, and the prefix of its functions.
        functional: name of the functional.
        variant: how the weight, fields and a target enter, or `regularized`; see `functionals.variant`.
        density: the formula, as text.
        digest: of the definition that everything was derived from.
        parameters: names of the parameters, in the order of the array that a kernel reads.
        planes: names of the planes of values (of the weight, of fields), in order.
        sloped: those whose slopes along xi and eta enter the Euler-Lagrange equations.
        moving: whether values move with the nodes.
        barrier: whether the energy is infinite where J = 0.
        equation_type: type of the Euler-Lagrange equations where J > 0: `elliptic`, or what they are instead.
        null_lagrangian: whether the energy is the same for every grid with the same boundary.
        polyconvex: whether the semidefinite Hessian is so by derivation; else its eigenvalues are clamped.
        degree: of the density's homogeneity in the edge vectors; None where it has none.
        functions: names of the functions that the kernel has, of those in `interface.FUNCTIONS`.
        operations: number of operations of each program, by kind (additions, multiplications, divisions, functions).
    """

    name: str
    functional: str
    variant: Variant
    density: str
    digest: str
    parameters: tuple[str, ...]
    planes: tuple[str, ...]
    sloped: tuple[str, ...]
    moving: bool
    barrier: bool
    equation_type: str
    null_lagrangian: bool
    polyconvex: bool
    degree: float | None
    functions: tuple[str, ...]
    operations: Mapping[str, Mapping[str, int]]

    def to_json(self) -> str:
        """Return the facts as text; the same facts give the same bytes."""
        # One attribute a line, so that a difference is seen.
        lines = (f"{json.dumps(key)}: {json.dumps(value)}" for key, value in asdict(self).items())
        return "{\n  " + ",\n  ".join(lines) + "\n}\n"

    @classmethod
    def from_json(cls, text: str) -> KernelFacts:
        """Return the facts that `to_json` wrote."""
        data = json.loads(text)
        for key in ("parameters", "planes", "sloped", "functions"):
            data[key] = tuple(data[key])
        return cls(**data)


def definition_digest(functional: Functional) -> str:
    """Return 16 hexadecimal digits that change with the definition. This loads SymPy."""
    import sympy

    definition: tuple[object, ...] = sympy.srepr(functional.expression()), functional.corner_factor
    definition = (*definition, tuple(functional.parameters), *tuple(functional.fields.items()))
    return hashlib.sha256(repr(definition).encode()).hexdigest()[:16]
