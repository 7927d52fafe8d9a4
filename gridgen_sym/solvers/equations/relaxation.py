"""The textbook method for the Euler–Lagrange equations: node by node, with frozen coefficients, over-relaxed."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ..convergence import converged
from ..norms import norm_of
from ..run.progress import Progress
from ..run.status import Outcome, Status
from .residual import Equations

#: How much the residual may grow before a relaxation is called divergent, and the weakest one that is tried.
_DIVERGENCE, _WEAKEST = 1e2, 0.05


def solve_by_relaxation(
    equations: Equations, coordinates: Array, report: Progress, tolerance: float, limit: int, factor: float | None
) -> Outcome:
    """Sweep over four colors of nodes with frozen coefficients; weaker where the residual grows."""
    problem = equations.problem
    _, ni, nj = coordinates.shape
    strength = factor or 2 / (1 + np.sin(np.pi / max(ni, nj)))
    norm = first = norm_of(equations.residual(coordinates))
    safe, safe_norm, floor = coordinates.copy(), norm, equations.round_off(coordinates)
    for iteration in range(limit + 1):
        report.step(iteration, float("nan"), norm, equations.remember(coordinates, norm))
        if norm <= max(tolerance * first, floor):
            return converged("residual", norm, first, iteration, f" The relaxation factor was {strength:.3g}.")
        if iteration == limit:
            break
        if not norm < _DIVERGENCE * safe_norm:
            strength = 1 + (strength - 1) / 2 if strength > 1.05 else strength / 2
            if strength < _WEAKEST or factor is not None:
                coordinates[...] = safe
                return Outcome(
                    Status.DIVERGED,
                    f"the relaxation diverges; the best residual's norm was {safe_norm / first:.1e} of its first "
                    "value. Untangle a folded start, or use method='newton'.",
                )
            coordinates[...] = safe
            problem.refresh(coordinates)
        elif norm < safe_norm:
            safe, safe_norm = coordinates.copy(), norm
        for color in range(4):
            equations.kernels.euler_lagrange_relaxation(
                coordinates, equations.values(coordinates), problem.fixed, color, strength, problem.steps
            )
        problem.refresh(coordinates)
        before = norm
        norm = norm_of(equations.residual(coordinates))
        if norm == before:
            why = "the sweeps change nothing: the nodes' own equations are singular. Use method='newton'."
            return Outcome(Status.STALLED, why)
    return Outcome(
        Status.ITERATION_LIMIT,
        f"{limit} sweeps have brought the residual's norm to {norm:.2e}, {norm / first:.1e} of its first value: allow "
        "more with max_iterations, or use method='newton'.",
    )
