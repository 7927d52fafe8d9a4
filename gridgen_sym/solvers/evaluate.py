"""The discrete functional of a grid as numbers: the public `energy`, `gradient` and `hessian`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.wall import Wall
from ..deprecation import renamed_arguments
from ..errors import GridgenError, quoted
from ..fields.target import Target
from ..fields.weight import Source, Weight
from ..functionals.definition import Functional
from ..functionals.registry import functional as find_functional
from ..grids import Grid
from ..grids.grid import check_grid
from .binding import make_problem
from .differentiability import missing_value
from .layout.dispatch import on_several_blocks
from .layout.evaluate import layout_energy, layout_gradient, layout_hessian
from .linear.sparse import assemble_hessian
from .logical import Spacing
from .problem import Problem


def _problem(grid: Grid, functional: str | Functional, **given: Any) -> Problem:  # noqa: ANN401
    """Bind a functional to a grid, all nodes of which must lie in the samples of what it is given."""
    problem = make_problem(grid, functional, **given)
    problem.check_samples(grid.planes)  # Of a folded grid, which binding does not look at.
    return problem


@on_several_blocks(layout_energy, without=("walls", "interior_only"))
@renamed_arguments(stacklevel=3, name="functional")
def energy(
    grid: Grid,
    functional: str | Functional,
    *,
    weight: Weight | Source | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | None = None,
    walls: Mapping[str, Wall] | None = None,
    parameters: Mapping[str, float] | None = None,
    interior_only: bool = False,
    spacing: Spacing = "unit",
    backend: str | None = None,
) -> float:
    """Return the discrete energy, summed over all corners of all cells (or those at inner nodes only).

    Edge vectors are divided by the logical steps h_xi and h_eta, and the sum is multiplied by h_xi h_eta: on the unit
    square (`spacing="unit"`) it tends to 4 `corner_factor` times the integral of the density as the grid is refined.
    With `spacing="index"` the steps are 1, as in the paper's sums. The other arguments are as in `optimize`, too.
    """
    problem = _problem(
        grid,
        functional,
        weight=weight,
        fields=fields,
        target=target,
        walls=walls,
        parameters=parameters,
        interior_only=interior_only,
        spacing=spacing,
        backend=backend,
    )
    found, smallest = problem.energy(grid.planes)
    if not np.isfinite(found) and smallest > 0:
        given = problem.corner_values(grid.planes)
        reason = missing_value(find_functional(functional), parameters, grid.planes, problem.steps, given)
        if reason:
            raise GridgenError(reason)
    return found


@on_several_blocks(layout_gradient, without=("walls", "interior_only", "out"))
@renamed_arguments(stacklevel=3, name="functional")
def gradient(
    grid: Grid,
    functional: str | Functional,
    *,
    weight: Weight | Source | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | None = None,
    walls: Mapping[str, Wall] | None = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    interior_only: bool = False,
    spacing: Spacing = "unit",
    backend: str | None = None,
    out: Array | None = None,
) -> Array:
    """Return the gradient of the discrete energy (see `energy`) in the nodes' positions.

    An array (ni, nj, 2), zero at fixed nodes. With `out`, an array of that shape of float64, it is written there, and
    `out` is returned: for many calls, as no memory is new.

    Raises:
        GridgenError: as for `optimize`, and for another `out`.
    """
    _check_out(out, grid)
    problem = _problem(
        grid,
        functional,
        weight=weight,
        fields=fields,
        target=target,
        walls=walls,
        fixed=fixed,
        parameters=parameters,
        interior_only=interior_only,
        spacing=spacing,
        backend=backend,
    )
    return np.stack(tuple(problem.energy_gradient(grid.planes)[2]), axis=-1, out=out)


def _check_out(out: object, grid: Grid) -> None:
    """Refuse what a gradient cannot be written to."""
    if out is None:
        return
    check_grid(grid)
    if not (isinstance(out, np.ndarray) and out.dtype == np.float64 and out.shape == (*grid.shape, 2)):
        came = f"{out.dtype}, shape {out.shape}" if isinstance(out, np.ndarray) else quoted(out)
        raise GridgenError(f"out must be an array of float64 of the shape {(*grid.shape, 2)}; came {came}")
    if not out.flags.writeable:
        raise GridgenError("out must be an array that can be written to; came a read-only one")


@on_several_blocks(layout_hessian, without=("walls", "interior_only"))
@renamed_arguments(stacklevel=3, name="functional")
def hessian(
    grid: Grid,
    functional: str | Functional,
    *,
    weight: Weight | Source | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | None = None,
    walls: Mapping[str, Wall] | None = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    semidefinite: bool = False,
    interior_only: bool = False,
    spacing: Spacing = "unit",
    backend: str | None = None,
) -> Any:  # noqa: ANN401 - scipy.sparse has no types
    """Return the Hessian of the discrete energy over the free nodes, as a SciPy sparse matrix (CSC).

    Component c of the k-th free node (in the order of the array, eta running fastest) is unknown 2 k + c. With
    `semidefinite`, the positive semidefinite part that the derivation splits off. See `energy` for the rest.
    """
    problem = _problem(
        grid,
        functional,
        weight=weight,
        fields=fields,
        target=target,
        walls=walls,
        fixed=fixed,
        parameters=parameters,
        interior_only=interior_only,
        spacing=spacing,
        backend=backend,
    )
    planes = problem.hessian(grid.planes, semidefinite=semidefinite)
    return assemble_hessian(planes, problem.fixed, compiled=problem.kernels.backend == "c")
