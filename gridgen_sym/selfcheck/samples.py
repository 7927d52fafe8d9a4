"""At which corners a functional is checked: of many sizes, since a penalty may act on small cells only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arrays import Array
from ..functionals import Functional
from .derived import FIRST, SECOND
from .setting import CORNER, Setting

#: Lengths of the edge vectors, in the order in which they are tried.
SIZES = (1.0, 1 / 8, 8.0, 1 / 64, 64.0)
_CORNERS = 500
#: Step of differences in floats, over the size of the corner.
_STEP = 1e-6


def random_jets(count: int, size: float) -> list[dict[str, float]]:
    """Return first and second derivatives of maps with J > 0, near a conformal map that stretches by `size`."""
    generator = np.random.default_rng(20)
    jets = []
    for _ in range(count):
        first = np.array([1.0, 0.0, 0.0, 1.0]) + generator.uniform(-0.3, 0.3, 4)
        values = zip((*FIRST, *SECOND), (*first, *generator.uniform(-1, 1, 6)), strict=True)
        jets.append({name: float(value) * size for name, value in values})
    return jets


def corner_slopes(functional: Functional, size: float) -> Array:
    """Return the slope of the bare density along a direction at random corners of a size, by differences."""
    generator = np.random.default_rng(21)
    corners = size * (np.array([[1.0], [0.0], [0.0], [1.0]]) + generator.uniform(-0.3, 0.3, (4, _CORNERS)))
    move = _STEP * size * generator.normal(size=(4, 1))
    ahead, behind = (_density(functional, corners + sign * move) for sign in (1, -1))
    with np.errstate(all="ignore"):
        return np.asarray((ahead - behind) / (2 * _STEP * size))


def mean_slope(functional: Functional, size: float) -> float:
    """Return the mean size of the slopes at random corners, beside which a sum of slopes is round-off; 0 if unknown."""
    slopes = np.abs(corner_slopes(functional, size))
    finite = slopes[np.isfinite(slopes)]
    return float(finite.mean()) if finite.size else 0.0


def active_size(functional: Functional) -> float:
    """Return the size at whose corners the density has most often a slope other than zero, 1 in doubt."""

    def share(size: float) -> float:
        slopes = corner_slopes(functional, size)
        return float((np.isfinite(slopes) & (slopes != 0)).mean())

    return max(SIZES, key=share)


def _density(functional: Functional, corners: Array) -> Array:
    """Return the values of the bare density at corners (4, n), with the weight 1 and fields held."""
    import sympy

    expression = functional.expression()
    names = sorted(str(name) for name in expression.free_symbols)
    evaluate = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], expression, "numpy")
    place = {name: np.float64(value) for name, value in CORNER.items()}
    values = dict(zip(FIRST, corners, strict=True)) | place | {"size": 1.0}
    known: Mapping[str, Any] = {**functional.parameters, **values, **Setting(functional, "plain").bare(values)}
    with np.errstate(all="ignore"):
        return np.broadcast_to(evaluate(*(known[name] for name in names)), corners.shape[1:])
