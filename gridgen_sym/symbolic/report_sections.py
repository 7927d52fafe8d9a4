"""What a report on a functional contains: sections of named expressions and sentences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import sympy
from sympy import Expr

from ..functionals.definition import Functional
from .bounds import LowerBound
from .classify import Classification, classify
from .continuous import EulerLagrange, euler_lagrange
from .coordinates import FIRST_DERIVATIVES, SECOND_DERIVATIVES, Variant, s
from .discrete import CornerModel, corner_model
from .equidistribution import equidistribution


@dataclass(frozen=True, slots=True)
class Divergence:
    """An equation d/dxi(along_xi) + d/deta(along_eta) - source = 0."""

    along_xi: Expr
    along_eta: Expr
    source: Expr


@dataclass(frozen=True, slots=True)
class Quasilinear:
    """An equation: the sum of coefficient times second derivative, plus a rest, = 0."""

    terms: tuple[tuple[Expr, Expr], ...]
    rest: Expr


Item = str | tuple[str, "Expr | sympy.Matrix"] | Divergence | Quasilinear


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part of a report.

    Attributes:
        title: its title.
        items: sentences, named expressions and equations.
    """

    title: str
    items: tuple[Item, ...]


def sections(functional: Functional) -> Iterator[Section]:
    """Yield the sections of the report on a functional."""
    model = corner_model(functional, "plain")
    yield Section("Density", (("F", functional.expression()),))
    yield Section("Corner energy, with s = 1", _corner(model))
    yield from _equations(euler_lagrange(functional, "plain"), "Euler-Lagrange equations, with s = 1")
    yield Section("Classification, where J > 0", tuple(_classification(classify(functional))))
    if functional.expression().has(s):
        for variant in _weighted():
            yield from _equations(euler_lagrange(functional, variant), f"Euler-Lagrange equations, weight {variant}")
            yield Section(f"Equidistribution, weight {variant}", tuple(_law(functional, variant)))


def _weighted() -> tuple[Variant, Variant]:
    return ("frozen", "differentiated")


def _corner(model: CornerModel) -> tuple[Item, ...]:
    names = [str(p) for p in FIRST_DERIVATIVES]
    slopes: list[Item] = [(f"dE/d{name}", part) for name, part in zip(names, model.gradient, strict=True)]
    bends = _entries("d²E/", model.hessian, names)
    kept = _entries("H+/", model.semidefinite_hessian, names)
    answer = "positive semidefinite" if model.splitting.holds else "not always positive semidefinite"
    convex = "polyconvex" if model.splitting.holds else "not polyconvex"
    sentence = (
        f"The Hessian H+ without the term dP/dJ d²J is {answer}; the density is {convex} ({model.splitting.proof})."
    )
    return (("E", model.energy), *slopes, *bends, sentence, *kept)


def _entries(head: str, matrix: sympy.Matrix, names: list[str]) -> list[Item]:
    """Return the 10 distinct entries of a symmetric 4x4 matrix."""
    return [
        (f"{head}d{names[i]}d{names[j]}", sympy.collect(matrix[i, j], FIRST_DERIVATIVES))
        for i in range(4)
        for j in range(i, 4)
    ]


def _equations(derived: EulerLagrange, title: str) -> Iterator[Section]:
    divergence = tuple(Divergence(derived.fluxes[row], derived.fluxes[2 + row], derived.sources[row]) for row in (0, 1))
    yield Section(f"{title}, divergence form (x, y)", divergence)
    expanded = tuple(
        Quasilinear(
            tuple((sympy.factor(derived.coefficients[second][row]), second) for second in SECOND_DERIVATIVES),
            derived.rest[row],
        )
        for row in (0, 1)
    )
    yield Section(f"{title}, expanded form (x, y)", expanded)
    if derived.reduction is not None:
        reduction = derived.reduction
        items: tuple[Item, ...] = (
            "The residuals are M times w, so that w = 0 wherever det M is not zero.",
            ("M", reduction.matrix),
            ("det M", reduction.determinant),
            ("w_x", reduction.system[0]),
            ("w_y", reduction.system[1]),
        )
        yield Section(f"{title}, reduced system", items)


def _classification(found: Classification) -> Iterator[Item]:
    linear, coupled, kind = found.words()
    yield f"The Euler-Lagrange equations are {linear}, {coupled} and {kind} ({found.ellipticity.proof})."
    if found.ellipticity.witness:
        values = ", ".join(f"{name} = {value}" for name, value in found.ellipticity.witness)
        yield f"Witness of det A < 0 with J > 0: {values}."
    yield ("A(k)", found.symbol)
    yield ("det A(k)", found.determinant)
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
