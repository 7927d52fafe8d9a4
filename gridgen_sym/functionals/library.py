"""The functionals of the paper (S. K. Khattri, *Grid Generation and Adaptation by Functionals*), each once.

Densities are those of the integrals; `corner_factor = 2` where the paper's discrete sum drops their ½.
"""

from __future__ import annotations

from typing import Any

from .definition import builtin
from .metric import Metric

_CONVEX_COMBINATION = ("k_A >= 0", "k_L >= 0", "k_O >= 0", "k_A + k_L + k_O == 1")


@builtin(corner_factor=2, reference="Section 2.1")
def area(m: Metric) -> Any:  # noqa: ANN401
    """Equal cell areas; with a weight, small cells where the weight is large."""
    return m.s * m.J**2 / 2


@builtin(corner_factor=2, reference="Section 2.2")
def length(m: Metric) -> Any:  # noqa: ANN401
    """Short grid lines; its Euler-Lagrange equations are Laplace's."""
    return (m.g11 + m.g22) / 2


@builtin(corner_factor=2, reference="Section 2.3")
def orthogonality(m: Metric) -> Any:  # noqa: ANN401
    """Grid lines at right angles."""
    return m.g12**2 / 2


@builtin(corner_factor=2, constraints=_CONVEX_COMBINATION, reference="Section 2.4")
def combined(m: Metric, k_A: float = 0.4, k_L: float = 0.2, k_O: float = 0.4) -> Any:  # noqa: ANN401
    """Convex combination of area (weighted), length and orthogonality."""
    return (k_A * m.s * m.J**2 + k_L * (m.g11 + m.g22) + k_O * m.g12**2) / 2


@builtin(corner_factor=2, reference="Section 2.4")
def knupp(m: Metric) -> Any:  # noqa: ANN401
    """Area-orthogonality, half of each: (J² + g12²)/4 = g11 g22/4."""
    return m.g11 * m.g22 / 4


@builtin(reference="Section 2.5")
def winslow(m: Metric) -> Any:  # noqa: ANN401
    """Frobenius condition number of the Jacobian matrix; infinite barrier at J = 0."""
    return (m.g11 + m.g22) / m.J


@builtin(reference="Section 2.6")
def liao(m: Metric) -> Any:  # noqa: ANN401
    """Squared Frobenius norm of the metric tensor; may fold."""
    return m.g11**2 + m.g22**2 + 2 * m.g12**2


@builtin(reference="Section 2.7")
def modified_liao(m: Metric) -> Any:  # noqa: ANN401
    """Square of the condition number; infinite barrier at J = 0."""
    return ((m.g11 + m.g22) / m.J) ** 2
