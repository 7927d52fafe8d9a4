"""The Euler-Lagrange equations in a report as LaTeX: of the plain functional, and of what moves with the nodes."""

from __future__ import annotations

from collections.abc import Iterator

from ...functionals.definition import Functional
from ...functionals.variant import Modes, Variant
from ..classify.equidistribution import equidistribution
from ..coordinates import s
from ..derive.continuous import EulerLagrange, euler_lagrange
from . import prose
from .displays import group, one
from .equations import Equations
from .fields import matrix_name, simple_control
from .printer import latex, symbol_name
from .sections import moving_variants
from .tidy import tidy


def weightless(functional: Functional, text: str) -> str:
    """Return the beginning of a sentence on the functional without its weight."""
    return f"With $s = 1$, {text}" if functional.expression().has(s) else text[0].upper() + text[1:]


def stationary(functional: Functional, variant: Variant, equations: Equations) -> Iterator[str]:
    """Yield the Euler-Lagrange equations of a variant."""
    derived, plain = equations.equation(euler_lagrange(functional, variant)), variant == "plain"
    tail = _tail(variant)
    yield "\\subsection{Euler--Lagrange equations}" if plain else f"\\subsection{{{prose.variant_title(variant)}}}"
    yield prose.joined(prose.held(functional, variant))
    head = "a stationary map satisfies, in divergence form,"
    forms = [equations.divergence(derived, row, f"divergence-{r}{tail}") for row, r in enumerate("xy")]
    head = weightless(functional, head) if plain else head.capitalize()
    yield f"{head}\n{group(forms, equations.label(f'divergence{tail}'))}"
    forms = [equations.expanded(derived, row, f"expanded-{r}{tail}") for row, r in enumerate("xy")]
    yield f"Expanded, these equations are\n{group(forms, equations.label(f'expanded{tail}'))}"
    yield _reduced(derived, tail, equations)


def _tail(variant: Variant) -> str:
    """Return the end of the labels of a variant: what is held, or that all moves."""
    if variant == "plain":
        return ""
    return "-frozen" if Modes.read(variant).weight == "frozen" else "-differentiated"


def _reduced(derived: EulerLagrange, tail: str, equations: Equations) -> str:
    """Return the simpler system that the equations are equivalent to; nothing where none was found."""
    if derived.reduction is None:
        return ""
    reduction, name = derived.reduction, matrix_name(derived.functional)
    operator = reduction.operator
    matrix = equations.matrix(f"matrix{tail}", name, operator.matrix.applyfunc(tidy), ",", entry=name.lower())
    determinant = one(equations.named(f"determinant{tail}", rf"\det {name}", operator.determinant), ",")
    system = [
        equations.named(f"reduced-{r}{tail}", f"w_{r}", part) for r, part in zip("xy", reduction.system, strict=True)
    ]
    reference = equations.reference(f"expanded{tail}")
    return (
        f"The left sides of {reference} are the components of ${name} \\, (w_x, w_y)^T$, where the matrix\n{matrix}\n"
        f"has the determinant\n{determinant}\nand\n{group(system, equations.label(f'reduced{tail}'))}\n"
        f"Wherever $\\det {name}$ is not zero, the equations {reference} hold if and only if $w_x = w_y = 0$ (proved)."
        f"{_control(derived, tail, equations)}"
    )


def _control(derived: EulerLagrange, tail: str, equations: Equations) -> str:
    """Return the control functions of a reduced system; nothing where it has none."""
    control = derived.reduction.control if derived.reduction else None
    if control is None:
        return ""
    functions = [equations.named(f"control-{n}{tail}", n, part) for n, part in zip("PQ", control, strict=True)]
    shown = group(functions, equations.label(f"control{tail}"))
    text = (
        " The terms of first order are $\\alpha P r_\\xi + \\gamma Q r_\\eta$, where $\\alpha$ and $\\gamma$ multiply"
    )
    text += f" $r_{{\\xi\\xi}}$ and $r_{{\\eta\\eta}}$ for $r = x, y$, with the control functions\n{shown}"
    simple = simple_control(derived)
    if simple is None:
        return text
    where = " = ".join([*map(symbol_name, simple[0]), "0"])
    values = " and ".join(f"${n} = {latex(part)}$" for n, part in zip("PQ", simple[1], strict=True))
    return f"{text}\nWhere ${where}$, they are {values}."


def stationary_variants(functional: Functional, equations: Equations) -> Iterator[str]:
    """Yield the equations with a weight, or with fields that move, and the law that their solutions follow."""
    for variant in moving_variants(functional):
        yield from stationary(functional, variant, equations)
        law = equidistribution(functional, variant)
        if law is not None:
            c = one(equations.named(f"law{_tail(variant)}", "c", law.law), "")
            q = one(equations.named(f"multiplier{_tail(variant)}", "q", law.multiplier))
            reference = equations.reference(f"expanded{_tail(variant)}")
            yield (
                f"Multiplied by $A^T / J$, where $A$ is the Jacobian matrix of the map, the left sides of {reference} "
                f"are the components of $q \\, (c_\\xi, c_\\eta)^T$ with\n{c}\nand\n{q}\nStationary maps keep $c$ "
                "constant (proved)."
            )
