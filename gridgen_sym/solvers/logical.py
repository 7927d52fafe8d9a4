"""The logical rectangle that a grid is a map of: it gives the steps from a node to the next, on grids of any size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..errors import GridgenError, quoted

#: What a user may say of the steps: `unit`, `index`, or the two numbers themselves.
Spacing = Literal["unit", "index"] | tuple[float, float]


@dataclass(frozen=True, slots=True)
class LogicalRectangle:
    """The range of the logical coordinates, the same for all grids with the same boundary.

    Attributes:
        extents: along xi and along eta.
    """

    extents: tuple[float, float]

    @classmethod
    def of(cls, spacing: Spacing | LogicalRectangle, shape: tuple[int, ...]) -> LogicalRectangle:
        """Return the rectangle on which a grid of a shape has a spacing.

        Args:
            spacing: `unit` for the unit square, whatever the shape; `index` for steps of 1; or both steps. A rectangle
                is returned as it is.
            shape: (ni, nj), number of nodes.

        Raises:
            GridgenError: for another spacing.
        """
        if isinstance(spacing, LogicalRectangle):
            return spacing
        name = spacing if isinstance(spacing, str) else ""
        if name == "unit":
            return cls((1.0, 1.0))
        steps = (1.0, 1.0) if name == "index" else _checked(spacing)
        return cls((steps[0] * (shape[0] - 1), steps[1] * (shape[1] - 1)))

    def steps(self, shape: tuple[int, ...]) -> tuple[float, float]:
        """Return the steps (h_xi, h_eta) between the nodes of a grid."""
        return self.extents[0] / (shape[0] - 1), self.extents[1] / (shape[1] - 1)


def _checked(spacing: object) -> tuple[float, float]:
    given = np.asarray(spacing, dtype=object).ravel()
    numbers = [isinstance(value, (int, float, np.number)) and 0 < value < np.inf for value in given]
    if numbers != [True, True]:
        raise GridgenError(
            "spacing is 'unit', 'index' or two positive numbers, the steps along xi and along eta; "
            f"came {quoted(spacing)}"
        )
    return float(given[0]), float(given[1])
