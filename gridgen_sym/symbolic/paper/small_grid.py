"""A grid of 3 x 3 nodes with one unknown, its inner node: where the paper's words on sums are decided.

The paper's sums run over the four corners at the inner node. The other twelve, at boundary nodes, have no barrier then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy
from sympy import Expr

from ...arrays import Array
from ..coordinates import METRIC, J, x_eta, x_xi, y_eta, y_xi

#: The unit square with the middle node of its lower side moved inwards.
_BOUNDARY = {
    (0, 0): (0, 0), (0, 1): (0, sympy.Rational(1, 2)), (0, 2): (0, 1),
    (1, 0): (sympy.Rational(3, 20), sympy.Rational(1, 2)), (1, 2): (sympy.Rational(1, 2), 1),
    (2, 0): (1, 0), (2, 1): (1, sympy.Rational(1, 2)), (2, 2): (1, 1),
}  # fmt: skip
#: The place of the inner node.
UNKNOWNS = (_x, _y) = sympy.symbols("x_k y_k", real=True)
_NEWTON_STEPS, _HALVINGS = 60, 60
#: Places tried for the inner node along a side of the square; none is on a line between two boundary nodes.
_PLACES = 99

Edges = dict[Expr, Expr]


@dataclass(frozen=True, slots=True)
class Place:
    """A place of the inner node.

    Attributes:
        at: its coordinates.
        energy: the sum over the corners that were asked for.
        largest: the largest corner energy in that sum.
        smallest: the smallest Jacobian of all 16 corners.
    """

    at: tuple[float, float]
    energy: float
    largest: float
    smallest: float


class SmallGrid:
    """The sum of a corner energy over corners of the grid.

    Args:
        corner_energy: in the components of the edge vectors.
        inner_only: whether the sum runs over the four corners at the inner node, as in the paper, or over all 16.
    """

    def __init__(self, corner_energy: Expr, *, inner_only: bool) -> None:
        """Sum the energies of the corners."""
        corners = _corners()
        summed = [edges for node, edges in corners if node == (1, 1) or not inner_only]
        self._energies = [corner_energy.subs(edges, simultaneous=True) for edges in summed]
        self._inside = _function([METRIC[J].subs(edges) for edges in summed])
        self._everywhere = _function([METRIC[J].subs(edges) for _, edges in corners])
        #: The sum as an expression in the unknowns.
        self.energy: Expr = sum(self._energies, sympy.S.Zero)

    def minimum(self) -> Place:
        """Minimize the sum, from the best valid place of a raster, while its corners keep positive Jacobians."""
        start = self._raster[:, int(self._everywhere(self._raster).min(axis=0).argmax())]
        return self._place(_minimize(self.energy, start, lambda at: bool(self._inside(at).min() > 0)))

    def least_largest(self) -> Place:
        """Return the place of a raster at which the largest corner energy in the sum is smallest."""
        allowed = self._raster[:, self._inside(self._raster).min(axis=0) > 0]
        return self._place(allowed[:, int(self._values(allowed).max(axis=0).argmin())])

    @cached_property
    def _values(self) -> Callable[[Array], Array]:
        return _function(self._energies)

    @cached_property
    def _raster(self) -> Array:
        side = (np.arange(_PLACES) + 0.5) / _PLACES
        return np.stack(np.meshgrid(side, side, indexing="ij")).reshape(2, -1)

    def _place(self, at: Array) -> Place:
        values = self._values(at)
        smallest = float(self._everywhere(at).min())
        return Place((float(at[0]), float(at[1])), float(values.sum()), float(values.max()), smallest)


def _corners() -> list[tuple[tuple[int, int], Edges]]:
    """Return the node and the edge vectors of all 16 corners, each along increasing xi and eta."""
    nodes = {index: sympy.Matrix(place) for index, place in _BOUNDARY.items()} | {(1, 1): sympy.Matrix([_x, _y])}
    found = []
    for i, j in nodes:
        for a, b in ((i + da, j + db) for da in (-1, 1) for db in (-1, 1)):
            if (a, b) in nodes:
                first, second = (a - i) * (nodes[a, j] - nodes[i, j]), (b - j) * (nodes[i, b] - nodes[i, j])
                found.append(((i, j), dict(zip((x_xi, y_xi, x_eta, y_eta), [*first, *second], strict=True))))
    return found


def _function(expressions: list[Expr]) -> Callable[[Array], Array]:
    """Return the expressions, n of them, as a function of the inner node's place: (2,) -> (n,), (2, m) -> (n, m)."""
    function = sympy.lambdify(UNKNOWNS, expressions, "numpy")
    return lambda at: np.stack([np.broadcast_to(one, at.shape[1:]) for one in function(*at)])


def _minimize(energy: Expr, start: Array, allowed: Callable[[Array], bool]) -> Array:
    """Minimize by Newton's method with a line search, from an allowed place and through allowed ones."""
    slopes = [sympy.diff(energy, v) for v in UNKNOWNS]
    value = sympy.lambdify(UNKNOWNS, energy)
    gradient = sympy.lambdify(UNKNOWNS, slopes)
    hessian = sympy.lambdify(UNKNOWNS, [[sympy.diff(slope, v) for v in UNKNOWNS] for slope in slopes])
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
