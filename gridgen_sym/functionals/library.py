"""The functionals of the paper (S. K. Khattri, *Grid Generation and Adaptation by Functionals*), each once.

Densities are those of the integrals; `corner_factor = 2` where the paper's discrete sum drops their ½.
"""

from __future__ import annotations

from typing import Any

from .metric import Metric
from .registry import builtin

_CONVEX_COMBINATION = ("k_A >= 0", "k_L >= 0", "k_O >= 0", "k_A + k_L + k_O == 1")


@builtin(
    corner_factor=2,
    reference="Section 2.1",
    use_when=(
        "Where areas matter: with a weight it makes cells small where the weight is large, and `s J` even all"
        " over the grid. It is also the part of `combined` that keeps areas apart from zero."
    ),
    avoid_when=(
        "alone where the shape of the lines matters. Areas do not say how lines run: they may swirl or kink, "
        "and another start gives another grid of the same energy."
    ),
)
def area(m: Metric) -> Any:  # noqa: ANN401
    """Equal cell areas; with a weight, small cells where the weight is large."""
    return m.s * m.J**2 / 2


@builtin(
    corner_factor=2,
    reference="Section 2.2",
    use_when="On convex domains, or as the fastest start for another functional: one linear system, solved once.",
    avoid_when="on domains with re-entrant boundaries. Its lines leave the domain there, and cells fold.",
)
def length(m: Metric) -> Any:  # noqa: ANN401
    """Short grid lines; its Euler-Lagrange equations are Laplace's."""
    return (m.g11 + m.g22) / 2


@builtin(
    corner_factor=2,
    reference="Section 2.3",
    use_when="As a part of `combined`, where lines should meet at right angles.",
    avoid_when="alone. Lines crowd, cells fold, and there is no single minimum.",
)
def orthogonality(m: Metric) -> Any:  # noqa: ANN401
    """Grid lines at right angles."""
    return m.g12**2 / 2


@builtin(
    corner_factor=2,
    constraints=_CONVEX_COMBINATION,
    reference="Section 2.4",
    use_when="To weigh areas, lengths and angles against each other when you know the domain and look at the result.",
    avoid_when=(
        "where a valid grid must come out without a look: the lengths pull cells over re-entrant boundaries "
        "as `length` does."
    ),
)
def combined(m: Metric, k_A: float = 0.4, k_L: float = 0.2, k_O: float = 0.4) -> Any:  # noqa: ANN401
    """Convex combination of area (weighted), length and orthogonality."""
    return (k_A * m.s * m.J**2 + k_L * (m.g11 + m.g22) + k_O * m.g12**2) / 2


@builtin(
    corner_factor=2,
    reference="Section 2.4",
    use_when=(
        "For nearly orthogonal cells of even area on moderately curved domains. It often unfolds a folded "
        "start, though nothing forces it to."
    ),
    avoid_when="where a fold would be a disaster, on very long cells, and on large grids: its Newton steps are many.",
)
def knupp(m: Metric) -> Any:  # noqa: ANN401
    """Area-orthogonality, half of each: (J² + g12²)/4 = g11 g22/4."""
    return m.g11 * m.g22 / 4


@builtin(
    reference="Section 2.5",
    use_when=(
        "First, on any domain: smooth grids, valid wherever a valid grid exists that it can be untangled to. "
        "Its equations are the classical Winslow equations."
    ),
    avoid_when=(
        "where cells should keep to a size, or crowd at a wall: it makes cells small where the boundary "
        "bulges into the domain and large in its hollows. Take area_winslow with a weight there."
    ),
)
def winslow(m: Metric) -> Any:  # noqa: ANN401
    """Frobenius condition number of the Jacobian matrix; infinite barrier at J = 0."""
    return (m.g11 + m.g22) / m.J


@builtin(
    reference="Section 2.6",
    use_when="To compare with the literature, on convex domains.",
    avoid_when=(
        "on anything else. Its fourth powers pull hard on long edges, and nothing keeps cells from folding: "
        "`modified_liao` does it better."
    ),
)
def liao(m: Metric) -> Any:  # noqa: ANN401
    """Squared Frobenius norm of the metric tensor; may fold."""
    return m.g11**2 + m.g22**2 + 2 * m.g12**2


@builtin(
    reference="Section 2.7",
    use_when=(
        "Where `winslow` leaves a few badly shaped cells: the square punishes the worst ones more, at about "
        "the same cost."
    ),
    avoid_when="where only smoothness counts: `winslow` has the simpler equations.",
)
def modified_liao(m: Metric) -> Any:  # noqa: ANN401
    """Square of the condition number; infinite barrier at J = 0."""
    return ((m.g11 + m.g22) / m.J) ** 2
