"""The known errata of the paper, recognized by what a comparison finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import sympy
from sympy import Expr

from ..coordinates import expand_metric
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
    "only in part",
    "finite where shrinking",
    "folded at a boundary node",
    "not normalized",
    "of the sum only",
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
        text: the explanation, in one line.
        explanation: the same for a reader of the paper, in Markdown.
    """

    key: str
    natures: tuple[Nature, ...]
    equations: tuple[str, ...]
    differences: tuple[str, ...]
    text: str
    explanation: str

    def explains(self, equation: str, finding: Finding) -> bool:
        """Return whether a finding at an equation, given by its key, is this erratum."""
        if finding.nature not in self.natures or equation not in self.equations:
            return False
        return not self.differences or any(
            sympy.expand(expand_metric(read(text) - finding.difference)) == 0 for text in self.differences
        )


#: There is no E4: Knupp's printed equations are those of the combination of the sums, which is what Section 2.4 prints.
ERRATA = (
    Erratum(
        "E1",
        ("null Lagrangian",),
        ("area-integral-2",),
        ("J - J**2/2",),
        "the integral of J itself is the null Lagrangian",
        (
            r"The first line of the Area integral is half of the integral of $J^2$. The second line puts $x_\xi "
            r"y_\eta - x_\eta y_\xi$ in its place, which is $J$ itself. The integral of $J$ over the logical "
            r"square is the area of the domain, whatever the grid inside: such a density is called a null "
            r"Lagrangian, and its Euler–Lagrange equations read $0 = 0$. Read the first line only."
        ),
    ),
    Erratum(
        "E2",
        ("exchanged",),
        ("area-divergence-1", "area-divergence-2"),
        ("1", "-1"),
        "the two divergence equations are printed in exchanged order, up to sign; as a pair they are right",
        (
            r"For $F = J^2/2$ the fluxes of the equation of $x$ are $\partial F/\partial x_\xi = J y_\eta$ and "
            r"$\partial F/\partial x_\eta = -J y_\xi$: they contain $y$. The paper prints the equation with $x$ "
            r"in its fluxes first, which is minus the equation of $y$, and the equation of $x$ second. As a "
            r"system the two say the same; a program that solves the first for $x$ and the second for $y$, as "
            r"the expanded form suggests, would exchange them. It is a remark on their order only."
        ),
    ),
    Erratum(
        "E3",
        ("other",),
        ("area-expanded-2",),
        ("x_etaeta*y_xi*(x_xi - y_xi)",),
        "the last term is printed -y_xi*y_xi*x_etaeta; it must be -x_xi*y_xi*x_etaeta",
        (
            r"The coefficient of $x_{\eta\eta}$ in the equation of $y$ and that of $y_{\eta\eta}$ in the "
            r"equation of $x$ are the same second derivative of $F$, so they must be equal. The paper prints "
            r"$-x_\xi y_\xi$ in the one and $-y_\xi y_\xi$ in the other. The second is a slip of one letter."
        ),
    ),
    Erratum(
        "E5",
        ("reversed",),
        ("jacobian-k2", "jacobian-k4"),
        ("-1",),
        "with vectors pointing away from node k, two of the four Jacobians of a valid grid are negative",
        (
            r"The tables measure the vectors of all four cells from node $k$ outward. In the cells 2 and 4 one "
            r"of the two then points against its logical coordinate, and the determinant changes its sign: on a "
            r"valid grid it is $-J$. A barrier functional, which divides by $J$, would see two folded corners at"
            r" every node of a good grid. Here both vectors always point along increasing $\xi$ and $\eta$."
        ),
    ),
    Erratum(
        "E6",
        ("unbounded where folded", "finite where folded"),
        ("winslow-unfolded", "winslow-bounded", "modified-liao-unfolded"),
        (),
        "the claim holds only while every J > 0: a folded start is on the wrong side of the barrier",
        (
            r"Where $J > 0$ everywhere, the Winslow energy of a corner is at least 2, and it grows without bound "
            r"as a cell closes: the barrier. The paper concludes that the functional is bounded below and "
            r"produces unfolded grids. Both hold on the valid side of the barrier only. Where $J < 0$ the energy"
            r" $(g_{11} + g_{22})/J$ is negative and falls to $-\infty$ as $J \to 0^-$: from a folded start a "
            r"minimizer runs to the wrong side of the barrier and stays there. The square in the modified Liao "
            r"functional makes the energy positive on both sides, so that a folded cell is held behind the "
            r"barrier instead. A folded start must be untangled first, with the regularized barrier, or by "
            r"solving the Winslow equations."
        ),
    ),
    Erratum(
        "E7",
        ("square",),
        ("frobenius-norm",),
        (),
        "g11 + g22 is the square of the Frobenius norm",
        (
            r"With $A = [\mathbf g_1\ \mathbf g_2]$ the Jacobian matrix, $g_{11} + g_{22}$ is the sum of the "
            r"squares of its four entries: the square of the Frobenius norm. The displayed formula after the "
            r"sentence has the square."
        ),
    ),
    Erratum(
        "E8",
        ("negative weight",),
        ("weight-2",),
        (),
        "where the weight is negative, larger cells have less weighted Area energy: on grids with a fixed boundary and "
        "J > 0 it is bounded below, and unbounded only where nodes may leave the domain or cells may fold",
        (
            r"The second adaptive example drops the absolute value of the first: $s = 5 + 200 \sin 2\pi x\,\sin "
            r"2\pi y$ is $-195$ at $x = 1/4$, $y = 3/4$. There a larger cell has a smaller weighted energy $s "
            r"J^2$. On grids with a fixed boundary and $J > 0$ the sum of $J$ is bounded, and so the energy is "
            r"bounded below. Where nodes may leave the domain, or cells may fold, it falls without end, and no "
            r"minimum exists. The program refuses such a weight unless `allow_negative` is given."
        ),
    ),
    Erratum(
        "E9",
        ("multiple of the integral",),
        ("area-sum", "length-sum", "orthogonality-sum"),
        ("2",),
        "the integral has the factor 1/2, the sum has not",
        (
            r"The integrals of Area, Length and Orthogonality carry a factor 1/2, their discrete sums do not. "
            r"(Section 2.4 combines the sums, so that Knupp's is that of $g_{11} g_{22}/2$, and its printed "
            r"equations agree.) A factor of the whole does not move a minimum. It must "
            r"be known to compare energies, and the discrete gradient with the Euler–Lagrange equations: a "
            r"functional's `corner_factor` says it."
        ),
    ),
    Erratum(
        "E10",
        ("folded at a boundary node",),
        ("winslow-inner-nodes",),
        (),
        "the sums run over inner nodes, so that corners at boundary nodes have no barrier and may fold",
        (
            r"Node $k$ runs over the $n$ internal nodes, and $i$ over the four cells around it: corners at boundary "
            r"nodes are in no sum. On $3 \times 3$ nodes of the unit square whose lower middle node is at "
            r"$(0.15, 0.5)$, the minimum of the Winslow sum has a corner with $J < 0$ at that node, although a valid "
            r"grid with this boundary exists: the minimum of the sum over all corners is one. The program "
            r"sums over all corners of all cells; with `interior_only=True, keep_valid=False, spacing='index'` it "
            r"returns the paper's literal minimum."
        ),
    ),
    Erratum(
        "E11",
        ("finite where shrinking",),
        ("winslow-degenerate", "modified-liao-degenerate"),
        ("2", "4"),
        "the value is infinite as |J| -> 0 only where the edges do not all shrink: similar cells have the same value",
        (
            r"Both densities are of degree 0: they see the shape of a cell, and not its size. The cell with "
            r"$\mathbf g_1 = (t, 0)$ and $\mathbf g_2 = (0, t)$ is a square for every $t$, with $J = t^2 \to 0$ and "
            r"$\mathsf K = 2$. The value grows without bound where an edge keeps its length, or the angle closes."
        ),
    ),
    Erratum(
        "E12",
        ("square",),
        ("metric-length",),
        (),
        "g11 is the square of the length of g1",
        (
            r"$g_{11} = \mathbf g_1 \cdot \mathbf g_1$ grows with the length, but it is its square: the functional "
            r"called Length sums squares of lengths. The length of a straight grid line does not depend on how its "
            r"nodes are spread along it; the sum of the squares of its edges does, and is smallest where they are "
            r"spread evenly."
        ),
    ),
    Erratum(
        "E13",
        ("not normalized",),
        ("metric-angle",),
        ("4",),
        "g12 is the cosine of the angle times both lengths: it is zero at right angles, and measures no other angle",
        (
            r"$g_{12} = |\mathbf g_1|\,|\mathbf g_2| \cos\theta$ changes with the lengths at the same angle $\theta$. "
            r"Of two cells of one shape the larger has more orthogonality energy, by the fourth power of the size, and "
            r"a cell whose edges shrink loses it without coming nearer to a right angle. "
            r"$g_{12}/\sqrt{g_{11} g_{22}} = \cos\theta$ measures the angle."
        ),
    ),
    Erratum(
        "E14",
        ("of the sum only",),
        ("winslow-minimum", "modified-liao-minimum"),
        (),
        "the sum of the condition numbers is minimized, not the condition number of each corner",
        (
            r"What is smallest is the sum over the corners, and so the mean of $\mathsf K$. A single corner, the worst "
            r"one too, may have a larger $\mathsf K$ than on another grid. If each $\mathsf K$ were at its minimum, "
            r"then each $\mathsf K^2$ would be at its minimum on the same grid; the minima of Winslow and of modified "
            r"Liao are different grids, because the square weighs the worst corners more."
        ),
    ),
)


def find_erratum(equation: str, finding: Finding) -> Erratum | None:
    """Return the erratum that explains a finding at an equation, or None for agreement and for a discovery."""
    return next((erratum for erratum in ERRATA if erratum.explains(equation, finding)), None)
