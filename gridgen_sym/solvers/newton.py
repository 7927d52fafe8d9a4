"""The global method: Newton's method on all free nodes at once, with a line search that keeps every corner valid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..runtime import Array
from .linear import LinearSolver, Solution, hessian_solver
from .problem import Problem, converged_message, diverges, inner, jacobian_floor, norm_of, step_control_message
from .progress import Progress

#: Armijo's constant, and how often a step is halved.
_SUFFICIENT, _HALVINGS = 1e-4, 40
#: Steps in a row that are cut short by the guard and lower the energy by less than a little: it holds the grid back.
_PATIENCE, _LITTLE = 5, 1e-6
#: Shift of the semidefinite Hessian, over its mean diagonal, beyond which steps are too short to matter.
_LARGEST_SHIFT, _SMALLEST_SHIFT = 1e3, 1e-8
#: The first shift of a full Hessian that is not positive, likewise.
_FIRST_SHIFT = 1e-4
#: A whole step that leaves more than this part of the gradient's norm has led nowhere; so many of them in a row stall.
_STALLED, _STALLS = 0.5, 2
#: Relative residuals of the linear solves, and that of the last one.
_LOOSEST, _TIGHTEST, _LAST = 0.1, 1e-3, 1e-5


def minimize(
    problem: Problem,
    coordinates: Array,
    progress: Progress,
    *,
    tolerance: float,
    max_iterations: int,
    keep_valid: bool,
    until_valid: bool = False,
    semidefinite: bool = False,
    reference: float | None = None,
    solver: LinearSolver | None = None,
) -> tuple[bool, str]:
    """Minimise until the gradient's norm has fallen by the factor `tolerance`; changes `coordinates` in place.

    Uses the full Hessian while its steps lead downhill and are not cut; after a step that was cut, the
    semidefinite one, shifted where it is singular; for a functional that is not polyconvex the full one, with the
    smallest shift that conjugate gradients find positive, kept from step to step. With `semidefinite` only the
    semidefinite one. Where whole steps lead nowhere and the full Hessian is not positive, the grid is near a saddle
    point, which is left along the direction of negative curvature that conjugate gradients have met. The linear systems
    are solved only as well as the step deserves (Eisenstat and Walker 1996).

    Args:
        problem: what is minimised.
        coordinates: (2, ni, nj), the start and the result.
        progress: is told of every step.
        tolerance: factor by which the gradient's norm must fall.
        max_iterations: Newton steps.
        keep_valid: no step takes the smallest Jacobian of a valid grid to zero; barrier functionals never do.
        until_valid: stop at the first valid grid.
        semidefinite: use the semidefinite Hessian only.
        reference: the norm that the gradient must fall from; by default that at the start. Where that is larger
            than `Problem.gradient_scale`, the latter counts.
        solver: what solves the linear systems; by default the backend's.

    Returns:
        Whether it converged, and why it stopped.
    """
    guard = keep_valid or problem.kernels.barrier
    energy, smallest, gradient = problem.energy_gradient(coordinates)
    norm = norm_of(gradient)
    first = min(reference or norm, problem.gradient_scale(coordinates, energy) or norm)
    progress.step(0, energy, norm, smallest)
    floor, round_off = jacobian_floor(smallest), problem.round_off(coordinates, gradient)
    state = _Newton(problem, solver or hessian_solver(problem.fixed, problem.kernels.backend), semidefinite)
    cut, held_back, extent, trial = 0, 0, float(np.ptp(coordinates)), np.empty_like(coordinates)
    for iteration in range(max_iterations + 1):
        if until_valid and smallest > 0:
            return True, "the grid is valid."
        if norm <= max(tolerance * first, round_off):
            return True, converged_message("gradient", norm, first, iteration) + step_control_message(cut)
        if iteration == max_iterations:
            break
        # As in the sweeps, no step takes more than nine tenths of the smallest Jacobian.
        lowest = max(floor, 0.1 * smallest) if guard and smallest > 0 else -np.inf
        search = _Search(problem, coordinates, energy, gradient, lowest, trial)
        step = state.downhill(search)
        if step is None:
            return False, _stuck("no step downhill was found", norm, first)
        if diverges(step, extent):
            return False, _stuck("the steps diverge, which happens where the energy has no lower bound", norm, first)
        coordinates += step
        before = energy, norm
        problem.refresh(coordinates)
        energy, smallest, gradient = problem.energy_gradient(coordinates, out=gradient)
        norm = norm_of(gradient)
        progress.step(iteration + 1, energy, norm, smallest)
        state.learn(search, norm / before[1], max(tolerance * first, round_off) / (norm or 1.0))
        cut += search.folds and not problem.kernels.barrier  # A barrier's own line search is nothing to tell.
        held_back = held_back + 1 if search.folds and before[0] - energy < _LITTLE * abs(energy) else 0
        if held_back == _PATIENCE:
            why = "the minimum lies beyond the valid grids: every step downhill would fold a cell"
            return False, _stuck(why, norm, first) + " This is the best valid grid; keep_valid=False lets cells fold."
    why = f"{max_iterations} Newton steps were not enough; allow more with max_iterations"
    return False, _stuck(why, norm, first) + step_control_message(cut)


def _stuck(why: str, norm: float, first: float) -> str:
    return f"{why}. The gradient's norm is {norm:.2e}, {norm / (first or 1):.1e} of its first value."


def _noise(energy: float) -> float:
    """Return how much of an energy is rounding: smaller differences mean nothing."""
    return 1e2 * float(np.finfo(float).eps) * abs(energy)


@dataclass(slots=True)
class _Newton:
    """Which Hessian to use, how much to shift it, and how well to solve with it; learnt from step to step.

    Attributes:
        only_semidefinite: never use the full Hessian.
        cautious: use the semidefinite one next, because the last step was cut; never where it only shifts.
        shift: added to the diagonal, over its mean.
        forcing: relative residual of the next linear solve.
        stalls: whole steps in a row that have led nowhere. If the full Hessian is not positive then, the grid is near a
            saddle point, and only a direction of negative curvature leads away from it.
    """

    problem: Problem
    solver: LinearSolver
    only_semidefinite: bool
    cautious: bool = False
    shift: float = 0.0
    forcing: float = _LOOSEST
    stalls: int = 0
    exact: bool = False
    planes: Array | None = None

    @property
    def clamps(self) -> bool:
        """Whether the semidefinite Hessian, and not a shift of the full one, helps where that is not positive.

        Where clamped eigenvalues make it semidefinite they change it in most corners, far more than is needed: with it
        Newton's method converges linearly, and ever slower the finer the grid is.
        """
        return self.only_semidefinite or self.problem.kernels.polyconvex

    def downhill(self, search: _Search) -> Array | None:
        """Return a step that lowers the energy, or None if no shift gives one."""
        semidefinite = self.only_semidefinite or self.cautious
        while self.shift < _LARGEST_SHIFT:
            solution = self._solve(search, semidefinite)
            if solution is not None and self._search(search, solution):
                return np.multiply(solution.vector, search.length, out=solution.vector)
            if not self.clamps:
                self.shift = max(4 * self.shift, _FIRST_SHIFT)
            elif semidefinite:
                self.shift = max(10 * self.shift, 1e-6)
            semidefinite = self.clamps
        return None

    def _solve(self, search: _Search, semidefinite: bool) -> Solution | None:
        """Return Newton's direction, or one of negative curvature; None if this Hessian has bad diagonal blocks."""
        self.exact = not semidefinite
        self.planes = self.problem.hessian(search.coordinates, semidefinite=semidefinite, out=self.planes)
        # The semidefinite Hessian may be singular (area's is); a small shift makes it definite.
        shift = max(self.shift, _SMALLEST_SHIFT) if semidefinite else self.shift
        if shift:
            size = 0.5 * float(np.abs(self.planes[0]).mean() + np.abs(self.planes[2]).mean())
            self.planes[0] += shift * size
            self.planes[2] += shift * size
        if not self.solver.set_operator(self.planes):
            return None
        solution = self.solver.solve(search.gradient, self.forcing)
        np.negative(solution.vector, out=solution.vector)
        return solution

    def _search(self, search: _Search, solution: Solution) -> bool:
        """Look along Newton's direction, or where that has failed along one of negative curvature."""
        if solution.positive:
            return search.along(solution.vector)
        return self.stalls >= _STALLS and search.away(solution.vector)

    def learn(self, search: _Search, reduction: float, wanted: float) -> None:
        """Draw the lesson of a step that changed the gradient's norm by a factor.

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
            # A step that was cut because it would fold a cell says nothing of the Hessian.
            self.shift = max(4 * self.shift, _FIRST_SHIFT)
        last = reduction**2 <= wanted
        self.forcing = min(_LOOSEST, max(_LAST, 0.5 * wanted) if last else max(_TIGHTEST, 0.5 * reduction))


@dataclass(slots=True)
class _Search:
    """The state from which a step is sought, and how the last search from it ended.

    Attributes:
        lowest: the Jacobian that no corner may fall to.
        trial: (2, ni, nj), where trial grids are put.
        length: of the accepted step; 1 is the whole Newton step. Negative where it leads against its direction.
        folds: whether a longer step was refused because it would have folded a cell.
    """

    problem: Problem
    coordinates: Array
    energy: float
    gradient: Array
    lowest: float
    trial: Array
    length: float = 0.0
    folds: bool = False

    def along(self, direction: Array) -> bool:
        """Find the longest step 1, 1/2, ... that lowers the energy enough and folds nothing."""
        slope = inner(self.gradient, direction)
        round_off = _noise(self.energy)
        self.length, self.folds = 1.0, False
        for _ in range(_HALVINGS):
            energy, smallest = self._energy_at(direction, self.length)
            lower = energy <= self.energy + _SUFFICIENT * self.length * slope + round_off
            if lower and smallest > self.lowest:
                return True
            self.folds |= bool(lower)
            self.length *= 0.5
        return False

    def away(self, direction: Array) -> bool:
        """Find the length, up to one that moves a node across the grid, that lowers the energy most and folds nothing.

        The direction is one of negative curvature, and its own length means nothing.
        """
        sign = -1.0 if inner(self.gradient, direction) > 0 else 1.0
        length = sign * float(np.ptp(self.coordinates)) / float(np.abs(direction).max())
        least = self.energy - _noise(self.energy)
        self.length, self.folds = 0.0, False
        for _ in range(_HALVINGS):
            energy, smallest = self._energy_at(direction, length)
            if energy < least and smallest > self.lowest:
                self.length, least = length, energy
            elif self.length:
                break
            length *= 0.5
        return self.length != 0.0

    def _energy_at(self, direction: Array, length: float) -> tuple[float, float]:
        """Return the energy and the smallest Jacobian after a step of this length."""
        np.multiply(direction, length, out=self.trial)
        self.trial += self.coordinates
        return self.problem.energy(self.trial)
