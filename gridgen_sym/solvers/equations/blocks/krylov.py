"""Linear systems of the equations on many nodes: GMRES, preconditioned by multigrid for the energy.

The gradient of the energy tends to minus the residual, but for how the equations are written: at each node by a factor
that is a matrix (2, 2). So the Hessian is, up to these, a preconditioner of the Jacobian, and multigrid solves with it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ....arrays import Array
from ...layout.problem import LayoutProblem
from ...layout.sparse import LayoutMatrix
from ...linear.solution import LinearSolver

#: Relative residual of GMRES, as of other linear solves of Newton's method. GMRES needs a preconditioner that is nearly
#: linear: that of conjugate gradients.
_FORCING, _LOOSE = 1e-3, 1e-2
#: Steps before a restart, and restarts, after which a factorization is tried.
_STEPS, _RESTARTS = 30, 2


def solve_by_gmres(
    matrix: Any,  # noqa: ANN401 - scipy.sparse has no types
    right: Array,
    coordinates: Array,
    problem: LayoutProblem,
    unknowns: LayoutMatrix,
    solver: LinearSolver,
) -> Array | None:
    """Return the solution, a vector of unknowns; None where it is not found.

    Args:
        matrix: the Jacobian over the unknowns.
        right: the right-hand side.
        coordinates: of all blocks.
        problem: whose Hessian preconditions.
        unknowns: takes vectors to fields and back.
        solver: of the problem's linear systems.
    """
    from scipy.sparse.linalg import LinearOperator, gmres

    hessian = problem.hessian(coordinates, semidefinite=True)
    if not solver.set_operator(hessian):
        return None
    with np.errstate(all="ignore"):
        factors = _own_blocks(unknowns.assemble(hessian)) @ _inverses(_own_blocks(matrix))
    if not np.isfinite(factors).all():
        return None

    def precondition(vector: Array) -> Array:
        field = np.zeros(problem.exchange.size)
        unknowns.spread((factors @ vector.reshape(-1, 2, 1)).ravel(), field)
        return unknowns.vector(problem.exchange.distributed(solver.solve(field, _LOOSE).vector))

    preconditioner = LinearOperator(matrix.shape, precondition)
    # The name of the relative tolerance differs between versions of SciPy.
    allowed = _FORCING * float(np.sqrt(np.einsum("n,n->", right, right)))
    found, left = gmres(matrix, right, M=preconditioner, atol=allowed, restart=_STEPS, maxiter=_RESTARTS)
    return np.asarray(found) if left == 0 and np.isfinite(found).all() else None


def _own_blocks(matrix: Any) -> Array:  # noqa: ANN401
    """Return the blocks (nodes, 2, 2) on the diagonal."""
    xx, yy = matrix.diagonal().reshape(-1, 2).T
    return np.stack((xx, matrix.diagonal(1)[::2], matrix.diagonal(-1)[::2], yy), axis=-1).reshape(-1, 2, 2)


def _inverses(blocks: Array) -> Array:
    """Return the inverses of blocks (nodes, 2, 2); not finite where there are none."""
    (a, b), (c, d) = blocks.transpose(1, 2, 0)
    return np.moveaxis(np.array(((d, -b), (-c, a))) / (a * d - b * c), -1, 0)
