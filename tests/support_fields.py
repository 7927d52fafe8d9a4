"""What the tests of fields and targets share: functionals of fields, and corner sums written out in NumPy."""

from __future__ import annotations

import numpy as np

import gridgen_sym as gg
from gridgen_sym.functionals import Functional

DVINSKY = Functional(
    "mapped",
    "(M11*(x_xi**2 + x_eta**2) + 2*M12*(x_xi*y_xi + x_eta*y_eta) + M22*(y_xi**2 + y_eta**2))"
    "/(sqrt(M11*M22 - M12**2)*J)",
    fields={"M": "symmetric"},
)
#: Thomas and Middlecoff's control functions: the grid of a rectangle is x = X(xi), y = Y(eta) with p = X', q = Y'.
CONTROLLED = Functional(
    "spread", "(g11*q**2 + g22*p**2)/J", fields={"p": "scalar", "q": "scalar"}, constraints=("p > 0", "q > 1e-3")
)
#: Names every place, and the metric of a target beside the true one.
PLACED = Functional("placed", "((1 + x**2)*g11 + (1 + xi*eta)*g22 + t11 + y*t22)/J")

#: Where the corners of a cell are, in the order of `corner_jacobians`.
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


def corner_matrices(grid: gg.Grid) -> np.ndarray:
    """Return the matrix of every corner, (2, 2, 4, ni-1, nj-1), whose columns are its edge vectors along xi and eta."""
    x = grid.planes
    along_xi, along_eta = x[:, 1:] - x[:, :-1], x[:, :, 1:] - x[:, :, :-1]
    cells = tuple(count - 1 for count in grid.shape)
    matrices = np.empty((2, 2, 4, *cells))
    for k, (a, b) in enumerate(CORNERS):
        matrices[:, 0, k] = along_xi[:, :, b : b + cells[1]]
        matrices[:, 1, k] = along_eta[:, a : a + cells[0]]
    return matrices


def map_matrices(grid: gg.Grid) -> np.ndarray:
    """Return the same of the map of the unit square: edge vectors over the steps 1/(ni-1) and 1/(nj-1)."""
    return corner_matrices(grid) * (np.array(grid.shape) - 1).reshape(1, 2, 1, 1, 1)


def sum_over_corners(grid: gg.Grid, *functional: object, **options: object) -> float:
    """Return the sum of the energies of all corners, which are those of the map of the unit square."""
    return gg.energy(grid, *functional, **options) * (grid.shape[0] - 1) * (grid.shape[1] - 1)


def at_corners(nodal: np.ndarray) -> np.ndarray:
    """Return nodal values (ni, nj) at the corners, (4, ni-1, nj-1)."""
    ni, nj = nodal.shape
    return np.stack([nodal[a : a + ni - 1, b : b + nj - 1] for a, b in CORNERS])


def relative(matrices: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Return T = A W⁻¹ of matrices in the first two axes."""
    inverse = np.linalg.inv(np.moveaxis(target, (0, 1), (-2, -1)))
    return np.moveaxis(np.moveaxis(matrices, (0, 1), (-2, -1)) @ inverse, (-2, -1), (0, 1))


def metric(matrices: np.ndarray) -> dict[str, np.ndarray]:
    """Return g11, g22, g12, J and the components of matrices in the first two axes."""
    (a, c), (b, d) = matrices
    named = {"x_xi": a, "y_xi": b, "x_eta": c, "y_eta": d}
    return named | {"g11": a * a + b * b, "g22": c * c + d * d, "g12": a * c + b * d, "J": a * d - b * c}


def logical(shape: tuple[int, int]) -> list[np.ndarray]:
    """Return xi and eta at the nodes."""
    return np.meshgrid(*(np.linspace(0, 1, count) for count in shape), indexing="ij")
