"""The printed equations and claims of the paper, as data; `symbolic.verify` compares them with what is derived.

They stand here exactly as printed, errors included, and none is ever used to compute a grid. Expressions are
text in the names of the metric (`g11`, `J`, `x_xi`, ...), of second derivatives (`x_xixi`, ...), and of

- `D_xi(...)`, `D_eta(...)`: total derivatives along the logical coordinates;
- `F_x`, `F_x_xi`, ...: derivatives of the density of any functional;
- `A`, `G`: the Jacobian matrix [g1 g2] and the metric tensor, with `norm` (Frobenius), `det`, `inverse`, `transpose`;
- `matrix(a, b, c, d)`: the matrix with the rows (a, b) and (c, d); `g21`: g2.g1;
- `g1`, `g2`: the covariant vectors, with `dot` and `cross`;
- `lambda_1`, `lambda_2`: the eigenvalues of the metric tensor;
- `x_k`, `x_1`, ...: positions of node k and of its neighbors, 4 and 2 along +xi and -xi, 1 and 3 along +eta and -eta.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal[
    "arguments",
    "general",
    "vectors",
    "jacobian",
    "equality",
    "inequality",
    "integral",
    "equation",
    "sum",
    "parameters",
    "classification",
    "claim",
    "angle",
    "interpolation",
    "weight",
]


@dataclass(frozen=True, slots=True)
class PrintedEquation:
    """One equation or claim of the paper, as printed.

    Attributes:
        key: short unique name.
        place: where it is in the paper.
        latex: as printed, shortened where it is long.
        kind: what it is, and so how it is compared:
            `arguments` (what a density may depend on), `general` (an Euler–Lagrange equation of any functional),
            `vectors` and `jacobian` (entries of g1, g2 and of the Jacobian matrix, in rows), `equality` and
            `inequality` (left side >= right side), `integral` (a density), `equation` (an Euler–Lagrange equation
            of one functional, = 0), `sum` (a corner energy), `parameters` (k_A, k_L, k_O), `classification` and `claim`
            (words), `angle` (a quantity that is to measure the angle between g1 and g2), `interpolation` (words on
            transfinite interpolation), `weight` (an adaptive function of x and y).
        expressions: the expressions as text, or the words of a claim.
        functional: the functional it belongs to, if any.
        of_sum: whether an `equation` is that of a functional which is printed as a sum, not as an integral.
        component: 0 for the equation printed first (that of x), 1 for the second (that of y).
    """

    key: str
    place: str
    latex: str
    kind: Kind
    expressions: tuple[str, ...]
    functional: str | None = None
    component: int = 0
    of_sum: bool = False


_GENERAL = (
    PrintedEquation(
        "functional",
        "Section 1, equation (1)",
        r"\mathcal{I}(x,y) = \int \mathcal{F}(\xi,\eta,x,y,x_\xi,x_\eta,y_\xi,y_\eta)\,d\xi\,d\eta",
        "arguments",
        ("xi", "eta", "x", "y", "x_xi", "x_eta", "y_xi", "y_eta"),
    ),
    PrintedEquation(
        "euler-lagrange-1",
        "Section 1, equation (2)",
        r"\mathcal{F}_x - \partial_\xi(\mathcal{F}_{x_\xi}) - \partial_\eta(\mathcal{F}_{x_\eta}) = 0",
        "general",
        ("F_x - D_xi(F_x_xi) - D_eta(F_x_eta)",),
    ),
    PrintedEquation(
        "euler-lagrange-2",
        "Section 1, equation (3)",
        r"\mathcal{F}_y - \partial_\xi(\mathcal{F}_{y_\xi}) - \partial_\eta(\mathcal{F}_{y_\eta}) = 0",
        "general",
        ("F_y - D_xi(F_y_xi) - D_eta(F_y_eta)",),
        component=1,
    ),
    PrintedEquation(
        "covariant-vectors",
        "Section 1, equation (4)",
        r"\mathbf{g}_1 = (x_a-x_o,\,y_a-y_o)^t,\quad \mathbf{g}_2 = (x_b-x_o,\,y_b-y_o)^t",
        "vectors",
        ("x_a - x_o", "y_a - y_o", "x_b - x_o", "y_b - y_o"),
    ),
    PrintedEquation(
        "metric-tensor",
        "Section 1, equation (5)",
        r"\boldsymbol{g} = \boldsymbol{J}^t\,\boldsymbol{J}",
        "equality",
        ("G", "transpose(A)*A"),
    ),
    PrintedEquation(
        "metric-11",
        "Section 2, before Table 1",
        r"g_{11} = \mathbf{g}_1^t\cdot\mathbf{g}_1",
        "equality",
        ("g11", "dot(g1, g1)"),
    ),
    PrintedEquation(
        "metric-12",
        "Section 2, before Table 1",
        r"g_{12} = \mathbf{g}_1^t\cdot\mathbf{g}_2",
        "equality",
        ("g12", "dot(g1, g2)"),
    ),
    PrintedEquation(
        "metric-angle",
        "Section 2, before Table 1",
        r"g_{12}\ \text{is a measure of the angle between}\ \mathbf{g}_1\ \text{and}\ \mathbf{g}_2",
        "angle",
        ("g12",),
    ),
    PrintedEquation(
        "metric-length",
        "Section 2, before Table 1",
        r"g_{11}\ \text{is a measure of the discrete}\ L_2\ \text{length of}\ \mathbf{g}_1",
        "equality",
        ("g11", "norm(g1)"),
    ),
)


def _tables() -> tuple[PrintedEquation, ...]:
    """Return the rows of both tables: cell i of node k, its first neighbor (g1) and its second one (g2)."""
    rows = []
    for i, first, second in ((1, 4, 1), (2, 2, 1), (3, 2, 3), (4, 4, 3)):
        a, b, c, d = (f"{r}_{node} - {r}_k" for node in (first, second) for r in ("x", "y"))
        latex = [entry.replace("_k", "_{k}") for entry in (a, b, c, d)]
        rows.append(
            PrintedEquation(
                f"jacobian-k{i}",
                f"Table 1, J(k_{i})",
                rf"\boldsymbol{{J}}(k_{i}) = \begin{{bmatrix}} {latex[0]} & {latex[2]} \\"
                rf" {latex[1]} & {latex[3]} \end{{bmatrix}}",
                "jacobian",
                (a, c, b, d),
            )
        )
        rows.append(
            PrintedEquation(
                f"vectors-k{i}",
                f"Table 2, g1(k_{i}) and g2(k_{i})",
                rf"\mathbf{{g}}_1(k_{i}) = ({latex[0]},\,{latex[1]})^t,\quad "
                rf"\mathbf{{g}}_2(k_{i}) = ({latex[2]},\,{latex[3]})^t",
                "vectors",
                (a, b, c, d),
            )
        )
    return tuple(rows)


_AREA = (
    PrintedEquation(
        "area-integral-1",
        "Section 2.1, integral, first line",
        r"\mathcal{I}_A = \tfrac12\int |\boldsymbol{J}|^2\,d\xi\,d\eta",
        "integral",
        ("J**2/2",),
        "area",
    ),
    PrintedEquation(
        "area-integral-2",
        "Section 2.1, integral, second line",
        r"\mathcal{I}_A = \int (x_\xi y_\eta - x_\eta y_\xi)\,d\xi\,d\eta",
        "integral",
        ("x_xi*y_eta - x_eta*y_xi",),
        "area",
    ),
    PrintedEquation(
        "area-divergence-1",
        "Section 2.1, first Euler–Lagrange equation in divergence form",
        r"\partial_\xi(|\boldsymbol{J}|\,x_\eta) - \partial_\eta(|\boldsymbol{J}|\,x_\xi) = 0",
        "equation",
        ("D_xi(J*x_eta) - D_eta(J*x_xi)",),
        "area",
    ),
    PrintedEquation(
        "area-divergence-2",
        "Section 2.1, second Euler–Lagrange equation in divergence form",
        r"\partial_\xi(|\boldsymbol{J}|\,y_\eta) - \partial_\eta(|\boldsymbol{J}|\,y_\xi) = 0",
        "equation",
        ("D_xi(J*y_eta) - D_eta(J*y_xi)",),
        "area",
        1,
    ),
    PrintedEquation(
        "area-expanded-1",
        "Section 2.1, first expanded Euler–Lagrange equation",
        r"y_\eta^2 x_{\xi\xi} - x_\eta y_\eta y_{\xi\xi} - 2 y_\xi y_\eta x_{\xi\eta}"
        r" + (x_\xi y_\eta + x_\eta y_\xi) y_{\xi\eta} + y_\xi^2 x_{\eta\eta} - x_\xi y_\xi y_{\eta\eta} = 0",
        "equation",
        (
            "y_eta**2*x_xixi - x_eta*y_eta*y_xixi - 2.0*y_xi*y_eta*x_xieta + (x_xi*y_eta + x_eta*y_xi)*y_xieta"
            " + y_xi**2*x_etaeta - x_xi*y_xi*y_etaeta",
        ),
        "area",
    ),
    PrintedEquation(
        "area-expanded-2",
        "Section 2.1, second expanded Euler–Lagrange equation",
        r"x_\eta^2 y_{\xi\xi} - x_\eta y_\eta x_{\xi\xi} - 2 x_\xi x_\eta y_{\xi\eta}"
        r" + (x_\xi y_\eta + x_\eta y_\xi) x_{\xi\eta} + x_\xi^2 y_{\eta\eta} - y_\xi y_\xi x_{\eta\eta} = 0",
        "equation",
        (
            "x_eta**2*y_xixi - x_eta*y_eta*x_xixi - 2.0*x_xi*x_eta*y_xieta + (x_xi*y_eta + x_eta*y_xi)*x_xieta"
            " + x_xi**2*y_etaeta - y_xi*y_xi*x_etaeta",
        ),
        "area",
        1,
    ),
    PrintedEquation(
        "area-classification",
        "Section 2.1, after the expanded equations",
        r"\text{non-elliptic, coupled and quasi-linear}",
        "classification",
        ("non-elliptic", "coupled", "quasilinear"),
        "area",
    ),
    PrintedEquation(
        "area-sum",
        "Section 2.1, discrete functional with the adaptive function",
        r"\mathcal{F}_A = \sum_k \sum_i s(k_i)\,[J(k_i)]^2",
        "sum",
        ("s*J**2",),
        "area",
    ),
)

_LENGTH = (
    PrintedEquation(
        "length-integral-1",
        "Section 2.2, integral, first line",
        r"\mathcal{I}_L = \tfrac12\int [g_{11} + g_{22}]\,d\xi\,d\eta",
        "integral",
        ("(g11 + g22)/2",),
        "length",
    ),
    PrintedEquation(
        "length-integral-2",
        "Section 2.2, integral, second line",
        r"\mathcal{I}_L = \tfrac12\int [x_\xi^2 + x_\eta^2 + y_\xi^2 + y_\eta^2]\,d\xi\,d\eta",
        "integral",
        ("(x_xi**2 + x_eta**2 + y_xi**2 + y_eta**2)/2",),
        "length",
    ),
    PrintedEquation(
        "length-expanded-1",
        "Section 2.2, first Euler–Lagrange equation",
        r"x_{\xi\xi} + x_{\eta\eta} = 0",
        "equation",
        ("x_xixi + x_etaeta",),
        "length",
    ),
    PrintedEquation(
        "length-expanded-2",
        "Section 2.2, second Euler–Lagrange equation",
        r"y_{\xi\xi} + y_{\eta\eta} = 0",
        "equation",
        ("y_xixi + y_etaeta",),
        "length",
        1,
    ),
    PrintedEquation(
        "length-classification",
        "Section 2.2, after the Euler–Lagrange equations",
        r"\text{linear and uncoupled}",
        "classification",
        ("linear", "uncoupled"),
        "length",
    ),
    PrintedEquation(
        "length-sum",
        "Section 2.2, discrete functional",
        r"\mathcal{F}_L = \sum_k \sum_i \left(g_{11}(k_i) + g_{22}(k_i)\right)",
        "sum",
        ("g11 + g22",),
        "length",
    ),
)

_ORTHOGONALITY = (
    PrintedEquation(
        "orthogonality-integral-1",
        "Section 2.3, integral, first line",
        r"\mathcal{I}_O = \tfrac12\int (g_{12})^2\,d\xi\,d\eta",
        "integral",
        ("g12**2/2",),
        "orthogonality",
    ),
    PrintedEquation(
        "orthogonality-integral-2",
        "Section 2.3, integral, second line",
        r"\mathcal{I}_O = \tfrac12\int (\mathbf{g}_1\cdot\mathbf{g}_2)^2\,d\xi\,d\eta",
        "integral",
        ("dot(g1, g2)**2/2",),
        "orthogonality",
    ),
    PrintedEquation(
        "orthogonality-integral-3",
        "Section 2.3, integral, third line",
        r"\mathcal{I}_O = \tfrac12\int (x_\xi x_\eta + y_\xi y_\eta)^2\,d\xi\,d\eta",
        "integral",
        ("(x_xi*x_eta + y_xi*y_eta)**2/2",),
        "orthogonality",
    ),
    PrintedEquation(
        "orthogonality-divergence-1",
        "Section 2.3, first Euler–Lagrange equation in divergence form",
        r"\partial_\xi(g_{12}\,x_\eta) + \partial_\eta(g_{12}\,x_\xi) = 0",
        "equation",
        ("D_xi(g12*x_eta) + D_eta(g12*x_xi)",),
        "orthogonality",
    ),
    PrintedEquation(
        "orthogonality-divergence-2",
        "Section 2.3, second Euler–Lagrange equation in divergence form",
        r"\partial_\xi(g_{12}\,y_\eta) + \partial_\eta(g_{12}\,y_\xi) = 0",
        "equation",
        ("D_xi(g12*y_eta) + D_eta(g12*y_xi)",),
        "orthogonality",
        1,
    ),
    PrintedEquation(
        "orthogonality-classification",
        "Section 2.3, before the expanded equations",
        r"\text{quasilinear, coupled and non-elliptic}",
        "classification",
        ("quasilinear", "coupled", "non-elliptic"),
        "orthogonality",
    ),
    PrintedEquation(
        "orthogonality-expanded-1",
        "Section 2.3, first expanded Euler–Lagrange equation",
        r"x_\eta^2 x_{\xi\xi} + x_\eta y_\eta y_{\xi\xi} + (4 x_\xi x_\eta + 2 y_\xi y_\eta) x_{\xi\eta}"
        r" + (x_\xi y_\eta + x_\eta y_\xi) y_{\xi\eta} + x_\xi^2 x_{\eta\eta} + x_\xi y_\xi y_{\eta\eta} = 0",
        "equation",
        (
            "x_eta**2*x_xixi + x_eta*y_eta*y_xixi + (4*x_xi*x_eta + 2*y_xi*y_eta)*x_xieta"
            " + (x_xi*y_eta + x_eta*y_xi)*y_xieta + x_xi**2*x_etaeta + x_xi*y_xi*y_etaeta",
        ),
        "orthogonality",
    ),
    PrintedEquation(
        "orthogonality-expanded-2",
        "Section 2.3, second expanded Euler–Lagrange equation",
        r"y_\eta^2 y_{\xi\xi} + y_\eta x_\eta x_{\xi\xi} + (4 y_\xi y_\eta + 2 x_\xi x_\eta) y_{\xi\eta}"
        r" + (y_\xi x_\eta + y_\eta x_\xi) x_{\xi\eta} + y_\xi^2 y_{\eta\eta} + y_\xi x_\xi x_{\eta\eta} = 0",
        "equation",
        (
            "y_eta**2*y_xixi + y_eta*x_eta*x_xixi + (4*y_xi*y_eta + 2*x_xi*x_eta)*y_xieta"
            " + (y_xi*x_eta + y_eta*x_xi)*x_xieta + y_xi**2*y_etaeta + y_xi*x_xi*x_etaeta",
        ),
        "orthogonality",
        1,
    ),
    PrintedEquation(
        "orthogonality-nonnegative",
        "Section 2.3, after the expanded equations",
        r"\text{takes only non-negative values}",
        "claim",
        ("non-negative",),
        "orthogonality",
    ),
    PrintedEquation(
        "orthogonality-sum",
        "Section 2.3, discrete functional",
        r"\mathcal{F}_O = \sum_k \sum_i \left(\mathbf{g}_1(k_i)\cdot\mathbf{g}_2(k_i)\right)^2",
        "sum",
        ("dot(g1, g2)**2",),
        "orthogonality",
    ),
)

_COMBINED = (
    PrintedEquation(
        "combined-sum",
        "Section 2.4, discrete functional",
        r"\mathcal{F} = \Bbbk_A\mathcal{F}_A + \Bbbk_L\mathcal{F}_L + \Bbbk_O\mathcal{F}_O",
        "sum",
        ("k_A*s*J**2 + k_L*(g11 + g22) + k_O*dot(g1, g2)**2",),
        "combined",
    ),
    PrintedEquation(
        "combined-parameters",
        "Section 2.4, conditions on the parameters",
        r"\Bbbk_A + \Bbbk_L + \Bbbk_O = 1,\quad \Bbbk_A \ge 0,\ \Bbbk_L \ge 0,\ \Bbbk_O \ge 0",
        "claim",
        ("constraints", "k_A + k_L + k_O == 1", "k_A >= 0", "k_L >= 0", "k_O >= 0"),
        "combined",
    ),
    PrintedEquation(
        "knupp-parameters",
        "Section 2.4, Knupp's choice of the parameters",
        r"\Bbbk_A = 0.50,\quad \Bbbk_L = 0.0,\quad \Bbbk_O = 0.50",
        "parameters",
        ("0.50", "0.0", "0.50"),
        "knupp",
    ),
    PrintedEquation(
        "knupp-expanded-1",
        "Section 2.4, first expanded Euler–Lagrange equation",
        r"(x_\eta^2 + y_\eta^2) x_{\xi\xi} + 4 x_\xi x_\eta x_{\xi\eta}"
        r" + 2 (x_\xi y_\eta + x_\eta y_\xi) y_{\xi\eta} + (x_\xi^2 + y_\xi^2) x_{\eta\eta} = 0",
        "equation",
        (
            "(x_eta**2 + y_eta**2)*x_xixi + 4*x_xi*x_eta*x_xieta + 2*(x_xi*y_eta + x_eta*y_xi)*y_xieta"
            " + (x_xi**2 + y_xi**2)*x_etaeta",
        ),
        "knupp",
        of_sum=True,
    ),
    PrintedEquation(
        "knupp-expanded-2",
        "Section 2.4, second expanded Euler–Lagrange equation",
        r"(x_\eta^2 + y_\eta^2) y_{\xi\xi} + 4 y_\xi y_\eta y_{\xi\eta}"
        r" + 2 (x_\xi y_\eta + x_\eta y_\xi) x_{\xi\eta} + (x_\xi^2 + y_\xi^2) y_{\eta\eta} = 0",
        "equation",
        (
            "(x_eta**2 + y_eta**2)*y_xixi + 4*y_xi*y_eta*y_xieta + 2*(x_xi*y_eta + x_eta*y_xi)*x_xieta"
            " + (x_xi**2 + y_xi**2)*y_etaeta",
        ),
        "knupp",
        1,
        of_sum=True,
    ),
)

_WINSLOW = (
    PrintedEquation(
        "winslow-sum-1",
        "Section 2.5, discrete functional",
        r"\mathcal{F} = \sum_k \sum_i \frac{g_{11}(k_i) + g_{22}(k_i)}{|\boldsymbol{J}(k_i)|}",
        "sum",
        ("(g11 + g22)/J",),
        "winslow",
    ),
    PrintedEquation(
        "winslow-barrier",
        "Section 2.5, after the discrete functional",
        r"\text{it has a barrier}",
        "claim",
        ("barrier",),
        "winslow",
    ),
    PrintedEquation(
        "winslow-degenerate",
        "Section 2.5, after the discrete functional",
        r"\text{approaches infinity when the cells degenerate, } |\boldsymbol{J}| \to 0",
        "claim",
        ("infinite where cells degenerate",),
        "winslow",
    ),
    PrintedEquation(
        "winslow-inner-nodes",
        "Section 2.5, discrete functional, summed over the n internal nodes",
        r"\sum_{k=1}^{n} \text{ has a barrier, thus, this functional produces unfolded grids}",
        "claim",
        ("unfolded by the sum over inner nodes",),
        "winslow",
    ),
    PrintedEquation(
        "winslow-unfolded",
        "Section 2.5, after the discrete functional",
        r"\text{thus, this functional produces unfolded grids}",
        "claim",
        ("unfolded",),
        "winslow",
    ),
    PrintedEquation(
        "frobenius-norm",
        "Section 2.5, text",
        r"g_{11} + g_{22}\ \text{is the Frobenius norm of the Jacobian matrix}",
        "equality",
        ("g11 + g22", "norm(A)"),
    ),
    PrintedEquation(
        "frobenius-norm-squared",
        "Section 2.5, displayed formula",
        r"g_{11} + g_{22} = \|\boldsymbol{J}\|^2",
        "equality",
        ("g11 + g22", "norm(A)**2"),
    ),
    PrintedEquation(
        "winslow-sum-2",
        "Section 2.5, second form of the functional",
        r"\mathcal{F} = \sum_k \sum_i \frac{\|\boldsymbol{J}(k_i)\|^2}{|\boldsymbol{J}(k_i)|}",
        "sum",
        ("norm(A)**2/det(A)",),
        "winslow",
    ),
    PrintedEquation(
        "norm-of-inverse",
        "Section 2.5, text",
        r"\|\boldsymbol{A}^{-1}\| = \frac{\|\boldsymbol{A}\|}{|\boldsymbol{A}|}",
        "equality",
        ("norm(inverse(A))", "norm(A)/det(A)"),
    ),
    PrintedEquation(
        "winslow-sum-3",
        "Section 2.5, third form of the functional, with K(A) = ||A|| ||A^-1||",
        r"\mathcal{F} = \sum_k \sum_i \mathsf{K}(\boldsymbol{J}(k_i))",
        "sum",
        ("norm(A)*norm(inverse(A))",),
        "winslow",
    ),
    PrintedEquation(
        "winslow-minimum",
        "Section 2.5, after the third form of the functional",
        r"\text{minimizing the functional is equivalent to minimizing } \mathsf{K}(\boldsymbol{J})",
        "claim",
        ("minimizes each corner",),
        "winslow",
    ),
    PrintedEquation(
        "condition-number",
        "Section 2.5, displayed formula",
        r"\mathsf{K} = \frac{\mathbf{g}_1^2 + \mathbf{g}_2^2}{|\mathbf{g}_1\times\mathbf{g}_2|}",
        "equality",
        ("norm(A)*norm(inverse(A))", "(dot(g1, g1) + dot(g2, g2))/abs(cross(g1, g2))"),
    ),
    PrintedEquation(
        "metric-matrix",
        "Section 2.5, displayed metric tensor",
        r"\boldsymbol{g} = \begin{bmatrix} g_{11} & g_{12} \\ g_{21} & g_{22} \end{bmatrix}",
        "equality",
        ("matrix(g11, g12, g21, g22)", "transpose(A)*A"),
    ),
    PrintedEquation(
        "eigenvalues",
        "Section 2.5, displayed formula with the eigenvalues of the metric tensor",
        r"\frac{g_{11} + g_{22}}{|\boldsymbol{J}|} = \frac{\lambda_1 + \lambda_2}{\sqrt{\lambda_1\lambda_2}}",
        "equality",
        ("(g11 + g22)/J", "(lambda_1 + lambda_2)/sqrt(lambda_1*lambda_2)"),
    ),
    PrintedEquation(
        "eigenvalue-bound",
        "Section 2.5, displayed formula with the eigenvalues of the metric tensor",
        r"\frac{\lambda_1 + \lambda_2}{\sqrt{\lambda_1\lambda_2}} \ge 2",
        "inequality",
        ("(lambda_1 + lambda_2)/sqrt(lambda_1*lambda_2)", "2.0"),
    ),
    PrintedEquation(
        "metric-determinant",
        "Section 2.5 and 2.7, text",
        r"|\boldsymbol{J}|^2 = |\boldsymbol{g}|",
        "equality",
        ("det(A)**2", "det(G)"),
    ),
    PrintedEquation(
        "winslow-bounded",
        "Section 2.5, last sentence",
        r"\text{thus, the Winslow functional is bounded from below}",
        "claim",
        ("bounded below",),
        "winslow",
    ),
)

_LIAO = (
    PrintedEquation(
        "liao-sum",
        "Section 2.6, discrete functional",
        r"\mathcal{F} = \sum_k \sum_i (g_{11}^2 + g_{22}^2 + 2\,g_{12}^2)",
        "sum",
        ("g11**2 + g22**2 + 2*g12**2",),
        "liao",
    ),
    PrintedEquation(
        "liao-folds",
        "Section 2.7, first sentence",
        r"\text{the Liao functional can produce folded grids}",
        "claim",
        ("no barrier",),
        "liao",
    ),
    PrintedEquation(
        "modified-liao-sum-1",
        "Section 2.7, discrete functional",
        r"\mathcal{F} = \sum_k \sum_i \left(\frac{g_{11}(k_i) + g_{22}(k_i)}{\sqrt{g(k_i)}}\right)^2",
        "sum",
        ("((g11 + g22)/sqrt(det(G)))**2",),
        "modified_liao",
    ),
    PrintedEquation(
        "modified-liao-barrier",
        "Section 2.7, text",
        r"\text{has a barrier}",
        "claim",
        ("barrier",),
        "modified_liao",
    ),
    PrintedEquation(
        "modified-liao-degenerate",
        "Section 2.7, text",
        r"\text{approaches infinity when the cells degenerate, } |\boldsymbol{J}| \to 0",
        "claim",
        ("infinite where cells degenerate",),
        "modified_liao",
    ),
    PrintedEquation(
        "modified-liao-unfolded",
        "Section 2.7, text",
        r"\text{thus, this functional produces unfolded grids}",
        "claim",
        ("unfolded",),
        "modified_liao",
    ),
    PrintedEquation(
        "modified-liao-sum-2",
        "Section 2.7, second form of the functional",
        r"\mathcal{F} = \sum_k \sum_i \mathsf{K}(\boldsymbol{J}(k_i))^2",
        "sum",
        ("(norm(A)*norm(inverse(A)))**2",),
        "modified_liao",
    ),
    PrintedEquation(
        "modified-liao-minimum",
        "Section 2.7, last sentence",
        r"\text{minimizes } \mathsf{K}(\boldsymbol{J})^2\text{, whereas Winslow minimizes } \mathsf{K}(\boldsymbol{J})",
        "claim",
        ("minimizes each corner",),
        "modified_liao",
    ),
)

_WEIGHTS = (
    PrintedEquation(
        "weight-1",
        "Section 3.1, first adaptive example",
        r"s(x,y) = 5 + 200\,|\sin(2\pi x)\sin(2\pi y)|",
        "weight",
        ("5.0 + 200.0*abs(sin(2*pi*x)*sin(2*pi*y))",),
        "area",
    ),
    PrintedEquation(
        "weight-2",
        "Section 3.1, second adaptive example",
        r"s(x,y) = 5 + 200\,[\sin(2\pi x)\sin(2\pi y)]",
        "weight",
        ("5.0 + 200.0*(sin(2*pi*x)*sin(2*pi*y))",),
        "area",
    ),
)

_EXAMPLES = (
    PrintedEquation(
        "transfinite-kinks",
        "Section 3.2, first paragraph",
        r"\text{boundary discontinuity can propagate inside the domain}",
        "interpolation",
        ("boundary discontinuity can propagate",),
    ),
)

#: Everything that the paper prints, in its order.
PRINTED: tuple[PrintedEquation, ...] = (
    *_GENERAL,
    *_tables(),
    *_AREA,
    *_LENGTH,
    *_ORTHOGONALITY,
    *_COMBINED,
    *_WINSLOW,
    *_LIAO,
    *_WEIGHTS,
    *_EXAMPLES,
)
