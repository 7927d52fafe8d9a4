"""Compare every printed equation of the paper with the project's own derivation.

A comparison finds what differs, without knowing what to expect; `errata` then says which known erratum that is, if it
is one known at this equation. What differs without being known is a discovery.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from sympy import Expr

from ...functionals.paper import PRINTED, Kind, PrintedEquation
from . import claims, comparison
from .errata import Finding, find_erratum
from .interpolation import compare_interpolation


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer for one printed equation.

    Attributes:
        equation: what was compared.
        agrees: whether it has the solutions of the derived equation (a factor does no harm), or of the other one of
            the pair, or the claim holds.
        status: `agrees`, `agrees up to sign`, `agrees up to a factor`, `agrees in exchanged order`,
            `holds where J > 0`, `holds without ...` (variables), `differs`, `claim refuted` or
            `claim holds under a condition: ...`.
        difference: printed minus derived, or the factor printed/derived where there is one; 0 for agreement.
        erratum: the key of the known erratum, E1 to E14, or None.
        text: one line.
    """

    equation: PrintedEquation
    agrees: bool
    status: str
    difference: Expr
    erratum: str | None
    text: str

    @property
    def is_plain(self) -> bool:
        """Return whether it agrees without an erratum and without a condition such as J > 0."""
        return self.agrees and self.erratum is None and self.status.startswith("agrees")

    @property
    def is_discovery(self) -> bool:
        """Return whether it differs, if only by a factor or in order, without a known erratum."""
        loosely = self.status in ("agrees up to a factor", "agrees in exchanged order")
        return self.erratum is None and (not self.agrees or loosely)


_COMPARE: Mapping[Kind, Callable[[PrintedEquation], Finding]] = {
    "arguments": comparison.compare_arguments,
    "general": comparison.compare_general,
    "vectors": comparison.compare_vectors,
    "jacobian": comparison.compare_jacobian,
    "equality": comparison.compare_equality,
    "inequality": claims.compare_inequality,
    "integral": comparison.compare_integral,
    "equation": comparison.compare_equation,
    "sum": comparison.compare_sum,
    "parameters": claims.compare_parameters,
    "classification": claims.compare_classification,
    "claim": claims.compare_claim,
    "angle": claims.compare_angle,
    "interpolation": compare_interpolation,
    "weight": claims.compare_weight,
}


def verify(printed: Iterable[PrintedEquation] = PRINTED) -> tuple[Verdict, ...]:
    """Compare printed equations, by default all of the paper, with what is derived."""
    return tuple(_verdict(equation) for equation in printed)


def _verdict(equation: PrintedEquation) -> Verdict:
    finding = _COMPARE[equation.kind](equation)
    erratum = find_erratum(equation.key, finding)
    text = finding.text
    if erratum is not None:
        text = f"{erratum.text} ({finding.text})"
    elif not finding.agrees:
        text = f"not a known erratum: {finding.text}"
    return Verdict(
        equation=equation,
        agrees=finding.agrees,
        status=finding.status,
        difference=finding.difference,
        erratum=None if erratum is None else erratum.key,
        text=text,
    )
