"""Solve the Euler–Lagrange equations of a functional by central differences on the 9-point stencil.

Newton's method uses the generated Jacobian and a sparse direct factorisation; where the equations are not elliptic it
minimises the residual's norm with Levenberg's damping instead. Relaxation holds the coefficients of the second
derivatives while every node solves its own equations: for the Winslow functional this is what the literature calls the
Winslow or TTM solver. Logical coordinates have unit spacing, as the discrete functionals do; see `spacing`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ..errors import GridgenError
from ..functionals.definition import Functional, functional
from ..grids import Grid, corner_jacobians
from ..runtime import Array
from .newton import minimize
from .problem import Problem, check_controls, make_problem, result_of
from .progress import Callback, Progress
from .result import Result
from .sparse import assemble_jacobian, to_field, to_vector
from .untangle import could_not_unfold, unfold
from .weight import Source, Weight

_HALVINGS = 30
#: How near to the minimum a grid is brought that was folded at the start.
_NEAR, _STEPS_NEAR = 1e-2, 50
#: Levenberg's damping: where it begins and ends, over the mean diagonal of the normal equations.
_FIRST_DAMPING, _LARGEST_DAMPING = 1e-3, 1e12
#: How much the residual may grow before a relaxation is called divergent, and the weakest one that is tried.
_DIVERGENCE, _WEAKEST = 1e2, 0.05


@dataclass(slots=True)
class _Equations:
    """The discrete equations at the free nodes, and the best grids that an iteration has seen, by their residual.

    Attributes:
        best: of all, and of the valid ones: the residual's norm and the coordinates.
    """

    problem: Problem
    spacing: tuple[float, float]
    best: dict[bool, tuple[float, Array]] = field(default_factory=dict)

    def residual(self, coordinates: Array) -> Array:
        residual = self.problem.kernels.euler_lagrange_residual(
            coordinates, self.problem.weights(coordinates), self.spacing
        )
        residual[:, self.problem.fixed != 0] = 0.0
        return residual

    def jacobian_planes(self, coordinates: Array) -> Array:
        return self.problem.kernels.euler_lagrange_jacobian(
            coordinates, self.problem.weights(coordinates), self.spacing
        )

    def round_off(self, coordinates: Array) -> float:
        """Return the norm below which a residual cannot be told from zero."""
        rows = np.abs(self.jacobian_planes(coordinates)).sum(axis=0)[self.problem.fixed == 0]
        return float(10 * np.finfo(float).eps * np.abs(coordinates).max() * np.linalg.norm(rows))

    def remember(self, coordinates: Array, norm: float) -> float:
        """Keep the grid if it is the best so far, or the best valid one; return its smallest Jacobian."""
        smallest = float(corner_jacobians(coordinates[0], coordinates[1]).min())
        for valid in {False, smallest > 0}:
            if valid not in self.best or norm < self.best[valid][0]:
                self.best[valid] = norm, coordinates.copy()
        return smallest


def solve_euler_lagrange(
    grid: Grid,
    name: str | Functional,
    method: Literal["newton", "relaxation"] = "newton",
    *,
    weight: Weight | Source | None = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    tolerance: float = 1e-8,
    max_iterations: int | None = None,
    relaxation: float | None = None,
    spacing: tuple[float, float] = (1.0, 1.0),
    keep_valid: bool = False,
    callback: Callback | None = None,
    progress: bool | None = None,
    backend: str | None = None,
) -> Result:
    """Solve the Euler–Lagrange equations of a functional for the positions of the free nodes; the boundary stays.

    Args:
        grid: the start. Newton's method untangles a folded start of a barrier functional first.
        name: the functional.
        method: `newton`, or `relaxation` with frozen coefficients, node by node.
        weight: the paper's adaptive function: formula, function, array or `Weight`.
        fixed: (ni, nj) mask of inner nodes that do not move.
        parameters: of the functional.
        tolerance: factor by which the residual's norm must fall.
        max_iterations: Newton steps, or sweeps.
        relaxation: factor of a relaxation step; by default that which is best for Laplace's equation, and less
            where it diverges.
        spacing: of the logical coordinates; (1/(ni-1), 1/(nj-1)) for the unit square. It matters only where a
            functional is not homogeneous in each direction.
        keep_valid: return the best valid grid that the iteration has seen, and not a folded solution. By default
            the solution of the equations is returned, and the message says so where it is folded (Laplace's
            equations, for one, fold on many domains).
        callback: called with every `Step`; its `gradient_norm` is the residual's norm.
        progress: show progress on standard error; by default where that is a terminal.
        backend: `c` or `numpy`.

    Raises:
        GridgenError: for input that cannot be used.
    """
    if method not in ("newton", "relaxation"):
        raise GridgenError(f"unknown method {method!r}: solve_euler_lagrange takes 'newton' or 'relaxation'")
    check_controls(tolerance, max_iterations, callback)
    _check_numbers(spacing, relaxation)
    definition = functional(name)
    problem = make_problem(grid, definition, weight=weight, fixed=fixed, parameters=parameters, backend=backend)
    equations, coordinates = _Equations(problem, spacing), grid.planes.copy()
    with Progress(f"Euler–Lagrange equations of {definition.name}", callback, progress) as report:
        said = ""
        if method == "newton" and problem.kernels.barrier and corner_jacobians(*coordinates).min() <= 0:
            said = "The grid was folded at the start and was untangled first: "
            report.begin("untangle", grid.shape)
            if not unfold(problem, definition, coordinates, parameters, report):
                return result_of(problem, coordinates, report, False, could_not_unfold(coordinates, definition))
            # Just unfolded is far from a solution: the energy leads into its neighborhood, the residual's norm may not.
            problem.refresh(coordinates)
            minimize(problem, coordinates, report, tolerance=_NEAR, max_iterations=_STEPS_NEAR, keep_valid=True)
            problem.refresh(coordinates)
        report.begin("solve", grid.shape)
        if method == "relaxation":
            limit = 100_000 if max_iterations is None else max_iterations
            converged, message = _relax(equations, coordinates, report, tolerance, limit, relaxation)
        else:
            limit = 200 if max_iterations is None else max_iterations
            converged, message = _newton(equations, coordinates, report, tolerance, limit, keep_valid)
    return _finish(equations, coordinates, report, converged, said + message, keep_valid)


def _check_numbers(spacing: tuple[float, float], relaxation: float | None) -> None:
    """Refuse a spacing that is not two positive numbers, or a relaxation that must diverge."""
    given = np.asarray(spacing, dtype=object).ravel()
    numbers = [isinstance(value, (int, float, np.number)) and 0 < value < np.inf for value in given]
    if numbers != [True, True]:
        raise GridgenError(f"spacing must be two positive numbers, along xi and along eta; came {spacing!r}")
    if relaxation is not None and not (isinstance(relaxation, (int, float)) and 0 < relaxation < 2):
        raise GridgenError(f"expected a relaxation between 0 and 2; came {relaxation!r}")


def _finish(
    equations: _Equations, coordinates: Array, report: Progress, converged: bool, message: str, keep_valid: bool
) -> Result:
    """Choose the grid to return, and say what the type of the equations means for it."""
    folded = not float(corner_jacobians(coordinates[0], coordinates[1]).min()) > 0
    if converged and folded and keep_valid and True in equations.best:
        coordinates, converged = equations.best[True][1], False
        message += (
            " That solution is folded; this is the best valid grid on the way (keep_valid=False returns the solution)."
        )
    elif not converged and equations.best:
        coordinates = equations.best[True in equations.best][1]
        message += " This is the best valid grid on the way." if folded and True in equations.best else ""
    kind = equations.problem.kernels.equation_type
    if kind != "elliptic":
        message += f" The equations are not elliptic ({kind}), so a solution need not exist or be unique."
    equations.problem.refresh(coordinates)
    return result_of(equations.problem, coordinates, report, converged, message)


def _newton(
    equations: _Equations, coordinates: Array, report: Progress, tolerance: float, limit: int, keep_valid: bool
) -> tuple[bool, str]:
    """Newton's method with a line search on the residual's norm, or Levenberg's damping where not elliptic."""
    problem, damping = equations.problem, 0.0
    if problem.kernels.equation_type != "elliptic":
        damping = _FIRST_DAMPING
    residual = equations.residual(coordinates)
    norm = first = float(np.linalg.norm(residual))
    floor = equations.round_off(coordinates)
    for iteration in range(limit + 1):
        smallest = equations.remember(coordinates, norm)
        report.step(iteration, float("nan"), norm, smallest)
        if norm <= max(tolerance * first, floor):
            return True, f"the residual's norm has fallen to {norm:.2e}, {norm / (first or 1):.1e} of its first value."
        if iteration == limit:
            break
        matrix = assemble_jacobian(equations.jacobian_planes(coordinates), problem.fixed)
        guard = 0.1 * smallest if smallest > 0 and (problem.kernels.barrier or keep_valid) else -np.inf
        step, damping = _reduce(equations, matrix, coordinates, residual, damping, guard)
        if step is None:
            return (
                False,
                f"no step lowers the residual's norm further; it is {norm:.2e}, {norm / first:.1e} of its first.",
            )
        coordinates += step
        problem.refresh(coordinates)
        residual = equations.residual(coordinates)
        norm = float(np.linalg.norm(residual))
    return (
        False,
        f"{limit} steps have brought the residual's norm to {norm:.2e}, {norm / first:.1e} of its first value.",
    )


def _reduce(
    equations: _Equations,
    matrix: Any,  # noqa: ANN401
    coordinates: Array,
    residual: Array,
    damping: float,
    guard: float,
) -> tuple[Array | None, float]:
    """Return a step that lowers the residual's norm (None if there is none), and the damping for the next one."""
    norm, fixed = float(np.linalg.norm(residual)), equations.problem.fixed
    right = -to_vector(residual, fixed)
    if damping == 0.0:
        direction = to_field(_solve(matrix, right), fixed)
        for length in 0.5 ** np.arange(_HALVINGS):
            if _accepted(equations, coordinates + length * direction, (1 - 1e-4 * length) * norm, guard):
                return length * direction, 0.0
        damping = _FIRST_DAMPING
    normal, slope = (matrix.T @ matrix).tocsc(), matrix.T @ right
    size = normal.diagonal().mean()
    while damping < _LARGEST_DAMPING:
        from scipy.sparse import identity

        direction = to_field(_solve(normal + damping * size * identity(slope.size, format="csc"), slope), fixed)
        if _accepted(equations, coordinates + direction, (1 - 1e-6) * norm, guard):
            return direction, damping / 5
        damping *= 4
    return None, damping


def _accepted(equations: _Equations, trial: Array, norm: float, guard: float) -> bool:
    if not np.isfinite(trial).all() or not corner_jacobians(trial[0], trial[1]).min() > guard:
        return False
    return bool(np.linalg.norm(equations.residual(trial)) <= norm)


def _solve(matrix: Any, right: Array) -> Array:  # noqa: ANN401
    """Solve a sparse system; a singular one gives NaN, which no step accepts."""
    from scipy.sparse.linalg import splu

    try:
        solution: Array = splu(matrix).solve(right)
    except RuntimeError:
        return np.full_like(right, np.nan)
    return solution


def _relax(
    equations: _Equations, coordinates: Array, report: Progress, tolerance: float, limit: int, factor: float | None
) -> tuple[bool, str]:
    """Sweep over four colours of nodes with frozen coefficients; weaker where the residual grows."""
    problem = equations.problem
    _, ni, nj = coordinates.shape
    strength = factor or 2 / (1 + np.sin(np.pi / max(ni, nj)))
    norm = first = float(np.linalg.norm(equations.residual(coordinates)))
    safe, safe_norm, floor = coordinates.copy(), norm, equations.round_off(coordinates)
    for iteration in range(limit + 1):
        report.step(iteration, float("nan"), norm, equations.remember(coordinates, norm))
        if norm <= max(tolerance * first, floor):
            return True, (
                f"the residual's norm has fallen to {norm:.2e}, {norm / (first or 1):.1e} of its first value "
                f"(relaxation factor {strength:.3g})."
            )
        if iteration == limit:
            break
        if not norm < _DIVERGENCE * safe_norm:
            strength = 1 + (strength - 1) / 2 if strength > 1.05 else strength / 2
            if strength < _WEAKEST or factor is not None:
                coordinates[...] = safe
                return (
                    False,
                    f"the relaxation diverges; the best residual's norm was {safe_norm / first:.1e} of its first.",
                )
            coordinates[...] = safe
            problem.refresh(coordinates)
        elif norm < safe_norm:
            safe, safe_norm = coordinates.copy(), norm
        for colour in range(4):
            problem.kernels.euler_lagrange_relaxation(
                coordinates, problem.weights(coordinates), problem.fixed, colour, strength, equations.spacing
            )
        problem.refresh(coordinates)
        with np.errstate(all="ignore"):
            norm = float(np.linalg.norm(equations.residual(coordinates)))
    return False, (
        f"{limit} sweeps have brought the residual's norm to {norm:.2e}, {norm / first:.1e} of its first value: allow "
        "more with max_iterations, or use method='newton'."
    )
