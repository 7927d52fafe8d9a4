"""Why a gradient is not a number: the term of the density that has no derivative at the grid."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arrays import Array
from ..errors import shortened
from ..functionals.definition import Functional


def missing_derivative(
    functional: Functional, parameters: Mapping[str, float] | None, coordinates: Array
) -> str | None:
    """Return a sentence on the term that has a value but no derivative at some corners of a grid; None without one.

    Args:
        functional: whose density is looked at.
        parameters: its values, where they are not the defaults.
        coordinates: (2, ni, nj).
    """
    from ..functionals.smoothness import rough_part

    corners = _corners(coordinates)
    rough = rough_part(functional.expression(), corners, functional.values(parameters))
    if rough is None:
        return None
    count = int(rough.corners.sum())
    where = f"{count} of {corners.shape[1]} corners"
    order = "no derivative" if rough.order == 1 else "no second derivative"
    return (
        f"the functional {functional.name} has {order} at this grid: the term {shortened(rough.part)} is not smooth at "
        f"{where}. Start from another grid, or add a small positive number under its root."
    )


def _corners(coordinates: Array) -> Array:
    """Return the edge vectors (x_xi, y_xi, x_eta, y_eta) of all corners of all cells, (4, n)."""
    along_xi, along_eta = np.diff(coordinates, axis=1), np.diff(coordinates, axis=2)
    near, far = slice(None, -1), slice(1, None)
    pairs = [(along_xi[:, :, a], along_eta[:, b]) for a in (near, far) for b in (near, far)]
    return np.concatenate([np.concatenate([first, second]).reshape(4, -1) for first, second in pairs], axis=1)
