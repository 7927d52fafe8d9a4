"""What a density becomes where its symmetric fields are multiples of the unit matrix, as a scalar monitor is."""

from __future__ import annotations

from dataclasses import dataclass

import sympy
from sympy import Expr

from ...functionals.definition import Functional
from ...functionals.field_kinds import components
from ...functionals.metric import symbol
from ...functionals.registry import functional as find_functional
from ...functionals.registry import functionals
from ..derive.rational import RationalArithmetic


@dataclass(frozen=True, slots=True)
class Isotropy:
    """With M = c I for every symmetric field M, c > 0 drops out of the density, whatever it depends on.

    Attributes:
        fields: the names of those fields.
        density: what is left.
        known: a functional of which that is a multiple, and the factor; None where none is known.
    """

    fields: tuple[str, ...]
    density: Expr
    known: tuple[str, Expr] | None


def isotropy(functional: Functional) -> Isotropy | None:
    """Return what is left of a density where fields are isotropic; None where c does not drop out, or has no place."""
    fields = tuple(name for name, kind in functional.fields.items() if kind == "symmetric")
    if not fields:
        return None
    multiples = [sympy.Symbol(f"multiple_of_{name}", positive=True) for name in fields]
    values: dict[Expr, Expr] = {}
    for name, multiple in zip(fields, multiples, strict=True):
        values |= dict(zip(map(symbol, components(name, "symmetric")), (multiple, 0, multiple), strict=True))
    density = functional.expression().subs(values)
    arithmetic = RationalArithmetic([density])
    left = arithmetic.expression(arithmetic.element(density))
    if left.free_symbols & {*multiples}:
        return None
    return Isotropy(fields, left, _known(left, functional))


def _known(density: Expr, functional: Functional) -> tuple[str, Expr] | None:
    """Return a functional of which a density is a multiple, and the factor."""
    for name in functionals():
        other = find_functional(name)
        if name == functional.name or other.fields or other.parameters:
            continue
        expression = other.expression()
        arithmetic = RationalArithmetic([density, expression])
        ratio = arithmetic.expression(arithmetic.element(density) / arithmetic.element(expression))
        if ratio.is_Rational:
            return name, ratio
    return None
