"""Why a gradient is not a number: the term of the density that has no derivative at the grid."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arrays import Array
from ..errors import shortened
from ..functionals.definition import Functional
from ..functionals.metric import INVERSE_TARGET_NAMES, WEIGHT_NAME


def missing_derivative(
    functional: Functional,
    parameters: Mapping[str, float] | None,
    coordinates: Array,
    steps: tuple[float, float],
    values: Mapping[str, Array] | None = None,
) -> str | None:
    """Return a sentence on the term that has a value but no derivative at some corners of a grid; None without one.

    Args:
        functional: whose density is looked at.
        parameters: its values, where they are not the defaults.
        coordinates: (2, ni, nj).
        steps: of the logical coordinates.
        values: what else the density is given, by name, at the corners; see `Problem.corner_values`.
    """
    from ..functionals.smoothness import rough_part

    corners, given = _corners(coordinates, steps), dict(values or {})
    target = [given[name] for name in INVERSE_TARGET_NAMES if name in given]
    rough = rough_part(
        functional.expression(),
        corners,
        {**functional.values(parameters), **given},
        given.get(WEIGHT_NAME, 1.0),
        _relative(corners, *target) if target else None,
    )
    if rough is None:
        return None
    count = int(rough.corners.sum())
    where = f"{count} of {corners.shape[1]} corners"
    order = "no derivative" if rough.order == 1 else "no second derivative"
    return (
        f"the functional {functional.name} has {order} at this grid: the term {shortened(rough.part)} is not smooth at "
        f"{where}. Start from another grid, or add a small positive number under its root."
    )


def _corners(coordinates: Array, steps: tuple[float, float]) -> Array:
    """Return (x_xi, y_xi, x_eta, y_eta), edge vectors over the steps, at all corners of all cells, (4, n).

    First those at the nodes (i, j) of the cells, then at (i+1, j), (i, j+1) and (i+1, j+1), as in `runtime.Values`.
    """
    along_xi, along_eta = np.diff(coordinates, axis=1) / steps[0], np.diff(coordinates, axis=2) / steps[1]
    near, far = slice(None, -1), slice(1, None)
    pairs = [(along_xi[:, :, a], along_eta[:, b]) for a in (near, far) for b in (near, far)]
    return np.concatenate([np.concatenate([first, second]).reshape(4, -1) for first, second in pairs], axis=1)


def _relative(corners: Array, v11: Array, v12: Array, v21: Array, v22: Array) -> Array:
    """Return the columns of T = A V, in the order of the edge vectors (4, n) that are the columns of A."""
    along_xi, along_eta = corners[:2], corners[2:]
    return np.concatenate([v11 * along_xi + v21 * along_eta, v12 * along_xi + v22 * along_eta])
