"""Metrics of T = A W⁻¹, the Jacobian matrix relative to a target; of A itself where no target is given.

`t11`, `t22`, `t12`, `tau` are the metric of T and its determinant. A density that needs the components of T names
`x_xi`, `y_xi`, `x_eta`, `y_eta`, `g11` ... and `J` only: with a target all of these are then those of T.
"""

from __future__ import annotations

from .definition import Formula
from .metric import Metric
from .registry import literature

# ---- the target-matrix optimization paradigm: mu_k of the literature is tmop_k ----


@literature("dobrev2019")
def tmop_1(m: Metric) -> Formula:
    """Twice the length functional, relative to a target: |T|²; no barrier."""
    return m.t11 + m.t22


@literature("dobrev2019")
def tmop_2(m: Metric) -> Formula:
    """Shape, |T|²/(2 tau) - 1: zero for a rotated and scaled target; the inverse mean ratio minus 1."""
    return (m.t11 + m.t22) / (2 * m.tau) - 1


@literature("dobrev2019")
def tmop_7(m: Metric) -> Formula:
    """Shape and size, |T - T⁻ᵗ|²: zero for a rotated target; the symmetric Dirichlet energy minus 4."""
    return (m.t11 + m.t22) * (1 + 1 / m.tau**2) - 4


@literature("dobrev2019")
def tmop_9(m: Metric) -> Formula:
    """Shape and size, tau |T - T⁻ᵗ|²: zero for a rotated target."""
    return (m.t11 + m.t22) * (m.tau + 1 / m.tau) - 4 * m.tau


@literature("knupp2020")
def tmop_14(m: Metric) -> Formula:
    """Shape, size and orientation, |T - I|²: zero for the target as it stands; no barrier."""
    return (m.x_xi - 1) ** 2 + m.y_xi**2 + m.x_eta**2 + (m.y_eta - 1) ** 2


@literature("dobrev2019")
def tmop_50(m: Metric) -> Formula:
    """Shape, |TᵗT|²/(2 tau²) - 1: zero for a rotated and scaled target; Oddy's metric."""
    return (m.t11**2 + m.t22**2 + 2 * m.t12**2) / (2 * m.tau**2) - 1


@literature("dobrev2019")
def tmop_55(m: Metric) -> Formula:
    """Size, (tau - 1)²: zero for the target's area; no barrier, and nothing said of the shape."""
    return (m.tau - 1) ** 2


@literature("dobrev2019")
def tmop_56(m: Metric) -> Formula:
    """Size, ½ (√tau - 1/√tau)²: zero for the target's area; with a barrier."""
    return (m.tau + 1 / m.tau) / 2 - 1


@literature("dobrev2019")
def tmop_58(m: Metric) -> Formula:
    """Shape, |TᵗT|²/tau² - 2 |T|²/tau + 2: zero for a rotated and scaled target."""
    return (m.t11**2 + m.t22**2 + 2 * m.t12**2) / m.tau**2 - 2 * (m.t11 + m.t22) / m.tau + 2


@literature("dobrev2019")
def tmop_77(m: Metric) -> Formula:
    """Size, ½ (tau - 1/tau)²: zero for the target's area; with a barrier."""
    return (m.tau - 1 / m.tau) ** 2 / 2


@literature("dobrev2019", constraints=("0 <= gamma < 1",))
def tmop_80(m: Metric, gamma: float = 0.5) -> Formula:
    """Shape and size, (1 - gamma) mu_2 + gamma mu_77: zero for a rotated target."""
    return (1 - gamma) * ((m.t11 + m.t22) / (2 * m.tau) - 1) + gamma * (m.tau - 1 / m.tau) ** 2 / 2


@literature("knupp2020")
def tmop_85(m: Metric) -> Formula:
    """Shape and orientation, |T - |T| I/√2|²: zero for a scaled target; no barrier."""
    size = m.g11 + m.g22
    return 2 * size - (m.x_xi + m.y_eta) * m.sqrt(2 * size)


@literature("knupp2020")
def tmop_98(m: Metric) -> Formula:
    """Shape, size and orientation, |T - I|²/tau: zero for the target as it stands; with a barrier."""
    return (m.g11 + m.g22 - 2 * (m.x_xi + m.y_eta) + 2) / m.J


# ---- quality metrics as functionals ----


@literature("knupp2000", "knupp2001", constraints=("p >= 1",))
def knupp_shape(m: Metric, p: float = 2.0) -> Formula:
    """A power of half the condition number of T, the reciprocal of Knupp's shape metric: 1 for the target's shape."""
    return ((m.t11 + m.t22) / (2 * m.tau)) ** p


@literature("knupp2001", constraints=("p > 1",))
def knupp_size(m: Metric, p: float = 2.0) -> Formula:
    """A power of max(tau, 1/tau), the reciprocal of Knupp's relative size: 1 for the target's area."""
    return m.max(m.tau, 1 / m.tau) ** p


@literature("knupp2001")
def knupp_skew(m: Metric) -> Formula:
    """1/sin² of the angle between the edges, relative to the target: the reciprocal of Knupp's skew metric, squared."""
    return m.t11 * m.t22 / m.tau**2


@literature("knupp2020")
def knupp_orientation(m: Metric) -> Formula:
    """1 - cos of the angle by which T is turned, from its polar decomposition; nothing said of shape and size."""
    return 1 - (m.x_xi + m.y_eta) / m.sqrt(m.g11 + m.g22 + 2 * m.J)


# ---- deformations of an elastic body whose state of rest is the target ----


@literature("garanzha2000", constraints=("0 < theta < 1",))
def garanzha(m: Metric, theta: float = 0.8) -> Formula:
    """Garanzha's distortion measure: theta of shape, the rest of size; 1 for a rotated target."""
    return theta * (m.t11 + m.t22) / (2 * m.tau) + (1 - theta) * (m.tau + 1 / m.tau) / 2


@literature("jacquotte1988", constraints=("k > 0",))
def jacquotte(m: Metric, k: float = 1.0) -> Formula:
    """Jacquotte's mechanical model, of the invariants |T|² and tau: zero for a rotated target; no barrier."""
    return m.t11 + m.t22 - 2 * m.tau + k * (m.tau - 1) ** 2


@literature("persson2009", constraints=("mu > 0", "lame >= 0"))
def neo_hookean(m: Metric, mu: float = 1.0, lame: float = 1.0) -> Formula:
    """Compressible neo-Hookean material, with Lame's constants: zero for a rotated target; with a barrier."""
    return mu * ((m.t11 + m.t22) / 2 - 1 - m.log(m.tau)) + lame * m.log(m.tau) ** 2 / 2
