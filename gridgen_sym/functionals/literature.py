"""Functionals of the literature of grid generation and adaptation, each once, with its source.

Those that are metrics of a target are in `target_metrics`. Kernels are derived when they are first used.
"""

from __future__ import annotations

from .definition import Formula
from .metric import Metric
from .registry import literature

#: Energy of a corner beyond a barrier that is not at J = 0: no line search accepts it, and a sum of many is finite.
_BEYOND = 10**30

# ---- smoothness, areas and angles in combination ----


@literature("brackbill1982", constraints=("k_A >= 0", "k_O >= 0"))
def brackbill_saltzman(m: Metric, k_A: float = 1.0, k_O: float = 1.0) -> Formula:
    """Smoothness (`winslow`) with weighted volume and orthogonality, as Brackbill and Saltzman combine them."""
    return (m.g11 + m.g22) / m.J + k_A * m.s * m.J**2 + k_O * m.g12**2


@literature("knupp2001", constraints=("k > 0",))
def near_orthogonal(m: Metric, k: float = 0.003) -> Formula:
    """Right angles with a barrier, whatever the aspect ratio: 1/sin - 1, and a share k of what makes cells square."""
    # 1/sin = sqrt(g11 g22)/J says nothing of lengths: alone it has many minima. (K/2)² = (g11 + g22)²/(2J)² is 1/sin²
    # + ((g11 - g22)/(2J))²: so k = 1 is K/2 - 1, winslow, whose second part is weighed down here. Squares of all this
    # would count cells too much that turns of the boundary hold far from right angles.
    return m.sqrt(m.g11 * m.g22 + k * (m.g11 - m.g22) ** 2 / 4) / m.J - 1


@literature("brackbill1993", constraints=("k >= 0",), fields={"B": "vector"})
def brackbill_direction(m: Metric, k: float = 1.0) -> Formula:
    """Directional control: `winslow` with lines of constant xi along the vector field B."""
    return (m.g11 + m.g22 + k * (m.B1 * m.y_eta - m.B2 * m.x_eta) ** 2) / m.J


@literature(
    "steinberg1986",
    "castillo1988",
    constraints=("k_L >= 0", "k_A >= 0", "k_O >= 0", "phi > 0", "psi > 0"),
    fields={"phi": "scalar", "psi": "scalar"},
)
def steinberg_roache(m: Metric, k_L: float = 0.5, k_A: float = 0.5, k_O: float = 0.1) -> Formula:
    """Lengths proportional to phi along xi and to psi along eta, areas to phi psi, and right angles; no barrier."""
    length = m.g11 / m.phi + m.g22 / m.psi
    return (k_L * length + k_A * m.J**2 / (m.phi * m.psi) + k_O * m.g12**2) / 2


@literature("thomas1980", constraints=("p > 0", "q > 0"), fields={"p": "scalar", "q": "scalar"})
def thomas_middlecoff(m: Metric) -> Formula:
    """Winslow's functional of a grid stretched by p(xi) and q(eta): Thomas and Middlecoff's control functions."""
    return (m.g11 * m.q**2 + m.g22 * m.p**2) / m.J


@literature("knupp2002", fields={"B": "matrix"})
def reference_jacobian(m: Metric) -> Formula:
    """Jacobian matrices close to those of a reference grid, B, as it stands; with a barrier."""
    distance = (m.x_xi - m.B11) ** 2 + (m.x_eta - m.B12) ** 2 + (m.y_xi - m.B21) ** 2 + (m.y_eta - m.B22) ** 2
    return distance * m.abs(m.B11 * m.B22 - m.B12 * m.B21) / m.J


# ---- monitors ----


@literature("winslow1981")
def winslow_diffusion(m: Metric) -> Formula:
    """Winslow's variable diffusion: small cells where the weight is large; with a barrier."""
    return (m.g11 + m.g22) / (m.s * m.J)


@literature("cao1999", fields={"M": "symmetric"})
def winslow_tensor(m: Metric) -> Formula:
    """Winslow's functional with a tensor monitor M: div(M⁻¹ grad xi) = 0, and the same for eta."""
    return _trace(m) / (_determinant(m) * m.J)


@literature("dvinsky1991", fields={"M": "symmetric"})
def dvinsky(m: Metric) -> Formula:
    """Harmonic map from the domain with the Riemannian metric M: Dvinsky's functional."""
    return _trace(m) / (m.sqrt(_determinant(m)) * m.J)


@literature("ivanenko1993", "charakhchyan1997", fields={"f": "vector"})
def harmonic_surface(m: Metric) -> Formula:
    """Harmonic map from a surface z(x, y) over the domain, with f the gradient of z: dense where z is steep."""
    steepness = m.f1**2 + m.f2**2
    along_xi, along_eta = m.f1 * m.x_xi + m.f2 * m.y_xi, m.f1 * m.x_eta + m.f2 * m.y_eta
    return (m.g11 + m.g22 + along_xi**2 + along_eta**2) / (m.sqrt(1 + steepness) * m.J)


@literature("huang2001", constraints=("0 < theta <= 0.5",), fields={"M": "symmetric"})
def huang(m: Metric, theta: float = 1 / 3) -> Formula:
    """Huang's functional with gamma = 2: cells of one size and shape in M, by equidistribution and alignment."""
    size = m.sqrt(_determinant(m)) * m.J
    return theta * _trace(m) ** 2 / size**3 + 4 * (1 - 2 * theta) / size


@literature("eells1964", fields={"M": "symmetric"})
def riemannian_length(m: Metric) -> Formula:
    """Energy of the map from the logical square to the domain with the Riemannian metric M; no barrier."""
    return _trace(m) / 2


@literature("steinberg1986", fields={"S": "scalar"})
def area_at_corners(m: Metric) -> Formula:
    """The area functional with a weight S of its own at every corner of every cell, s(k_i); no barrier."""
    return m.S * m.J**2 / 2


# ---- the area functionals of UNAM: alpha = J and lambda = g11 + g22 of a corner ----


@literature("barrera2009", constraints=("omega >= 0",))
def unam_area(m: Metric, omega: float = 0.01) -> Formula:
    """S_omega: 1/(omega + alpha), convex in areas; its barrier is at J = -omega."""
    return m.where(-omega < m.J, 1 / (omega + m.J), _BEYOND)


@literature("barrera2009harmonic", constraints=("omega >= 0",))
def quasi_harmonic(m: Metric, omega: float = 0.01) -> Formula:
    """(lambda - 2 alpha)/(omega + alpha): `winslow` minus 2 at omega = 0; else its barrier is at J = -omega."""
    return m.where(-omega < m.J, (m.g11 + m.g22 - 2 * m.J) / (omega + m.J), _BEYOND)


@literature("barrera2009", constraints=("eps > 0",))
def epsilon_area(m: Metric, eps: float = 0.1) -> Formula:
    """max(0, eps - alpha)²: zero where all areas are at least eps; no barrier, and no single minimum."""
    return m.max(0, eps - m.J) ** 2


@literature("tinoco1999", constraints=("k_A > 0",))
def bilateral_area(m: Metric, k_A: float = 1.0) -> Formula:
    """1/alpha + k_A alpha²: neither small nor large areas, and nothing said of the shape."""
    return 1 / m.J + k_A * m.J**2


def _trace(m: Metric) -> Formula:
    """Return r_xiᵗ M r_xi + r_etaᵗ M r_eta."""
    return (
        m.M11 * (m.x_xi**2 + m.x_eta**2)
        + 2 * m.M12 * (m.x_xi * m.y_xi + m.x_eta * m.y_eta)
        + m.M22 * (m.y_xi**2 + m.y_eta**2)
    )


def _determinant(m: Metric) -> Formula:
    return m.M11 * m.M22 - m.M12**2
