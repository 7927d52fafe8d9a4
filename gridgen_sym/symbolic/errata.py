"""The known errata of the paper, recognised by what a comparison finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import sympy
from sympy import Expr

from .coordinates import expand_metric
from .notation import read

#: What a comparison can find.
Nature = Literal[
    "same",
    "multiple",
    "exchanged",
    "null Lagrangian",
    "other",
    "reversed",
    "square",
    "unbounded where folded",
    "finite where folded",
    "negative weight",
    "multiple of the integral",
    "only where J > 0",
]


@dataclass(frozen=True, slots=True)
class Finding:
    """What the comparison of one printed equation found.

    Attributes:
        agrees: whether the equation, as printed, has the solutions of the derived one, or the claim holds.
        status: the answer in words.
        nature: what kind of difference there is.
        difference: printed minus derived, or the factor printed/derived where there is one; 0 for agreement.
        text: one line, with the witness where there is one.
    """

    agrees: bool
    status: str
    nature: Nature
    difference: Expr
    text: str


@dataclass(frozen=True, slots=True)
class Erratum:
    """A known error of the paper.

    Attributes:
        key: its name.
        natures: the findings that show it.
        functionals: the functionals in whose equations it stands; empty for an equation without one.
        differences: text of the differences that show it; empty where the nature says enough.
        text: the explanation.
    """

    key: str
    natures: tuple[Nature, ...]
    functionals: tuple[str, ...]
    differences: tuple[str, ...]
    text: str

    def explains(self, functional: str | None, finding: Finding) -> bool:
        """Return whether a finding is this erratum."""
        if finding.nature not in self.natures or (
            functional not in self.functionals and (functional or self.functionals)
        ):
            return False
        return not self.differences or any(
            sympy.expand(expand_metric(read(text) - finding.difference)) == 0 for text in self.differences
        )


ERRATA = (
    Erratum("E1", ("null Lagrangian",), ("area",), ("J - J**2/2",), "the integral of J itself is the null Lagrangian"),
    Erratum("E2", ("exchanged",), ("area",), ("1", "-1"), "the two divergence equations are exchanged, up to sign"),
    Erratum(
        "E3",
        ("other",),
        ("area",),
        ("x_etaeta*y_xi*(x_xi - y_xi)",),
        "the last term is printed -y_xi*y_xi*x_etaeta; it must be -x_xi*y_xi*x_etaeta",
    ),
    Erratum(
        "E4",
        ("multiple",),
        ("knupp",),
        ("2",),
        "the printed equations are those of g11*g22/2, twice those of the combination of the integrals as printed",
    ),
    Erratum(
        "E5",
        ("reversed",),
        (),
        ("-1",),
        "with vectors pointing away from node k, two of the four Jacobians of a valid grid are negative",
    ),
    Erratum(
        "E6",
        ("unbounded where folded", "finite where folded"),
        ("winslow", "modified_liao"),
        (),
        "the claim holds only while every J > 0: a folded start stands on the wrong side of the barrier",
    ),
    Erratum("E7", ("square",), (), (), "g11 + g22 is the square of the Frobenius norm"),
    Erratum(
        "E8",
        ("negative weight",),
        ("area",),
        (),
        "where the weight is negative, the weighted Area energy is unbounded below",
    ),
    Erratum(
        "E9",
        ("multiple of the integral",),
        ("area", "length", "orthogonality", "combined"),
        ("2",),
        "the integral has the factor 1/2, the sum has not",
    ),
)


def find_erratum(functional: str | None, finding: Finding) -> Erratum | None:
    """Return the erratum that explains a finding, or None for agreement and for a new discovery."""
    return next((erratum for erratum in ERRATA if erratum.explains(functional, finding)), None)
