"""The Euler–Lagrange equations of several blocks: central differences, also across connections.

At a connected node where four cells meet, logical coordinates continue from block to block, and the node has the same
stencil as one inside a block. Elsewhere there are none: where three, five or more cells meet, where the logical steps
of blocks differ, or a density is given what another block knows by another name (xi, eta, components that turn). Such a
node has the equation of which the Euler–Lagrange equations are the limit: it makes the discrete energy of its cells
stationary.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ....arrays import Array
from ....functionals.metric import INVERSE_TARGET_NAMES, LOGICAL_NAMES, WEIGHT_NAME
from ....grids import corner_jacobians
from ....runtime import Values
from ....topology.copies import Indices
from ....topology.stencils import Corner, shared_stencils
from ...layout.problem import LayoutProblem
from ...layout.sparse import LayoutMatrix
from ...linear.factorization import factorize
from ..residual import keep_best
from .jacobian import LayoutJacobian
from .krylov import solve_by_gmres
from .node_values import NodeValues
from .patches import gather
from .sweeps import LayoutRelaxation

#: Planes that are the same, up to quarters, in blocks that lie turned to each other.
_TURN_WELL = {WEIGHT_NAME, *INVERSE_TARGET_NAMES}
#: The planes xx and yy of the Jacobian that couple a node with itself.
_DIAGONAL = [16, 19]
#: Logical steps that differ by this part are the same.
_ROUNDING = 1e-12
#: So many unknowns are factorized.
_FEW = 60_000


class LayoutEquations:
    """Residual and Jacobian as functions of one array with the coordinates of all blocks; see `System`.

    A residual is a vector of unknowns, two for each different free node, in the turn of its first copy.

    Attributes:
        problem: kernels and values on the blocks.
        best: of all grids (False) and of the valid ones (True): the residual's norm and the coordinates.
        others: how many connected nodes make the discrete energy stationary instead.
    """

    def __init__(self, problem: LayoutProblem, coordinates: Array) -> None:
        """Find the stencils, and how the equations of nodes without one are scaled, on a start."""
        self.problem = problem
        self.best: dict[bool, tuple[float, Array]] = {}
        exchange, copies = problem.exchange, problem.copies
        stencils = shared_stencils(copies, problem.bonds, exchange.shapes, problem.fixed, self._usable)
        self.others = len(stencils.others)
        self._patches = gather(problem, stencils, np.arange(len(stencils.node)), coordinates)
        self._rest = exchange.places[:, copies.starts[stencils.others]]
        self._energy = LayoutMatrix(copies, problem.fixed)
        self._jacobian = LayoutJacobian(copies, problem.fixed, stencils, [patches.chosen for patches in self._patches])
        self._stencils, self._values = stencils, NodeValues(problem, stencils)
        self._relaxation: LayoutRelaxation | None = None
        self._solver = problem.solver() if problem.kernels.backend == "c" else None
        self._scale = self._scales(coordinates, copies.starts[stencils.others])

    @property
    def barrier(self) -> bool:
        """Whether the energy is infinite where J = 0."""
        return self.problem.kernels.barrier

    @property
    def equation_type(self) -> str:
        """`elliptic`, or what the equations are instead."""
        return self.problem.kernels.equation_type

    def _usable(self, corners: Sequence[Corner]) -> bool:
        """Whether four corners of blocks have the same steps, and the same names for what a density is given."""
        names = set(self.problem.kernels.planes)
        if names & set(LOGICAL_NAMES):
            return False
        blocks = self.problem.blocks
        steps = np.array([blocks[one.block].steps[:: -1 if one.quarters % 2 else 1] for one in corners])
        same = bool(np.ptp(steps, axis=0).max() <= _ROUNDING * steps.max())
        return same and (names <= _TURN_WELL or not self.problem.exchange.turned)

    def residual(self, coordinates: Array) -> Array:
        """Return the residual, a vector of unknowns."""
        problem, field = self.problem, np.zeros(self.problem.exchange.size)
        planes, values = self._values.at(coordinates)
        blocks = (problem.blocks, problem.exchange.views(coordinates), values, problem.exchange.views(field))
        for block, place, given, out in zip(*blocks, strict=True):
            block.kernels.euler_lagrange_residual(place, given, block.steps, out=out)
        for patches in self._patches:
            field[patches.centers] = patches.residual(problem.kernels, coordinates, planes)
        if self.others:
            field[self._rest] = self._scale * problem.energy_gradient(coordinates)[2][self._rest]
        return self._energy.vector(field)

    def matrix(self, coordinates: Array) -> Any:  # noqa: ANN401 - scipy.sparse has no types
        """Return the Jacobian over the unknowns (CSC)."""
        from scipy import sparse

        problem = self.problem
        planes, values = self._values.at(coordinates)
        shared = [patches.jacobian(problem.kernels, coordinates, planes) for patches in self._patches]
        found = self._jacobian.assemble([*self._of_blocks(coordinates, values), *shared])
        if self.others:
            scale = np.zeros(problem.exchange.size)
            scale[self._rest] = self._scale
            found += sparse.diags(self._energy.vector(scale)) @ self._energy.assemble(problem.hessian(coordinates))
        return found.tocsc()

    def _of_blocks(self, coordinates: Array, values: Sequence[Values | None]) -> list[Array]:
        """Return the Jacobian's planes (36, ni, nj) of the nodes inside of each block."""
        problem = self.problem
        blocks = zip(problem.blocks, problem.exchange.views(coordinates), values, strict=True)
        return [block.kernels.euler_lagrange_jacobian(place, given, block.steps) for block, place, given in blocks]

    def _scales(self, coordinates: Array, first: Indices) -> Array:
        """Return what the gradient is multiplied by at nodes without a stencil, of which the first copies are given.

        The equation of such a node then depends on its position about as strongly as that of the next node inside of
        its first copy's block, with the same sign: the gradient tends to minus the residual.
        """
        if not self.others:
            return np.empty(0)
        problem, copies = self.problem, self.problem.copies
        planes = self._of_blocks(coordinates, self._values.at(coordinates)[1])
        diagonal = self._energy.assemble(problem.hessian(coordinates)).diagonal()
        own = np.zeros(problem.exchange.size)
        self._energy.spread(diagonal, own)
        curved = own[self._rest].sum(axis=0)
        scales = np.empty(self.others)
        for number, entry in enumerate(first.tolist()):
            block = int(copies.block[entry])
            ni, nj = problem.exchange.shapes[block]
            i, j = (min(max(int(one[entry]), 1), count - 2) for one, count in ((copies.i, ni), (copies.j, nj)))
            size = float(np.abs(planes[block][_DIAGONAL, i, j]).sum())
            scales[number] = -size / curved[number] if size > 0 < curved[number] < np.inf else -1.0
        return scales

    def norm(self, residual: Array) -> float:
        """Return the norm of a residual."""
        with np.errstate(over="ignore", invalid="ignore"):
            return float(np.sqrt(np.einsum("n,n->", residual, residual)))

    def round_off(self, coordinates: Array) -> float:
        """Return the norm below which a residual cannot be distinguished from zero."""
        rows = np.asarray(abs(self.matrix(coordinates)).sum(axis=1)).ravel()
        return 10 * float(np.finfo(float).eps) * float(np.abs(coordinates).max()) * self.norm(rows)

    def smallest(self, coordinates: Array) -> float:
        """Return the smallest Jacobian."""
        return min(float(corner_jacobians(*place).min()) for place in self.problem.exchange.views(coordinates))

    def refresh(self, coordinates: Array) -> None:
        """Evaluate what is held while the nodes move."""
        self.problem.refresh(coordinates)

    def direction(self, coordinates: Array, residual: Array) -> Array:
        """Return Newton's step; NaN where the Jacobian is singular."""
        matrix, problem = self.matrix(coordinates), self.problem
        if len(residual) > _FEW and self._solver is not None and self.equation_type == "elliptic":
            found = solve_by_gmres(matrix, -residual, coordinates, problem, self._energy, self._solver)
            if found is not None:
                return self.field(found)
        factors = factorize(matrix)
        return self.field(factors.solve(-residual)) if factors else np.full_like(coordinates, np.nan)

    def sweep(self, coordinates: Array, factor: float) -> None:
        """Relax all nodes once, in place."""
        if self._relaxation is None:
            self._relaxation = LayoutRelaxation(self.problem, self._stencils, self._values, coordinates)
        self._relaxation.sweep(coordinates, factor)

    @property
    def width(self) -> int:
        """About how many nodes lie along a line across the grid."""
        exchange = self.problem.exchange
        return max(max(map(max, exchange.shapes)), int((exchange.size / 2) ** 0.5))

    def linearized(self, coordinates: Array, residual: Array) -> tuple[Any, Array]:
        """Return the Jacobian as a sparse matrix, and the residual as a vector of unknowns."""
        return self.matrix(coordinates), residual

    def field(self, vector: Array) -> Array:
        """Return a vector of unknowns as a step of the coordinates."""
        field = np.zeros(self.problem.exchange.size)
        self._energy.spread(vector, field)
        return field

    def remember(self, coordinates: Array, norm: float) -> float:
        """Keep the grid if it is the best so far, or the best valid one; return its smallest Jacobian."""
        return keep_best(self.best, coordinates, norm, self.smallest(coordinates))
