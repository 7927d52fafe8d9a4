"""The sentences of a report in LaTeX that say what is known of a functional, and how it is known."""

from __future__ import annotations

from collections.abc import Iterator

from ...functionals.definition import Functional
from ..classify.bounds import LowerBound
from ..classify.classification import Classification
from ..definiteness import SAMPLES, Definiteness
from .printer import latex
from .prose import constraints, listed, short_number

_KINDS = {
    "elliptic": r"elliptic: $\det A(k) \neq 0$ for every real $k \neq 0$",
    "weakly elliptic": r"weakly elliptic: $\det A(k)$ is nowhere negative, but vanishes for some $k \neq 0$",
    "degenerate": r"degenerate: $\det A(k) = 0$ for every $k$",
    "changing type": r"of changing type: $\det A(k)$ takes both signs",
}


def judged_at(functional: Functional) -> str:
    """Return at which values of the parameters and fields a functional is classified; nothing where it has none."""
    at = ["at the default values of the parameters"] if functional.parameters else []
    at += ["for all values that its fields may take"] if functional.fields else []
    return f"This section holds {listed(at)}." if at else ""


def how_known(proof: str, samples: int = SAMPLES) -> str:
    """Return how something is known."""
    sampled = f"sampled at {samples} random Jacobian matrices, not proved" if samples else "not decided"
    return {"proved": "proved", "refuted": "proved by this witness"}.get(proof, sampled)


def splitting(functional: Functional, found: Definiteness) -> str:
    """Return the sentence on the semidefinite part of the Hessian."""
    where = listed(["$J > 0$", *(rule for rule, _ in constraints(functional))])
    if found.holds:
        return (
            f"Where {where}, the matrix $H^+$ is positive semidefinite ({how_known(found.proof)}): $P$ is convex "
            "there, and the density is polyconvex."
        )
    if not found.witness:
        return f"Where {where}, the matrix $H^+$ is not always positive semidefinite ({how_known(found.proof)})."
    at = listed([f"${latex(name)} = {short_number(value)}$" for name, value in found.witness])
    free = ", with $D$ in the place of the argument $J$ of $P$" if "D" in map(str, dict(found.witness)) else ""
    return (
        f"Where {where}, the matrix $H^+$ is not always positive semidefinite, and the density is not polyconvex: "
        f"$P$ is not convex at {at}{free} (computed at this point)."
    )


def type_of_equations(found: Classification, equations: str) -> str:
    """Return the sentence on the type of the Euler-Lagrange equations; `equations` refers to them."""
    linear, coupled, kind = found.words()
    if found.null_lagrangian:
        return f"The equations {equations} vanish identically (proved): $F$ is a null Lagrangian."
    known = found.ellipticity
    at = listed([f"${latex(name)} = {latex(value)}$" for name, value in known.witness])
    example = f". It is negative at {at}, where $J > 0$" if at else ""
    proof = "sampled" if known.proof == "refuted" and not at else known.proof
    return (
        f"Where $J > 0$, the equations {equations} are {linear} and {coupled} (by their coefficients), and "
        f"{_KINDS[kind]}{example} ({how_known(proof, known.samples)})."
    )


def properties(found: Classification) -> Iterator[str]:
    """Yield the sentences on invariances, scaling, the barrier, the bound and kinks."""
    kinds = {
        "translations": found.translation,
        "rotations": found.rotation,
        r"an exchange of $\xi$ and $\eta$": found.exchange,
    }
    kept, lost = ([name for name, holds in kinds.items() if holds == wanted] for wanted in (True, False))
    if kept:
        yield f"The density is invariant under {listed(kept)} (proved)."
    if lost:
        yield f"Invariance under {listed(lost, 'or')} was not found."
    yield _scaling(found)
    limit, barrier = (r"tends to $+\infty$", "a") if found.barrier else (r"does not tend to $+\infty$", "no")
    yield (
        rf"As $J \to 0^+$ at fixed lengths of both edges, the density {limit} (by the limit at one pair of lengths): "
        f"the functional has {barrier} barrier."
    )
    yield bound(found.lower_bound)
    if found.kinks:
        zeros = listed([f"${latex(kink)} = 0$" for kink in found.kinks])
        yield (
            f"The first derivatives of $F$ jump or do not exist where {zeros} (sampled): the equations and their type "
            "are those elsewhere, and a minimum at such a kink need not solve the equations."
        )


def _scaling(found: Classification) -> str:
    first, second = found.reparametrization_degrees
    degrees = ((found.scaling_degree, "$(x, y)$"), (first, r"$(x_\xi, y_\xi)$"), (second, r"$(x_\eta, y_\eta)$"))
    parts = [f"of degree ${latex(value)}$ in {what}" for value, what in degrees if value is not None]
    return f"It is homogeneous {listed(parts)} (proved)." if parts else "No degree of homogeneity was found."


def bound(found: LowerBound) -> str:
    """Return the sentence on the lower bound."""
    if found.value is not None:
        return f"Where $J > 0$, $F \\ge {latex(found.value)}$ ({how_known(found.proof)})."
    if found.proof == "refuted":
        return "Where $J > 0$, $F$ is not bounded below: it is negative somewhere, and scaling has no bound (proved)."
    return "A lower bound of $F$ where $J > 0$ was not found."
