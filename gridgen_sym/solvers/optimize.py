"""Minimise a discrete functional: the public `optimize`, `untangle`, `energy`, `gradient` and `hessian`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..errors import GridgenError
from ..functionals.definition import Functional, functional
from ..grids import Grid
from ..runtime import Array
from .local import sweep_until_converged
from .newton import minimize
from .problem import check_controls, make_problem, result_of
from .progress import Callback, Progress
from .result import Result
from .sparse import assemble_hessian
from .untangle import could_not_unfold, unfold
from .weight import Source, Weight

#: For each method: what runs it, and how many iterations it is given.
_METHODS = {"newton": (minimize, 200), "local": (sweep_until_converged, 5000)}


def optimize(
    grid: Grid,
    name: str | Functional,
    method: Literal["newton", "local"] = "newton",
    *,
    weight: Weight | Source | None = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    tolerance: float = 1e-6,
    max_iterations: int | None = None,
    keep_valid: bool = True,
    interior_only: bool = False,
    callback: Callback | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> Result:
    """Minimise a functional over the positions of the free nodes; the boundary stays.

    A folded start of a barrier functional is untangled first.

    Args:
        grid: the start, for example from `transfinite`.
        name: the functional.
        method: `newton` moves all nodes at once; `local` is the paper's method, one node at a time.
        weight: the paper's adaptive function: formula, function, array or `Weight`.
        fixed: (ni, nj) mask of inner nodes that do not move.
        parameters: of the functional.
        tolerance: factor by which the gradient's norm must fall.
        max_iterations: sweeps, or Newton steps.
        keep_valid: no step may make the smallest Jacobian of a valid grid non-positive. Barrier functionals
            never do.
        interior_only: sum over corners at inner nodes only (the paper's sums), not over all corners.
        callback: called with every `Step`.
        progress: show progress on standard error; by default where that is a terminal.
        backend: `c` or `numpy`.

    Returns:
        The result; see its `converged` and `message`.

    Raises:
        GridgenError: for input that cannot be used.
    """
    if method not in _METHODS:
        raise GridgenError(f"unknown method {method!r}: optimize takes 'newton' or 'local'")
    check_controls(tolerance, max_iterations)
    solve, default_iterations = _METHODS[method]
    definition = functional(name)
    problem = make_problem(
        grid,
        definition,
        weight=weight,
        fixed=fixed,
        parameters=parameters,
        interior_only=interior_only,
        backend=backend,
    )
    coordinates = grid.planes.copy()
    with Progress(f"{definition.name}, {method}", callback, progress) as report:
        said = ""
        if problem.kernels.barrier and problem.energy(coordinates)[1] <= 0:
            said = "The grid was folded at the start and was untangled first: "
            if not unfold(problem, definition, coordinates, parameters, report):
                return result_of(problem, coordinates, report, False, could_not_unfold(coordinates, definition))
            problem.refresh(coordinates)
        converged, message = solve(
            problem,
            coordinates,
            report,
            tolerance=tolerance,
            max_iterations=default_iterations if max_iterations is None else max_iterations,
            keep_valid=keep_valid,
        )
    return result_of(problem, coordinates, report, converged, said + message)


def untangle(
    grid: Grid,
    name: str | Functional = "winslow",
    *,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    callback: Callback | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> Result:
    """Make a folded grid valid, with the regularised barrier of a functional; a valid grid is returned as it is.

    Returns:
        The result; `converged` says whether every corner's Jacobian is positive.

    Raises:
        GridgenError: if the functional has no barrier, and for other input that cannot be used.
    """
    definition = functional(name)
    problem = make_problem(grid, definition, fixed=fixed, parameters=parameters, backend=backend)
    if not problem.kernels.barrier:
        raise GridgenError(f"untangling needs a functional with a barrier at J = 0, such as winslow; {name!r} has none")
    coordinates = grid.planes.copy()
    with Progress(f"{definition.name}, untangle", callback, progress) as report:
        valid = unfold(problem, definition, coordinates, parameters, report)
    message = "every corner's Jacobian is positive." if valid else could_not_unfold(coordinates, definition)
    return result_of(problem, coordinates, report, valid, message)


def energy(
    grid: Grid,
    name: str | Functional,
    *,
    weight: Weight | Source | None = None,
    parameters: Mapping[str, float] | None = None,
    interior_only: bool = False,
    backend: str | None = None,
) -> float:
    """Return the discrete energy, summed over all corners of all cells (or those at inner nodes only)."""
    problem = make_problem(
        grid, name, weight=weight, parameters=parameters, interior_only=interior_only, backend=backend
    )
    return problem.energy(grid.planes)[0]


def gradient(
    grid: Grid,
    name: str | Functional,
    *,
    weight: Weight | Source | None = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    interior_only: bool = False,
    backend: str | None = None,
) -> Array:
    """Return the gradient of the discrete energy in the nodes' positions, (ni, nj, 2), zero at fixed nodes."""
    problem = make_problem(
        grid, name, weight=weight, fixed=fixed, parameters=parameters, interior_only=interior_only, backend=backend
    )
    return np.stack(tuple(problem.energy_gradient(grid.planes)[2]), axis=-1)


def hessian(
    grid: Grid,
    name: str | Functional,
    *,
    weight: Weight | Source | None = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    semidefinite: bool = False,
    interior_only: bool = False,
    backend: str | None = None,
) -> Any:  # noqa: ANN401 - scipy.sparse has no types
    """Return the Hessian of the discrete energy over the free nodes, as a SciPy sparse matrix (CSC).

    Component c of the k-th free node (in the order of the array, eta running fastest) is unknown 2 k + c. With
    `semidefinite`, the positive semidefinite part that the derivation splits off.
    """
    problem = make_problem(
        grid, name, weight=weight, fixed=fixed, parameters=parameters, interior_only=interior_only, backend=backend
    )
    return assemble_hessian(problem.hessian(grid.planes, semidefinite=semidefinite), problem.fixed)
