"""Why an energy or a gradient is not a number: the term of the density that has no value, or no derivative."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..errors import shortened
from ..functionals.definition import Functional
from ..functionals.metric import INVERSE_TARGET_NAMES, WEIGHT_NAME

if TYPE_CHECKING:
    from ..functionals.smoothness import Rough


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
    rough = _rough(functional, parameters, coordinates, steps, values or {}, least=1)
    if rough is None:
        return None
    where = f"{int(rough.corners.sum())} of {rough.corners.size} corners"
    order = "no derivative" if rough.order == 1 else "no second derivative"
    return (
        f"the functional {functional.name} has {order} at this grid: the term {shortened(rough.part)} is not smooth at "
        f"{where}. Start from another grid, or add a small positive number under its root."
    )


def missing_value(
    functional: Functional,
    parameters: Mapping[str, float] | None,
    coordinates: Array,
    steps: tuple[float, float],
    values: Mapping[str, Array] | None = None,
) -> str | None:
    """Return a sentence on the term that has no finite value at some corner of a valid grid; None without one.

    Arguments are those of `missing_derivative`.
    """
    given = values or {}
    rough = _rough(functional, parameters, coordinates, steps, given, least=0)
    if rough is None or rough.order:
        return None
    first = int(rough.corners.argmax())
    ni, nj = coordinates.shape[1:]
    corner, i, j = (int(k) for k in np.unravel_index(first, (4, ni - 1, nj - 1)))
    node = i + corner % 2, j + corner // 2
    x, y = coordinates[0][node], coordinates[1][node]
    used = [name for name in given if name in {str(one) for one in functional.expression().free_symbols}]
    at = "".join(f", {name} = {given[name][first]:.6g}" for name in used)
    return (
        f"the functional {functional.name} has no finite value at {int(rough.corners.sum())} of {rough.corners.size} "
        f"corners of this grid, first at that of node {node}, where x = {x:.6g}, y = {y:.6g}{at}, because of the term "
        f"{shortened(rough.part)}. Change what the density is given there, or the density"
    )


def _rough(
    functional: Functional,
    parameters: Mapping[str, float] | None,
    coordinates: Array,
    steps: tuple[float, float],
    values: Mapping[str, Array],
    *,
    least: int,
) -> Rough | None:
    """Return the first part of the density without a value (order 0) or a derivative at the corners of a grid."""
    from ..functionals.smoothness import rough_part

    corners, given = _corners(coordinates, steps), dict(values)
    target = [given[name] for name in INVERSE_TARGET_NAMES if name in given]
    return rough_part(
        functional.expression(),
        corners,
        {**functional.values(parameters), **given},
        given.get(WEIGHT_NAME, 1.0),
        _relative(corners, *target) if target else None,
        least=least,
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
