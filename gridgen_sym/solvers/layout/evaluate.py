"""The discrete functional of a grid of several blocks as numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array
from ...functionals.definition import Functional
from ...topology import MultiBlock
from .binding import make_layout_problem
from .sparse import LayoutMatrix


def layout_energy(grid: MultiBlock, functional: str | Functional, **given: Any) -> float:  # noqa: ANN401
    """Return the discrete energy, summed over all corners of all cells; see `gridgen_sym.energy`."""
    problem = make_layout_problem(grid, functional, **given)
    return problem.energy(problem.exchange.join([block.planes for block in grid.blocks]))[0]


def layout_gradient(grid: MultiBlock, functional: str | Functional, **given: Any) -> dict[str, Array]:  # noqa: ANN401
    """Return the gradient in the nodes' positions: for each block, by name, an array (ni, nj, 2).

    All copies of a node have the sum over the blocks, in their own turn. It is zero at fixed nodes.
    """
    problem = make_layout_problem(grid, functional, **given)
    found = problem.energy_gradient(problem.exchange.join([block.planes for block in grid.blocks]))[2]
    parts = (np.stack(tuple(planes), axis=-1) for planes in problem.exchange.views(found))
    return dict(zip(grid.names, parts, strict=True))


def layout_hessian(
    grid: MultiBlock,
    functional: str | Functional,
    *,
    semidefinite: bool = False,
    **given: Any,  # noqa: ANN401
) -> Any:  # noqa: ANN401 - scipy.sparse has no types
    """Return the Hessian over the different free nodes, as a SciPy sparse matrix (CSC).

    Connected nodes come first, in the order of `MultiBlock.copies`, in the turn of their first copy; then those of one
    block after the other.
    """
    problem = make_layout_problem(grid, functional, **given)
    coordinates = problem.exchange.join([block.planes for block in grid.blocks])
    planes = problem.hessian(coordinates, semidefinite=semidefinite)
    return LayoutMatrix(problem.copies, problem.fixed).assemble(planes)
