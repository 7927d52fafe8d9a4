"""The global method: Newton's method on all free nodes at once, with a line search that keeps every corner valid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..runtime import Array
from .problem import Problem, jacobian_floor
from .progress import Progress
from .sparse import assemble_hessian, to_field, to_vector

#: Armijo's constant, and how often a step is halved.
_SUFFICIENT, _HALVINGS = 1e-4, 40
#: Steps in a row that are cut short by the guard and lower the energy by less than a little: it holds the grid back.
_PATIENCE, _LITTLE = 5, 1e-6
#: Shift of the semidefinite Hessian, over its mean diagonal, beyond which steps are too short to matter.
_LARGEST_SHIFT = 1e3


def minimize(
    problem: Problem,
    coordinates: Array,
    progress: Progress,
    *,
    tolerance: float,
    max_iterations: int,
    keep_valid: bool,
    semidefinite: bool = False,
) -> tuple[bool, str]:
    """Minimise until the gradient's norm has fallen by the factor `tolerance`; changes `coordinates` in place.

    Uses the full Hessian while its steps lead downhill and are not cut; after a step that was cut, the
    semidefinite one, shifted where it is singular. With `semidefinite` only that one.

    Returns:
        Whether it converged, and why it stopped.
    """
    guard = keep_valid or problem.kernels.barrier
    energy, smallest, gradient = problem.energy_gradient(coordinates)
    norm = first = float(np.linalg.norm(gradient))
    progress.step(0, energy, norm, smallest)
    floor = jacobian_floor(smallest)
    use_semidefinite, shift, held_back = semidefinite, 0.0, 0
    for iteration in range(max_iterations + 1):
        if norm <= max(tolerance * first, problem.round_off(coordinates, energy)):
            return True, f"the gradient's norm has fallen to {norm:.2e}, {norm / (first or 1):.1e} of its first value."
        if iteration == max_iterations:
            break
        # As in the sweeps, no step takes more than nine tenths of the smallest Jacobian.
        lowest = max(floor, 0.1 * smallest) if guard and smallest > 0 else -np.inf
        search = _Search(problem, coordinates, energy, gradient, lowest)
        step, shift, exact = _downhill(search, use_semidefinite, shift)
        if step is None:
            return (
                False,
                f"no step downhill was found; the gradient's norm is {norm:.2e}, {norm / first:.1e} of its first.",
            )
        coordinates += step
        before = energy
        problem.refresh(coordinates)
        energy, smallest, gradient = problem.energy_gradient(coordinates)
        norm = float(np.linalg.norm(gradient))
        progress.step(iteration + 1, energy, norm, smallest)
        use_semidefinite = semidefinite or search.length < (0.2 if exact else 0.5)
        held_back = held_back + 1 if search.folds and before - energy < _LITTLE * abs(energy) else 0
        if held_back == _PATIENCE:
            return False, (
                "the minimum lies beyond the valid grids: every step downhill would fold a cell. The gradient's "
                f"norm is {norm:.2e}, {norm / first:.1e} of its first value. This is the best valid grid on the way; "
                "keep_valid=False lets cells fold."
            )
    return False, (
        f"{max_iterations} Newton steps have brought the gradient's norm to {norm:.2e}, {norm / first:.1e} of its "
        f"first value, not to {tolerance:.1e}: allow more with max_iterations."
    )


@dataclass(slots=True)
class _Search:
    """The state from which a step is sought, and how the last search from it ended.

    Attributes:
        lowest: the Jacobian that no corner may fall to.
        length: of the accepted step; 1 is the whole Newton step.
        folds: whether a longer step was refused because it would have folded a cell.
    """

    problem: Problem
    coordinates: Array
    energy: float
    gradient: Array
    lowest: float
    length: float = 0.0
    folds: bool = False

    def along(self, direction: Array) -> bool:
        """Find the longest step 1, 1/2, ... that lowers the energy enough and folds nothing."""
        slope = float((self.gradient * direction).sum())
        round_off = 1e2 * np.finfo(float).eps * abs(self.energy)
        self.length, self.folds = 1.0, False
        for _ in range(_HALVINGS):
            trial, smallest = self.problem.energy(self.coordinates + self.length * direction)
            lower = trial <= self.energy + _SUFFICIENT * self.length * slope + round_off
            if lower and smallest > self.lowest:
                return True
            self.folds |= bool(lower)
            self.length *= 0.5
        return False


def _downhill(search: _Search, semidefinite: bool, shift: float) -> tuple[Array | None, float, bool]:
    """Return a step that lowers the energy (or None), the shift for the next one, and whether the Hessian was full."""
    while shift < _LARGEST_SHIFT:
        direction, exact = _direction(search.problem, search.coordinates, search.gradient, semidefinite, shift)
        if search.along(direction):
            return search.length * direction, shift / 10 if search.length > 0.5 else shift, exact
        semidefinite, shift = True, max(10 * shift, 1e-6)
    return None, shift, False


def _direction(
    problem: Problem, coordinates: Array, gradient: Array, semidefinite: bool, shift: float
) -> tuple[Array, bool]:
    """Return a direction that leads downhill, and whether it is that of the full Hessian."""
    from scipy.sparse import identity
    from scipy.sparse.linalg import splu

    right = -to_vector(gradient, problem.fixed)
    for attempt_semidefinite in (False, True)[int(semidefinite) :]:
        matrix = assemble_hessian(problem.hessian(coordinates, semidefinite=attempt_semidefinite), problem.fixed)
        size = abs(matrix.diagonal()).mean()
        # The semidefinite Hessian may be singular (area); a small shift makes it definite.
        moved = max(shift, 1e-10 if attempt_semidefinite else 0.0) * size
        try:
            solution = splu(matrix + moved * identity(matrix.shape[0], format="csc")).solve(right)
        except RuntimeError:
            continue
        if np.isfinite(solution).all() and solution @ right > 0:
            return to_field(solution, problem.fixed), not attempt_semidefinite
    return -gradient / size, False
