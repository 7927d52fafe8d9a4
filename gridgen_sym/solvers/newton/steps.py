"""Newton steps: the choice of the Hessian, and the accuracy of the linear solve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import Array
from ..energy_problem import EnergyProblem
from ..linear.solution import LinearSolver, Solution
from ..run.deadline import Deadline
from .line_search import LineSearch

#: Shift of the semidefinite Hessian, over its mean diagonal, beyond which steps are too short to be useful.
_LARGEST_SHIFT, _SMALLEST_SHIFT = 1e3, 1e-8
#: The first shift of a full Hessian that is not positive, likewise.
_FIRST_SHIFT = 1e-4
#: A full step that leaves more than this fraction of the gradient's norm makes no progress; so many in a row stall.
_STALLED, _STALLS = 0.5, 2
#: Relative residuals of the linear solves, and that of the last one.
_LOOSEST, _TIGHTEST, _LAST = 0.05, 1e-3, 1e-5


@dataclass(slots=True)
class NewtonSteps:
    """Which Hessian to use, how much to shift it, and how well to solve with it; learned from step to step.

    The full Hessian is used while its steps lead downhill and are not cut; after a step that was cut, the semidefinite
    one, shifted where it is singular; for a functional that is not polyconvex the full one, with the smallest shift
    that conjugate gradients find positive, kept from step to step. Where full steps make no progress and the full
    Hessian is not positive, the grid is near a saddle point, which is left along the direction of negative curvature
    that conjugate gradients have met. The linear systems are solved only as accurately as the step requires (Eisenstat
    and Walker 1996).

    Attributes:
        problem: what is minimized.
        solver: of the linear systems.
        deadline: of the run.
        only_semidefinite: never use the full Hessian.
        cautious: use the semidefinite one next, because the last step was cut; never where it only shifts.
        shift: added to the diagonal, over its mean.
        forcing: relative residual of the next linear solve.
        stalls: full steps in a row without progress. If the full Hessian is not positive then, the grid is near a
            saddle point, and only a direction of negative curvature leads away from it.
    """

    problem: EnergyProblem
    solver: LinearSolver
    deadline: Deadline
    only_semidefinite: bool
    cautious: bool = False
    shift: float = 0.0
    forcing: float = _LOOSEST
    stalls: int = 0
    exact: bool = False
    planes: Any = None

    @property
    def clamps(self) -> bool:
        """Whether the semidefinite Hessian, and not a shift of the full one, helps where that is not positive.

        Where clamped eigenvalues make it semidefinite they change it in most corners, far more than is needed: with it
        Newton's method converges linearly, and ever slower the finer the grid is.
        """
        return self.only_semidefinite or self.problem.kernels.polyconvex

    def downhill(self, search: LineSearch) -> Array | None:
        """Return a step that lowers the energy, or None if no shift gives one."""
        semidefinite = self.only_semidefinite or self.cautious
        while self.shift < _LARGEST_SHIFT:
            self.deadline.check()
            solution = self._solve(search, semidefinite)
            if solution is not None and self._search(search, solution):
                return np.multiply(solution.vector, search.length, out=solution.vector)
            if not self.clamps:
                self.shift = max(4 * self.shift, _FIRST_SHIFT)
            elif semidefinite:
                self.shift = max(10 * self.shift, 1e-6)
            semidefinite = self.clamps
        return None

    def last(self, search: LineSearch) -> Array | None:
        """Return the whole step of Newton's method, solved for well; None where the Hessian is not positive."""
        self.shift, self.forcing = 0.0, _LAST
        solution = self._solve(search, semidefinite=self.only_semidefinite)
        return solution.vector if solution is not None and solution.positive else None

    def is_newton(self, search: LineSearch) -> bool:
        """Return whether the last step is a whole one of Newton's method, with the Hessian as it is."""
        return self.exact and self.shift == 0 and search.length == 1.0

    def _solve(self, search: LineSearch, semidefinite: bool) -> Solution | None:
        """Return Newton's direction, or one of negative curvature; None if this Hessian has bad diagonal blocks."""
        self.exact = not semidefinite
        self.planes = self.problem.hessian(search.iterate.coordinates, semidefinite=semidefinite, out=self.planes)
        # The semidefinite Hessian may be singular (area's is); a small shift makes it definite.
        shift = max(self.shift, _SMALLEST_SHIFT) if semidefinite else self.shift
        if shift:
            self.problem.shift(self.planes, shift)
        if not self.solver.set_operator(self.planes):
            return None
        solution = self.solver.solve(search.iterate.gradient, self.forcing)
        np.negative(solution.vector, out=solution.vector)
        return solution

    def _search(self, search: LineSearch, solution: Solution) -> bool:
        """Search along Newton's direction, or where that has failed along one of negative curvature."""
        if solution.positive:
            return search.along(solution.vector)
        return self.stalls >= _STALLS and search.away(solution.vector)

    def learn(self, search: LineSearch, reduction: float, wanted: float) -> None:
        """Adapt to a step that changed the gradient's norm by a factor.

        Newton's method squares that factor. Where that will do for the factor that is still `wanted`, the next system
        is the last, and is solved just as well as that: a little more work on it saves a step.
        """
        length = abs(search.length)
        self.stalls = self.stalls + 1 if length == 1.0 and reduction > _STALLED else 0
        if self.clamps:
            self.cautious = length < (0.2 if self.exact else 0.5)
            self.shift = 0.0 if length == 1.0 and self.exact else (self.shift / 10 if length > 0.5 else self.shift)
        elif length > 0.5:
            self.shift = self.shift / 4 if self.shift > _FIRST_SHIFT / 10 else 0.0
        elif not search.folds:
            # A step that was cut because it would fold a cell does not discredit the Hessian.
            self.shift = max(4 * self.shift, _FIRST_SHIFT)
        last = reduction**2 <= wanted
        self.forcing = min(_LOOSEST, max(_LAST, 0.5 * wanted) if last else max(_TIGHTEST, 0.5 * reduction))
