"""How what is held while nodes move, and evaluated again where they come to, changes with the nodes."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from ..arrays import Array
from ..fields.target import Target
from ..functionals.metric import WEIGHT_NAME
from ..solvers.problem import Problem
from .targets import inverse_along, inverse_at_nodes

#: By the name of a plane, its derivatives in x and y at the nodes, (2, ni, nj).
Slopes: TypeAlias = dict[str, Array]


def slopes_of_held(problem: Problem, coordinates: Array) -> Slopes:
    """Return the derivatives in the nodes of the planes that are held; empty where nothing is."""
    inputs = problem.inputs
    if inputs is None or not inputs.lags:
        return {}
    x, y = coordinates
    found: Slopes = {}
    if inputs.weight is not None and inputs.weight.lags and WEIGHT_NAME in problem.kernels.planes:
        found[WEIGHT_NAME] = np.stack(inputs.weight.field.derivatives(x, y, ("x", "y")))
    for components in inputs.fields:
        if components.lags:
            for name, part in zip(components.names, components.parts, strict=True):
                if part.varies:
                    found[name] = np.stack(part.derivatives(x, y, ("x", "y")))
    if inputs.target is not None and inputs.target.lags:
        found |= _slopes_of_target(problem, inputs.target, coordinates)
    return found


def _slopes_of_target(problem: Problem, target: Target, coordinates: Array) -> Slopes:
    x, y = coordinates
    flat, values = np.zeros((2, *x.shape)), problem.values(coordinates)
    assert values is not None
    slopes = [np.stack(part.derivatives(x, y, ("x", "y"))) if part.varies else flat for part in target.parts]
    inverse = inverse_at_nodes(values, problem.kernels.planes)
    along = [inverse_along(inverse, [slope[k] for slope in slopes], problem.steps) for k in (0, 1)]
    return {name: np.stack((along[0][name], along[1][name])) for name in along[0]}
