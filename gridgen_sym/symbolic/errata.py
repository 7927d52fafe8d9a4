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
        equations: the keys of the equations where it stands; the same error elsewhere is a discovery.
        differences: text of the differences that show it; empty where the nature says enough.
        text: the explanation.
    """

    key: str
    natures: tuple[Nature, ...]
    equations: tuple[str, ...]
    differences: tuple[str, ...]
    text: str

    def explains(self, equation: str, finding: Finding) -> bool:
        """Return whether a finding at an equation, given by its key, is this erratum."""
        if finding.nature not in self.natures or equation not in self.equations:
            return False
        return not self.differences or any(
            sympy.expand(expand_metric(read(text) - finding.difference)) == 0 for text in self.differences
        )


ERRATA = (
    Erratum(
        "E1",
        ("null Lagrangian",),
        ("area-integral-2",),
        ("J - J**2/2",),
        "the integral of J itself is the null Lagrangian",
    ),
    Erratum(
        "E2",
        ("exchanged",),
        ("area-divergence-1", "area-divergence-2"),
        ("1", "-1"),
        "the two divergence equations are exchanged, up to sign",
    ),
    Erratum(
        "E3",
        ("other",),
        ("area-expanded-2",),
        ("x_etaeta*y_xi*(x_xi - y_xi)",),
        "the last term is printed -y_xi*y_xi*x_etaeta; it must be -x_xi*y_xi*x_etaeta",
    ),
    Erratum(
        "E4",
        ("multiple",),
        ("knupp-expanded-1", "knupp-expanded-2"),
        ("2",),
        "the printed equations are those of g11*g22/2, twice those of the combination of the integrals as printed",
    ),
    Erratum(
        "E5",
        ("reversed",),
        ("jacobian-k2", "jacobian-k4"),
        ("-1",),
        "with vectors pointing away from node k, two of the four Jacobians of a valid grid are negative",
    ),
    Erratum(
        "E6",
        ("unbounded where folded", "finite where folded"),
        ("winslow-unfolded", "winslow-bounded", "modified-liao-unfolded"),
        (),
        "the claim holds only while every J > 0: a folded start stands on the wrong side of the barrier",
    ),
    Erratum("E7", ("square",), ("frobenius-norm",), (), "g11 + g22 is the square of the Frobenius norm"),
    Erratum(
        "E8",
        ("negative weight",),
        ("weight-2",),
        (),
        "where the weight is negative, the weighted Area energy is unbounded below",
    ),
    Erratum(
        "E9",
        ("multiple of the integral",),
        ("area-sum", "length-sum", "orthogonality-sum", "combined-sum"),
        ("2",),
        "the integral has the factor 1/2, the sum has not",
    ),
)


def find_erratum(equation: str, finding: Finding) -> Erratum | None:
    """Return the erratum that explains a finding at an equation, or None for agreement and for a discovery."""
    return next((erratum for erratum in ERRATA if erratum.explains(equation, finding)), None)
