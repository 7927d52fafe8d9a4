"""What a report says of declared fields: their kinds and ranges, how their derivatives are written, what drops out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import sympy
from sympy import Expr, Symbol

from ...functionals.definition import Functional
from ...functionals.expression import names_in
from ...functionals.field_kinds import components
from ..classify.isotropy import isotropy
from ..coordinates import METRIC
from ..derive.continuous import EulerLagrange

_KINDS: Mapping[str, str] = {
    "scalar": "a scalar",
    "vector": "a vector",
    "symmetric": "a symmetric positive definite matrix",
    "matrix": "a matrix",
}


def declarations(functional: Functional) -> Iterator[str]:
    """Yield a sentence for each field, and one on how derivatives are written."""
    for name, kind in functional.fields.items():
        own = components(name, kind)
        limits = [one for one in functional.constraints if names_in(one) & {*own}]
        parts = f", with the components {', '.join(own)}" if len(own) > 1 else ""
        yield f"{name} is {_KINDS[kind]}{parts}{'; ' if limits else ''}{' and '.join(limits)}."
    for first in functional.components[:1]:
        yield (
            f"A field that is held is a function of xi and eta, with the derivatives {first}_xi and {first}_eta; one "
            f"that is differentiated through is a function of x and y, with {first}_x and {first}_y."
        )


def matrix_name(functional: Functional) -> str:
    """Return the name of the matrix before a reduced system: M, or N where a field is M."""
    return "N" if "M" in functional.fields else "M"


def what_drops_out(functional: Functional) -> Iterator[str]:
    """Yield what is left of a density where its symmetric fields are multiples of the unit matrix."""
    found = isotropy(functional)
    if found is None:
        return
    names = " and ".join(found.fields)
    scalar = "With " + ", ".join(f"{name} = c I" for name in found.fields) + f", {names} drops out"
    if found.known is None:
        yield f"{scalar}, held or differentiated through: the density is then {found.density}."
        return
    known, factor = found.known
    times = "" if factor == 1 else f"{factor} times "
    yield f"{scalar}, held or differentiated through: the density is then {times}that of {known}."


def control_functions(derived: EulerLagrange) -> Iterator[str | tuple[str, Expr]]:
    """Yield the control functions of a reduced system that has them, and when they are simpler."""
    control = derived.reduction.control if derived.reduction else None
    if control is None:
        return
    yield "That is w = alpha (r_xixi + P r_xi) + beta r_xieta + gamma (r_etaeta + Q r_eta), with the control functions"
    yield ("P", control[0])
    yield ("Q", control[1])
    simple = simple_control(derived)
    if simple is not None:
        vanishing, values = simple
        where = " and ".join(f"{slope} = 0" for slope in vanishing)
        yield f"Where {where}, they are P = {values[0]} and Q = {values[1]}."


def simple_control(derived: EulerLagrange) -> tuple[list[Symbol], list[Expr]] | None:
    """Return which slopes must vanish for the control functions to be free of the metric, and what they are then.

    None where they are so anyway, or where too little would be left.
    """
    control = derived.reduction.control if derived.reduction else None
    terms = [term for part in control or () for term in sympy.Add.make_args(part)]
    plain, beyond = ([term for term in terms if bool(term.free_symbols & {*METRIC}) == metric] for metric in (0, 1))
    slopes = {*derived.values.derivatives}
    vanishing = sorted(set().union(*(term.free_symbols & slopes for term in beyond)), key=str)
    if control is None or not beyond or not plain or any(term.free_symbols & {*vanishing} for term in plain):
        return None
    return vanishing, [part.subs(dict.fromkeys(vanishing, 0)) for part in control]
