"""The convergence test: the gradient is a given fraction of its first norm, or as small as rounding allows."""

from __future__ import annotations

from .iterate import Iterate
from .run.status import Outcome, Status

#: A factor by which the gradient can always fall in spite of rounding.
_MODEST = 0.1
#: Where no step lowers the energy the gradient may be so many times what one sample of rounding gives.
_FEW = 4.0
#: A smallest Jacobian below this part of the mean is nearly folded. If the energy then falls by the factor, the start
#: did not set the scale of the test.
_ALL_BUT_FOLDED, _STEEP = 1e-3, 0.1


class ConvergenceTest:
    """The norm that a gradient must fall to.

    Attributes:
        first: the norm that it must fall from.
        scale: the norm that the gradient of such an energy has far from its minimum, where `first` is no larger one.
    """

    def __init__(self, iterate: Iterate, tolerance: float, reference: float | None = None) -> None:
        """Set it at the start.

        Args:
            iterate: the start.
            tolerance: factor by which the norm must fall.
            reference: the norm that it must fall from; by default that at the start. Where that is larger than the
                scale, the latter counts.
        """
        self._tolerance, self._energy, self._steep = tolerance, abs(iterate.energy), _is_steep(iterate)
        self.scale = iterate.problem.gradient_scale(iterate.coordinates, iterate.energy)
        self.first = min(reference or iterate.norm, self.scale or iterate.norm)
        # A loose tolerance does not come near to rounding.
        self._round_off = _round_off(iterate) if tolerance < _MODEST else 0.0

    @property
    def norm(self) -> float:
        """The norm to fall to."""
        return max(self._tolerance * self.first, self._round_off)

    def reached(self, iterate: Iterate) -> bool:
        """Return whether the gradient is small enough at an iterate.

        A start with J near 0 has an energy, a gradient and rounding that are too large by any factor. So the scale is
        taken anew when the energy has fallen far from there, and rounding where it decides.
        """
        if self._steep and abs(iterate.energy) < _STEEP * self._energy:
            self.scale, self._energy = (
                iterate.problem.gradient_scale(iterate.coordinates, iterate.energy),
                abs(iterate.energy),
            )
            self.first, self._steep = min(self.first, self.scale), _is_steep(iterate)
        if self._tolerance * self.first < iterate.norm <= self._round_off:
            self._round_off = _round_off(iterate)
        return iterate.norm <= self.norm

    def is_by_rounding(self, iterate: Iterate) -> bool:
        """Return whether the gradient is larger than its tolerance, and rounding is why it counts as small enough."""
        return iterate.norm > self._tolerance * self.first

    def at_round_off(self, iterate: Iterate) -> bool:
        """Return whether rounding alone makes the gradient of an iterate at which no step lowers the energy."""
        return self._tolerance < _MODEST and iterate.norm <= _FEW * _round_off(iterate)


def converged(what: str, norm: float, first: float, iteration: int, remark: str = "") -> Outcome:
    """Return the end of a run that meets its convergence test, with a remark; `what` is `gradient` or `residual`."""
    if iteration == 0:
        message = f"the start is a solution already: the {what}'s norm is {norm:.2e}."
    else:
        message = f"the {what}'s norm has fallen to {norm:.2e}, {norm / (first or 1):.1e} of its first value."
    return Outcome(Status.CONVERGED, message + remark)


def _is_steep(iterate: Iterate) -> bool:
    """Return whether a grid is nearly folded, before a barrier."""
    return iterate.problem.kernels.barrier and iterate.smallest < _ALL_BUT_FOLDED * iterate.problem.mean_jacobian(
        iterate.coordinates
    )


def _round_off(iterate: Iterate) -> float:
    return iterate.problem.round_off(iterate.coordinates, iterate.gradient)
