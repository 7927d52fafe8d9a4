"""When a gradient is small enough: a fraction of what it was, or all that rounding leaves of it."""

from __future__ import annotations

from .folds import mean_jacobian
from .iterate import Point
from .run.status import Outcome, Status

#: A factor for the gradient to fall by that no rounding is in the way of.
_MODEST = 0.1
#: A smallest Jacobian below this part of the mean is nearly folded. If the energy then falls by the factor, the start
#: was no measure of anything.
_ALL_BUT_FOLDED, _STEEP = 1e-3, 0.1


class Goal:
    """The norm that a gradient must fall to.

    Attributes:
        first: the norm that it must fall from.
        scale: the norm that the gradient of such an energy has far from its minimum, where `first` is no larger one.
    """

    def __init__(self, point: Point, tolerance: float, reference: float | None = None) -> None:
        """Set it at the start.

        Args:
            point: the start.
            tolerance: factor by which the norm must fall.
            reference: the norm that it must fall from; by default that at the start. Where that is larger than the
                scale, the latter counts.
        """
        self._tolerance, self._energy, self._steep = tolerance, abs(point.energy), _is_steep(point)
        self.scale = point.problem.gradient_scale(point.coordinates, point.energy)
        self.first = min(reference or point.norm, self.scale or point.norm)
        # Who asks for little will not come near to rounding.
        self._round_off = _round_off(point) if tolerance < _MODEST else 0.0

    @property
    def norm(self) -> float:
        """The norm to fall to."""
        return max(self._tolerance * self.first, self._round_off)

    def reached(self, point: Point) -> bool:
        """Return whether the gradient is small enough at a point.

        A start with J near 0 has an energy, a gradient and rounding that are too large by any factor. So the scale is
        taken anew when the energy has fallen far from there, and rounding where it decides.
        """
        if self._steep and abs(point.energy) < _STEEP * self._energy:
            self.scale, self._energy = point.problem.gradient_scale(point.coordinates, point.energy), abs(point.energy)
            self.first, self._steep = min(self.first, self.scale), _is_steep(point)
        if self._tolerance * self.first < point.norm <= self._round_off:
            self._round_off = _round_off(point)
        return point.norm <= self.norm


def converged(what: str, norm: float, first: float, iteration: int, remark: str = "") -> Outcome:
    """Return how a run ends that meets its convergence test, with a remark; `what` is `gradient` or `residual`."""
    if iteration == 0:
        message = f"the start is a solution already: the {what}'s norm is {norm:.2e}."
    else:
        message = f"the {what}'s norm has fallen to {norm:.2e}, {norm / (first or 1):.1e} of its first value."
    return Outcome(Status.CONVERGED, message + remark)


def _is_steep(point: Point) -> bool:
    """Return whether a grid is nearly folded, before a barrier."""
    return point.problem.kernels.barrier and point.smallest < _ALL_BUT_FOLDED * mean_jacobian(point.coordinates)


def _round_off(point: Point) -> float:
    return point.problem.round_off(point.coordinates, point.gradient)
