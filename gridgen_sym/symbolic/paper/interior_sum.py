"""What the paper's sum over inner nodes leaves unguarded: a grid of 3 x 3 nodes on which its minimum has a fold.

The sum runs over the corners at inner nodes. Corners at boundary nodes have no barrier then, so that the minimum may be
folded there although valid grids exist.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy
from sympy import Expr

from ...arrays import Array
from ..coordinates import x_eta, x_xi, y_eta, y_xi

#: The unit square with the middle node of its lower side moved inwards; `None` is the inner node.
_BOUNDARY = {
    (0, 0): (0, 0), (0, 1): (0, sympy.Rational(1, 2)), (0, 2): (0, 1),
    (1, 0): (sympy.Rational(3, 20), sympy.Rational(1, 2)), (1, 2): (sympy.Rational(1, 2), 1),
    (2, 0): (1, 0), (2, 1): (1, sympy.Rational(1, 2)), (2, 2): (1, 1),
}  # fmt: skip
_x, _y = sympy.symbols("x_k y_k", real=True)
_NEWTON_STEPS, _HALVINGS = 60, 60
#: Places tried for the inner node along a side of the square.
_PLACES = 100


@dataclass(frozen=True, slots=True)
class InnerMinimum:
    """The minimum of the sum over the corners at the inner node, and a valid grid with the same boundary nodes.

    Attributes:
        place: of the inner node.
        energy: the sum.
        smallest: the smallest Jacobian of all corners, those at boundary nodes included.
        valid_place: a place of the inner node.
        valid_smallest: the smallest Jacobian of all corners there.
    """

    place: tuple[float, float]
    energy: float
    smallest: float
    valid_place: tuple[float, float]
    valid_smallest: float


def inner_minimum(corner_energy: Expr) -> InnerMinimum:
    """Minimize the sum over the corners at the inner node, from the best valid grid of a raster.

    Args:
        corner_energy: in the components of the edge vectors.
    """
    corners = list(_corners())
    summed = [edges for node, edges in corners if node == (1, 1)]
    energy = sum((corner_energy.subs(edges, simultaneous=True) for edges in summed), sympy.S.Zero)
    inside, everywhere = (_smallest(group) for group in (summed, [edges for _, edges in corners]))
    raster = np.stack(np.meshgrid(*(np.arange(1, _PLACES) / _PLACES,) * 2, indexing="ij")).reshape(2, -1)
    lowest = everywhere(raster)
    valid = raster[:, int(lowest.argmax())]
    place = _minimize(energy, valid, lambda at: bool(inside(at) > 0))
    return InnerMinimum(
        (float(place[0]), float(place[1])),
        float(energy.subs({_x: place[0], _y: place[1]})),
        float(everywhere(place)),
        (float(valid[0]), float(valid[1])),
        float(lowest.max()),
    )


def _corners() -> list[tuple[tuple[int, int], dict[Expr, Expr]]]:
    """Return the node and the edge vectors of all 16 corners, each along increasing xi and eta."""
    nodes = {index: sympy.Matrix(place) for index, place in _BOUNDARY.items()} | {(1, 1): sympy.Matrix([_x, _y])}
    found = []
    for i, j in nodes:
        for a, b in ((i + da, j + db) for da in (-1, 1) for db in (-1, 1)):
            if (a, b) in nodes:
                first, second = (a - i) * (nodes[a, j] - nodes[i, j]), (b - j) * (nodes[i, b] - nodes[i, j])
                found.append(((i, j), dict(zip((x_xi, y_xi, x_eta, y_eta), [*first, *second], strict=True))))
    return found


def _smallest(corners: list[dict[Expr, Expr]]) -> Callable[[Array], Array]:
    """Return the smallest Jacobian of corners as a function of the inner node's place, (2,) or (2, n)."""
    jacobians = [edges[x_xi] * edges[y_eta] - edges[x_eta] * edges[y_xi] for edges in corners]
    function = sympy.lambdify((_x, _y), jacobians, "numpy")
    return lambda at: np.min([np.broadcast_to(one, at.shape[1:]) for one in function(*at)], axis=0)


def _minimize(energy: Expr, start: Array, allowed: Callable[[Array], bool]) -> Array:
    """Minimize by Newton's method with a line search, from an allowed place and through allowed ones."""
    unknowns = (_x, _y)
    slopes = [sympy.diff(energy, v) for v in unknowns]
    value = sympy.lambdify(unknowns, energy)
    gradient = sympy.lambdify(unknowns, slopes)
    hessian = sympy.lambdify(unknowns, [[sympy.diff(slope, v) for v in unknowns] for slope in slopes])
    place = start.copy()
    for _ in range(_NEWTON_STEPS):
        slope, curvature = np.array(gradient(*place)), np.array(hessian(*place))
        eigenvalues, vectors = np.linalg.eigh(curvature)
        step = -vectors @ ((vectors.T @ slope) / np.abs(eigenvalues))
        for length in 0.5 ** np.arange(_HALVINGS):
            trial = place + length * step
            if allowed(trial) and value(*trial) < value(*place):
                place = trial
                break
        else:
            break
    return place
