"""Mixed derivatives of a corner's energy: in the nodes, along a direction, and in what the density is given.

A grid that minimizes an energy changes with weights, fields, targets and parameters as these change the gradient. What
is derived here is the derivative of the gradient times a direction, in each value and each parameter: enough for
products with the matrix of mixed derivatives from either side.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy
from sympy import Expr, Symbol

from ...functionals.definition import Functional
from ...functionals.metric import symbol
from ..coordinates import POSITION_DIRECTION, Variant, differentiate, differentiate_along
from ..values import Values, values_of
from .discrete import variant_density


@dataclass(frozen=True, slots=True)
class MixedModel:
    """The mixed derivatives of one corner's energy.

    Attributes:
        values: the symbols beside the metric.
        parameters: the symbols of the functional's parameters.
        energy: the corner energy.
        along: for each value and each parameter, in order, the derivative of the energy in it and along the direction
            (see `coordinates.DIRECTION`); zero for what the energy does not depend on.
    """

    values: Values
    parameters: tuple[Symbol, ...]
    energy: Expr
    along: Mapping[Symbol, Expr]


def mixed_model(functional: Functional, variant: Variant) -> MixedModel:
    """Derive the mixed derivatives of a functional; `variant` is one with `mixed`, or without."""
    values = values_of(functional, variant)
    energy = functional.corner_factor * variant_density(functional, variant)
    parameters = tuple(symbol(name) for name in functional.parameters)
    along: dict[Symbol, Expr] = {}
    for given in (*values.planes, *parameters):
        along[given] = differentiate_along(differentiate(energy, given), values.in_plane)
    # The gradient in the position names the slopes of values that move, each once.
    for value, slopes in values.in_plane.items():
        factor = differentiate(energy, value)
        for slope, direction in zip(slopes, POSITION_DIRECTION, strict=True):
            if slope in along and factor != 0:
                along[slope] += factor * direction
    return MixedModel(values, parameters, energy, {given: sympy.sympify(entry) for given, entry in along.items()})
