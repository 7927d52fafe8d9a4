"""Minimise a discrete functional: the public `optimize`, `untangle`, `energy`, `gradient` and `hessian`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..errors import GridgenError
from ..functionals.definition import Functional, functional
from ..grids import Grid
from ..runtime import Array
from .local import sweep_until_converged
from .nested import nested_start, worth_nesting
from .newton import minimize
from .problem import INTERRUPTED, Problem, check_controls, make_problem, norm_of, result_of
from .progress import Callback, Progress
from .result import Result
from .sparse import assemble_hessian
from .untangle import could_not_unfold, unfold
from .weight import Source, Weight

#: Iterations that a method is given where the caller does not say.
_NEWTON_STEPS, _SWEEPS = 200, 5000
_UNTANGLED = "The grid was folded at the start and was untangled first: "


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
        weight: the paper's adaptive function: formula, function, array or `Weight`. A density that does not name
            the weight is multiplied by it.
        fixed: (ni, nj) mask of inner nodes that do not move.
        parameters: of the functional.
        tolerance: factor by which the gradient's norm must fall.
        max_iterations: sweeps, or Newton steps, on the grid itself; steps of untangling and on coarser grids are
            not counted. With 0 there are none of either.
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
    if method not in ("newton", "local"):
        raise GridgenError(f"unknown method {method!r}: optimize takes 'newton' or 'local'")
    check_controls(tolerance, max_iterations, callback)
    definition = functional(name)

    def make(on: Grid, fixed: npt.ArrayLike | None = None) -> Problem:
        return make_problem(
            on,
            definition,
            weight=weight,
            fixed=fixed,
            parameters=parameters,
            interior_only=interior_only,
            backend=backend,
        )

    run = _Run(make(grid, fixed), definition, parameters, grid.planes.copy())
    interrupted = False
    with Progress(f"{definition.name}, {method}", callback, progress) as report:
        try:
            if method == "newton" and max_iterations != 0 and worth_nesting(run.problem, run.coordinates):
                run.take(nested_start(make, definition, run.coordinates, parameters, report))
            if not run.make_valid(report):
                message = could_not_unfold(run.coordinates, definition)
                return result_of(run.problem, run.coordinates, report, False, message)
            report.begin("minimize", grid.shape)
            if method == "newton":
                converged, message = minimize(
                    run.problem,
                    run.coordinates,
                    report,
                    max_iterations=_NEWTON_STEPS if max_iterations is None else max_iterations,
                    tolerance=tolerance,
                    keep_valid=keep_valid,
                    reference=run.reference,
                )
            else:
                converged, message = sweep_until_converged(
                    run.problem,
                    run.coordinates,
                    report,
                    max_iterations=_SWEEPS if max_iterations is None else max_iterations,
                    tolerance=tolerance,
                    keep_valid=keep_valid,
                )
        except KeyboardInterrupt:
            converged, interrupted, message = False, True, INTERRUPTED
    return result_of(run.problem, run.coordinates, report, converged, run.said + message, interrupted=interrupted)


@dataclass(slots=True)
class _Run:
    """The state of one `optimize`: the grid as it is now, and what must be said of how it came about.

    Attributes:
        reference: norm of the gradient at the start that was given, from which it must fall; None where that
            start was on the wrong side of the barrier.
    """

    problem: Problem
    functional: Functional
    parameters: Mapping[str, float] | None
    coordinates: Array
    reference: float | None = None
    said: str = ""

    def take(self, start: Array | None) -> None:
        """Take a better start, if it is one: valid where the given one is not, or else of lower energy."""
        energy, smallest, gradient = self.problem.energy_gradient(self.coordinates)
        if smallest > 0 or not self.problem.kernels.barrier:
            self.reference = norm_of(gradient)
        if start is None:
            return
        self.problem.refresh(start)
        new_energy, new_smallest = self.problem.energy(start)
        if (new_smallest > 0) > (smallest > 0) or (new_energy < energy and (new_smallest > 0) == (smallest > 0)):
            if self.problem.kernels.barrier and not smallest > 0:
                self.said = _UNTANGLED
            self.coordinates = start
        else:
            self.problem.refresh(self.coordinates)

    def make_valid(self, report: Progress) -> bool:
        """Untangle, where the functional has a barrier and the grid is folded; return whether that was possible."""
        if not self.problem.kernels.barrier or self.problem.energy(self.coordinates)[1] > 0:
            return True
        self.said = _UNTANGLED
        report.begin("untangle", self.problem.fixed.shape)
        if not unfold(self.problem, self.functional, self.coordinates, self.parameters, report):
            return False
        self.problem.refresh(self.coordinates)
        return True


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
    check_controls(0.5, None, callback)
    problem = make_problem(grid, definition, fixed=fixed, parameters=parameters, backend=backend)
    if not problem.kernels.barrier:
        raise GridgenError(f"untangling needs a functional with a barrier at J = 0, such as winslow; {name!r} has none")
    coordinates, interrupted = grid.planes.copy(), False
    with Progress(f"{definition.name}, untangle", callback, progress) as report:
        report.begin("untangle", grid.shape)
        try:
            valid = unfold(problem, definition, coordinates, parameters, report)
        except KeyboardInterrupt:
            valid, interrupted = bool(problem.energy(coordinates)[1] > 0), True
    message = "every corner's Jacobian is positive." if valid else could_not_unfold(coordinates, definition)
    message = INTERRUPTED if interrupted else message
    return result_of(problem, coordinates, report, valid, message, interrupted=interrupted)


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
