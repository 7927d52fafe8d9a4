"""Line search: the energy falls, and no valid cell becomes folded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...errors import UnusableValueError
from ..iterate import Iterate

#: Armijo's constant, and how often a step is halved.
_SUFFICIENT, _HALVINGS = 1e-4, 40
#: Steps shorter than this part of the grid may change the energy by less than its rounding, which is so many times its
#: change when all coordinates change by a rounding error; the gradient's norm must then fall to this fraction.
_LITTLE, _NOISES, _LESS = 1e-5, 4.0, 0.9
_ULP = 4 * float(np.finfo(float).eps)


@dataclass(slots=True)
class LineSearch:
    """A line search from an iterate, and how the last one ended.

    Attributes:
        iterate: where the step begins.
        lowest: the Jacobian that no corner may fall to.
        trial: where trial grids are put.
        length: of the accepted step; 1 is the whole Newton step. Negative where it leads against its direction.
        energy: of the grid at the accepted length.
        folds: whether a longer step was refused because it would have folded a cell.
    """

    iterate: Iterate
    lowest: float
    trial: Array
    length: float = 0.0
    energy: float = float("nan")
    folds: bool = False

    def along(self, direction: Array) -> bool:
        """Find the longest step 1, 1/2, ... that lowers the energy enough and folds nothing."""
        slope = self.iterate.problem.inner(self.iterate.gradient, direction)
        round_off = _noise(self.iterate.energy)
        self.length, self.folds = 1.0, False
        for _ in range(_HALVINGS):
            self.energy, smallest = self._energy_at(direction, self.length)
            lower = self.energy <= self.iterate.energy + _SUFFICIENT * self.length * slope + round_off
            lower = lower or (self.length == 1.0 and self._is_less_steep(direction, slope))
            if lower and smallest > self.lowest and self._values_exist():
                return True
            self.folds |= bool(lower) and not smallest > self.lowest
            self.length *= 0.5
        return False

    def halves_gradient(self, direction: Array) -> bool:
        """Return whether a whole step halves the gradient's norm and folds nothing; the trial grid is that after it."""
        problem = self.iterate.problem
        smallest = self._energy_at(direction, 1.0)[1]
        if not smallest > self.lowest or not self._values_exist():
            return False
        return bool(problem.norm(problem.energy_gradient(self.trial)[2]) <= 0.5 * self.iterate.norm)

    def _is_less_steep(self, direction: Array, slope: float) -> bool:
        """Return whether the trial grid has a smaller gradient, where rounding hides how the energy changes.

        So it is near a minimum where large terms of the energy cancel, such as a target that is attained.
        """
        iterate, little = self.iterate, _LITTLE * float(np.ptp(self.iterate.coordinates))
        if not (np.isfinite(self.energy) and float(np.abs(direction).max()) <= little):
            return False
        trial = self.trial.copy()
        noise = _NOISES * max(abs(self._energy_of(trial * (1 + k * _ULP)) - self.energy) for k in (1, -1))
        if not (-slope <= noise and self.energy <= iterate.energy + noise):
            return False
        gradient = iterate.problem.energy_gradient(trial)[2]
        return bool(iterate.problem.norm(gradient) <= _LESS * iterate.norm)

    def away(self, direction: Array) -> bool:
        """Find the length, up to one that moves a node across the grid, that lowers the energy most and folds nothing.

        The direction is one of negative curvature; its own length has no meaning.
        """
        sign = -1.0 if self.iterate.problem.inner(self.iterate.gradient, direction) > 0 else 1.0
        length = sign * float(np.ptp(self.iterate.coordinates)) / float(np.abs(direction).max())
        least = self.iterate.energy - _noise(self.iterate.energy)
        self.length, self.folds = 0.0, False
        for _ in range(_HALVINGS):
            energy, smallest = self._energy_at(direction, length)
            if energy < least and smallest > self.lowest and self._values_exist():
                self.length, self.energy, least = length, energy, energy
            elif self.length:
                break
            length *= 0.5
        return self.length != 0.0

    def _energy_at(self, direction: Array, length: float) -> tuple[float, float]:
        """Return the energy and the smallest Jacobian after a step of this length.

        Where the weight, or a field, has no value that can be used the energy is infinite, so that the step is refused.
        """
        np.multiply(direction, length, out=self.trial)
        self.trial += self.iterate.coordinates
        self.iterate.problem.retract(self.trial, trial=True)
        try:
            return self.iterate.problem.energy(self.trial)
        except UnusableValueError:
            return np.inf, -np.inf

    def _energy_of(self, coordinates: Array) -> float:
        try:
            return self.iterate.problem.energy(coordinates)[0]
        except UnusableValueError:
            return np.inf

    def _values_exist(self) -> bool:
        """Return whether values that are held now can be evaluated on the trial grid, once the step is taken."""
        problem = self.iterate.problem
        return not problem.lags or problem.exists_at(self.trial)


def _noise(energy: float) -> float:
    """Return the rounding error of an energy: smaller differences are not significant."""
    return 1e2 * float(np.finfo(float).eps) * abs(energy)
