"""What a report on a functional contains: sections of named expressions and sentences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import sympy
from sympy import Expr

from ...functionals.definition import Functional
from ...functionals.variant import Modes
from ..classify.bounds import LowerBound
from ..classify.classification import Classification, classify
from ..classify.equidistribution import equidistribution
from ..classify.principal_symbol import k1, k2
from ..coordinates import FIRST_DERIVATIVES, Variant, s
from ..derive.continuous import EulerLagrange, euler_lagrange
from ..derive.discrete import CornerModel, corner_model
from .fields import control_functions, declarations, matrix_name, what_drops_out
from .tidy import common_factor, paper_order, tidy, tidy_quadratic, without_common_terms


@dataclass(frozen=True, slots=True)
class Divergence:
    """An equation d/dxi(along_xi) + d/deta(along_eta) - source = 0."""

    along_xi: Expr
    along_eta: Expr
    source: Expr


@dataclass(frozen=True, slots=True)
class Quasilinear:
    """An equation: factor times (the sum of coefficient times second derivative), plus a rest, = 0."""

    factor: Expr
    terms: tuple[tuple[Expr, Expr], ...]
    rest: Expr


Item = str | tuple[str, "Expr | sympy.Matrix"] | Divergence | Quasilinear


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part of a report.

    Attributes:
        title: its title; sections that follow each other may share it.
        subtitle: what distinguishes them.
        items: sentences, named expressions and equations.
        detail: whether it is for reference: what a page shows when asked only.
    """

    title: str
    items: tuple[Item, ...]
    subtitle: str = ""
    detail: bool = False

    @property
    def heading(self) -> str:
        """The title and the subtitle."""
        return f"{self.title}, {self.subtitle}" if self.subtitle else self.title


def sections(functional: Functional) -> Iterator[Section]:
    """Yield the sections of the report on a functional."""
    yield Section("Density", (("F", functional.expression()), *declarations(functional)))
    yield from _corner(corner_model(functional, "plain"))
    held = "fields held" if functional.fields else "with s = 1"
    yield from _equations(euler_lagrange(functional, "plain"), f"Euler-Lagrange equations, {held}")
    found = classify(functional)
    judged = (*_classification(found), *what_drops_out(functional))
    yield Section(f"Classification, where J > 0{_at_defaults(functional)}", judged)
    for variant in moving_variants(functional):
        modes = Modes.read(variant)
        held = ", ".join(
            [
                *([f"weight {modes.weight}"] if modes.weight else []),
                *(f"{name} differentiated" for name in modes.differentiated),
            ]
        )
        derived = euler_lagrange(functional, variant)
        yield from _equations(derived, f"Euler-Lagrange equations, {held}", detail=True)
        if modes.weight:
            yield Section(f"Equidistribution, {held}", tuple(_law(functional, variant)))


def moving_variants(functional: Functional) -> tuple[Variant, ...]:
    """Return the variants in which the weight is present, or fields move: all that is held, and all that moves."""
    fields = tuple(sorted(functional.fields))
    if not functional.expression().has(s):
        return (Modes(differentiated=fields).variant,) if fields else ()
    return Modes("frozen").variant, Modes("differentiated", fields).variant


def _at_defaults(functional: Functional) -> str:
    """Return at which values of the parameters a functional is classified, nothing where it has none."""
    values = ", ".join(f"{name} = {value:g}" for name, value in functional.parameters.items())
    return f" and {values}" if values else ""


def _corner(model: CornerModel) -> Iterator[Section]:
    names = [str(p) for p in FIRST_DERIVATIVES]
    slopes = [(f"dE/d{name}", tidy(part)) for name, part in zip(names, model.gradient, strict=True)]
    yield Section("Corner energy and gradient, with s = 1", (("E", model.energy), *slopes))
    yield Section("Corner Hessian", tuple(_entries("d²E/", model.hessian, names)), detail=True)
    sentences = tuple(_splitting(model))
    kept = _entries("H+/", model.semidefinite_hessian, names)
    yield Section("Semidefinite part of the Hessian", (*sentences, *kept), detail=True)


def _splitting(model: CornerModel) -> Iterator[str]:
    """Yield whether the Hessian without a term is semidefinite, for which parameters, and a witness where it is not."""
    found = model.splitting
    answer = "positive semidefinite" if found.holds else "not always positive semidefinite"
    convex = "polyconvex" if found.holds else "not polyconvex"
    where = " and ".join(("J > 0", *model.functional.constraints))
    yield (
        f"The Hessian H+ without the term dP/dJ d²J is {answer} where {where}; "
        f"the density is {convex} there ({found.proof})."
    )
    if found.witness:
        values = ", ".join(f"{name} = {value:.6g}" for name, value in found.witness)
        free = ", with D for J as a variable of its own" if any(str(name) == "D" for name, _ in found.witness) else ""
        yield f"Witness, at which P is not convex: {values}{free}."
        unbound = [str(p) for p, _ in found.witness if str(p) in model.functional.parameters]
        if unbound and not model.functional.constraints:
            names = ", ".join(unbound)
            yield f"No constraint keeps {names} from that value; with one, such as {unbound[0]} > 0, it may hold."


def _entries(head: str, matrix: sympy.Matrix, names: list[str]) -> list[tuple[str, Expr]]:
    """Return the 10 distinct entries of a symmetric 4x4 matrix."""
    return [(f"{head}d{names[i]}d{names[j]}", tidy(matrix[i, j])) for i in range(4) for j in range(i, 4)]


def _equations(derived: EulerLagrange, title: str, *, detail: bool = False) -> Iterator[Section]:
    rows = (0, 1)
    yield Section(title, tuple(divergence_form(derived, row) for row in rows), "divergence form (x, y)", detail)
    yield Section(title, tuple(expanded_form(derived, row) for row in rows), "expanded form (x, y)", detail)
    if derived.reduction is not None:
        reduction = derived.reduction
        name = matrix_name(derived.functional)
        items: tuple[Item, ...] = (
            f"The residuals are {name} times w, so that w = 0 wherever det {name} is not zero.",
            (name, reduction.operator.matrix.applyfunc(tidy)),
            (f"det {name}", reduction.operator.determinant),
            ("w_x", reduction.system[0]),
            ("w_y", reduction.system[1]),
            *control_functions(derived),
        )
        yield Section(title, items, "reduced system", detail)


def divergence_form(derived: EulerLagrange, row: int) -> Divergence:
    """Return an equation, that of x (0) or of y (1), in divergence form."""
    return Divergence(tidy(derived.fluxes[row]), tidy(derived.fluxes[2 + row]), derived.sources[row])


def expanded_form(derived: EulerLagrange, row: int) -> Quasilinear:
    """Return an equation, that of x (0) or of y (1), expanded, with its terms grouped as in the paper."""
    terms = [(tidy(derived.coefficients[second][row]), second) for second in paper_order(row)]
    factor = common_factor(coefficient for coefficient, _ in terms)
    return Quasilinear(
        factor,
        tuple((coefficient / factor, second) for coefficient, second in terms if coefficient != 0),
        tidy(derived.rest[row]),
    )


def _classification(found: Classification) -> Iterator[Item]:
    linear, coupled, kind = found.words()
    yield f"The Euler-Lagrange equations are {linear}, {coupled} and {kind} ({found.ellipticity.how_known})."
    if found.ellipticity.witness:
        values = ", ".join(f"{name} = {value}" for name, value in found.ellipticity.witness)
        yield f"Witness of det A < 0 with J > 0: {values}."
    for kink in found.kinks:
        yield (
            f"The first derivatives of F jump or do not exist where {kink} = 0: the equations and their type are those "
            "elsewhere, and a minimum at such a kink need not solve the equations."
        )
    yield ("A(k)", found.symbol.applyfunc(lambda entry: tidy_quadratic(entry, k1, k2)))
    yield ("det A(k)", without_common_terms(found.determinant))
    yield f"Null Lagrangian: {_yes(found.null_lagrangian)}. Barrier at J = 0: {_yes(found.barrier)}."
    yield (
        f"Invariant under translation: {_yes(found.translation)}; rotation: {_yes(found.rotation)}; "
        f"exchange of xi and eta: {_yes(found.exchange)}."
    )
    degree, first, second = (_degree(value) for value in (found.scaling_degree, *found.reparametrization_degrees))
    yield f"Degree of scaling: {degree}; in g1 alone: {first}; in g2 alone: {second}."
    yield f"Lower bound: {_bound(found.lower_bound)}."


def _degree(value: Expr | None) -> str:
    return "not homogeneous" if value is None else str(value)


def _bound(bound: LowerBound) -> str:
    if bound.value is not None:
        return f"{bound.value} ({bound.proof})"
    return "none, unbounded below by scaling" if bound.proof == "refuted" else "none found"


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"


def _law(functional: Functional, variant: Variant) -> Iterator[Item]:
    law = equidistribution(functional, variant)
    if law is None:
        yield "No law of the form s^a J = constant was found."
        return
    yield "The residual R, multiplied by the inverse cofactor matrix A^t/J, is q times the gradient of c in (xi, eta):"
    yield ("c", law.law)
    yield ("q", law.multiplier)
    yield "The extremals keep c constant."
