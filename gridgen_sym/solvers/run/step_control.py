"""The guard that keeps steps from folding cells, and detects when it also keeps them from the minimum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Array

#: After so many shortened steps in a row without progress, the guard is what stops the iteration.
_PATIENCE = 5


@dataclass(slots=True)
class StepControl:
    """The guard, and what it has done so far.

    Attributes:
        guards: whether cells of a valid grid may not fold.
        floor: the least that any Jacobian may fall to.
        cut: how many steps were cut short so that no cell folds.
        in_vain: how many of the last ones in a row made no progress.
    """

    guards: bool
    floor: float
    cut: int = 0
    in_vain: int = 0

    def lowest(self, smallest: float) -> float:
        """Return what the smallest Jacobian of a grid, which is given, may not fall to in one step.

        As in the sweeps, no step takes more than nine tenths of it.
        """
        return max(self.floor, 0.1 * smallest) if self.guards and smallest > 0 else -np.inf

    def count(self, cut: bool, progress: bool) -> None:
        """Count a step: whether it was cut short, and whether it made progress."""
        self.cut += cut
        self.in_vain = self.in_vain + 1 if cut and not progress else 0

    @property
    def holds_back(self) -> bool:
        """Whether the steps are cut so short that they make no progress."""
        return self.in_vain >= _PATIENCE

    def __str__(self) -> str:
        """Return the report on steps that were cut short, with a leading blank; empty where there were none."""
        if not self.cut:
            return ""
        return f" {self.cut} step{'s were' if self.cut > 1 else ' was'} cut short so that no cell folds."


def jacobian_floor(smallest: float) -> float:
    """Return the Jacobian below which no step may take a corner of a grid whose smallest one is `smallest`.

    Not quite zero, so that another order of rounding cannot make a cell folded that was just valid.
    """
    return 1e-6 * max(smallest, 0.0)


def diverges(step: Array, extent: float) -> bool:
    """Return whether a step leaves the domain, whose size is `extent`, for good."""
    return not max(float(step.max()), -float(step.min())) < 1e3 * extent
