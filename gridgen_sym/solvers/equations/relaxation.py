"""The textbook method for the Euler–Lagrange equations: node by node, with frozen coefficients, over-relaxed."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ..convergence import converged
from ..run.progress import Progress
from ..run.status import Outcome, Status
from .system import System

#: How much the residual may grow before a relaxation is called divergent, and the weakest one that is tried.
_DIVERGENCE, _WEAKEST = 1e2, 0.05


def solve_by_relaxation(
    equations: System, coordinates: Array, report: Progress, tolerance: float, limit: int, factor: float | None
) -> Outcome:
    """Sweep over the nodes with frozen coefficients; weaker where the residual grows."""
    strength = factor or 2 / (1 + np.sin(np.pi / equations.width))
    norm = first = equations.norm(equations.residual(coordinates))
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
            equations.refresh(coordinates)
        elif norm < safe_norm:
            safe, safe_norm = coordinates.copy(), norm
        equations.sweep(coordinates, strength)
        equations.refresh(coordinates)
        before = norm
        norm = equations.norm(equations.residual(coordinates))
        if norm == before:
            why = "the sweeps change nothing: the nodes' own equations are singular. Use method='newton'."
            return Outcome(Status.STALLED, why)
    return Outcome(
        Status.ITERATION_LIMIT,
        f"{limit} sweeps have brought the residual's norm to {norm:.2e}, {norm / first:.1e} of its first value: allow "
        "more with max_iterations, or use method='newton'.",
    )
