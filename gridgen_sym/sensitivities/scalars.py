"""Derivatives in the numbers that a scalar field was made of, and changes of its values with these."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arrays import Array, real_array
from ..errors import GridgenError
from ..fields.function import Constant
from ..fields.sampled import SampledField
from ..fields.scalar import ScalarField, as_scalar
from .corners import at_corners, sum_at_nodes, sum_like

Points = tuple[Array, Array]
#: The derivatives of a field that moves with the nodes, beside its value.
SLOPES = ("x", "y")


def in_scalar(part: ScalarField, points: Points, at: Mapping[str, Array]) -> Array:
    """Return derivatives in what a field was made of.

    Args:
        part: the field.
        points: the coordinates of the nodes that functions are given.
        at: the derivatives in its values at the corners, and with the keys `x` and `y` in its derivatives there.

    Returns:
        For numbers of a grid or samples an array of their shape; for a number, of shape (). For a formula or another
        function the derivatives in its values at the nodes (ni, nj); where these move, and the field with them, in its
        values and its derivatives in x and y, (3, ni, nj).
    """
    if part.numbers is not None:
        return sum_like(at[""], part.numbers)
    nodes = {key: sum_at_nodes(corners) for key, corners in at.items()}
    if isinstance(part.evaluator, Constant):
        return np.asarray(nodes[""].sum())
    if isinstance(part.evaluator, SampledField):
        evaluator = part.evaluator
        return sum((evaluator.transposed(one, *points, key) for key, one in nodes.items()), np.zeros(evaluator.shape))
    return np.stack([nodes[key] for key in ("", *SLOPES)]) if len(nodes) > 1 else nodes[""]


def along_scalar(part: ScalarField, points: Points, change: Any, keys: tuple[str, ...]) -> dict[str, Array]:  # noqa: ANN401
    """Return changes at the corners of the values of a field, and of its derivatives.

    Args:
        part: the field.
        points: as for `in_scalar`.
        change: of samples, an array of their shape; else anything that a field is made of.
        keys: an empty one for the values, `x` and `y` for derivatives.

    Raises:
        GridgenError: for what is no change of this field.
    """
    shape = points[0].shape[0], points[0].shape[1]
    evaluator = part.evaluator
    if isinstance(evaluator, SampledField) and isinstance(change, (np.ndarray, list)):
        samples = real_array(change, f"the change of {part.name}")
        if samples.shape != evaluator.shape:
            raise GridgenError(
                f"the change of {part.name} must have the shape of its samples, {evaluator.shape}; came {samples.shape}"
            )
        return {key: at_corners(evaluator.along(samples, *points, key), shape) for key in keys}
    given = as_scalar(change, f"the change of {part.name}", part.variables)
    values = {"": given.plane(*points)}
    slopes = [key for key in keys if key]
    if slopes:
        values |= zip(slopes, given.derivatives(*points, tuple(slopes)), strict=True)
    return {key: at_corners(values[key], shape) for key in keys}
