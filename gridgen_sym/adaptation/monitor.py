"""Monitor functions: from a solution on a grid to a density of nodes.

A monitor first measures the features of the solution at every node, m >= 0, and then makes a density of it, which is 1
where there are none. The intensity alpha follows from the one parameter, the fraction of the nodes that features are to
have: (the integral of density - 1)/(the integral of density) = feature_fraction. So it has no unit, and needs no tuning
when the solution is scaled. W. Huang and R. D. Russell, *Adaptive Moving Mesh Methods*, Springer 2011, take about 1/2.

| name | m | density | source |
| --- | --- | --- | --- |
| `gradient` | length of grad u | 1 + alpha m | A. M. Winslow 1981, "Adaptive-mesh zoning by the equipotential method" |
| `arc_length` | length of grad u | sqrt(1 + alpha m²) | A. B. White 1979, "On selection of equidistributing meshes" |
| `curvature` | (a max(b, c^(4/5) a^(1/5)))^(1/3) | 1 + alpha m | Huang and Russell 2011: best for the L2 error |
| `recovery_error` | eta^(2/3)/J | 1 + alpha m | equidistributes Zienkiewicz and Zhu's indicator |
| `hierarchical_error` | eta^(2/5)/J | 1 + alpha m | equidistributes the hierarchical indicator |
| `values` | u | u | the density itself, given by the user; no alpha |

Gradient and Hessian are recovered from nodal values; a >= b are the absolute values of the Hessian's eigenvalues. The
L2 error of linear interpolation is smallest for the density (a b)^(1/3): a^(2/3) where features are round, such as the
singularity at a reflex corner. Across a front b is nearly 0, but no cell is longer than the domain: its width alone
changes, and the best density is a^(2/5). The maximum has both limits; c, the mean of a^(2/5) over the domain to the
power 5/2, makes it independent of units. The exponents of the indicators eta are those across a front: the error of
linear interpolation is h² u''/8, that of its gradient h u''/2, and eta, a norm over the cell, has another sqrt(h).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..deprecation import renamed_arguments
from ..errors import GridgenError, quoted
from ..grids import Grid
from .nodes import BlockNodes, Measure, Nodes, mean_of

#: Steps of bisection by which the intensity is found to round-off.
_BISECTIONS = 60
#: What rounding may add to nodal values, over the largest of them.
ROUNDING = 8 * float(np.finfo(float).eps)


def _slope(nodes: Nodes, values: Array) -> Array:
    return np.asarray(np.hypot(*nodes.gradient(values)))


def _curvature(nodes: Nodes, values: Array) -> Array:
    u_xx, u_xy, u_yy = nodes.hessian(values)
    mean, radius = np.abs(u_xx + u_yy) / 2, np.hypot((u_xx - u_yy) / 2, u_xy)
    large, small = mean + radius, np.abs(mean - radius)
    typical = mean_of(nodes, large**0.4) ** 2.5
    return np.asarray((large * np.maximum(small, typical**0.8 * large**0.2)) ** (1 / 3))


def _recovery_error(nodes: Nodes, values: Array) -> Array:
    return nodes.at_nodes(nodes.recovery_error(values) ** (2 / 3) / nodes.areas)


def _hierarchical_error(nodes: Nodes, values: Array) -> Array:
    return nodes.at_nodes(nodes.hierarchical_error(values) ** 0.4 / nodes.areas)


def _values(nodes: Nodes, values: Array) -> Array:
    return values


_MEASURES: dict[str, Callable[[Nodes, Array], Array]] = {
    "gradient": _slope,
    "arc_length": _slope,
    "curvature": _curvature,
    "recovery_error": _recovery_error,
    "hierarchical_error": _hierarchical_error,
    "values": _values,
}
#: The spacing of nodes along a side is the density to a power: -1 where a front meets the side, -1/2 where features are
#: round. The densities of indicators are steep at a singularity, and with -1 the nodes of its side crowd there while
#: those inside do not follow. Measured on an L and on fronts, with the recovery error: 1.26 of the uniform error and no
#: convergence with -1, 0.65 with -0.8, and no loss at fronts.
_SIDE_EXPONENTS = {"recovery_error": 0.8, "hierarchical_error": 0.8}


@dataclass(frozen=True, slots=True, init=False)
class Monitor:
    """How the density of nodes follows from a solution; the module's docstring has the formulas.

    Attributes:
        measure: what the density of nodes is made of: a name (`gradient`, `arc_length`, `curvature`, `recovery_error`,
            `hierarchical_error`, `values`), or your own function of the grid and the nodal values (ni, nj) that returns
            m >= 0, (ni, nj).
        feature_fraction: the fraction of the nodes that features get, at least 0 and below 1; not used by
            `values`.
        smoothing: how often the density is averaged over 3 x 3 nodes with binomial weights, in the logical square:
            cells grow more gently, and the adaptation settles sooner. After n passes a jump is about 2 sqrt(n) wide.
    """

    measure: str | Measure
    feature_fraction: float
    smoothing: int

    @renamed_arguments(share="feature_fraction")
    def __init__(
        self,
        measure: str | Measure = "curvature",
        feature_fraction: float = 0.75,
        smoothing: int = 2,
    ) -> None:
        """Check the arguments.

        Raises:
            GridgenError: for an unknown measure, or numbers out of their range.
        """
        if not callable(measure) and not (isinstance(measure, str) and measure in _MEASURES):
            raise GridgenError(
                f"unknown monitor {quoted(measure)}; known: {', '.join(_MEASURES)}, or your own function of the grid "
                "and the nodal values"
            )
        if not isinstance(feature_fraction, (int, float, np.number)) or not 0 <= feature_fraction < 1:
            raise GridgenError(
                "feature_fraction is the fraction of the nodes that features are to have, at least 0 and below 1; came "
                f"{quoted(feature_fraction)}"
            )
        if not isinstance(smoothing, (int, np.integer)) or smoothing < 0:
            raise GridgenError(f"smoothing is a number of passes, not negative; came {quoted(smoothing)}")
        for name, value in (("measure", measure), ("feature_fraction", feature_fraction), ("smoothing", smoothing)):
            object.__setattr__(self, name, value)

    @property
    def share(self) -> float:
        """The old name of `feature_fraction`; deprecated."""
        warnings.warn("Monitor.share is deprecated: it is called feature_fraction", DeprecationWarning, stacklevel=2)
        return self.feature_fraction

    @property
    def name(self) -> str:
        """The name of the measure; of your own function, its name in Python."""
        return repr(self.measure) if isinstance(self.measure, str) else getattr(self.measure, "__name__", "of yours")

    @property
    def side_exponent(self) -> float:
        """The power of the density that nodes along a side equidistribute."""
        return _SIDE_EXPONENTS.get(self.measure, 1.0) if isinstance(self.measure, str) else 1.0

    def density(self, grid: Grid, values: npt.ArrayLike) -> Array:
        """Return the density of nodes (ni, nj), positive, that nodal values (ni, nj) ask for.

        Raises:
            GridgenError: for values of another shape or not finite, a folded grid, or a measure that is negative,
                not finite, or of another shape.
        """
        nodes = BlockNodes(grid)
        return self.density_at(nodes, nodes.values(values, "nodal values"))

    def density_at(self, nodes: Nodes, u: Array) -> Array:
        """Return the same at the nodes of one block or several, for values that are checked."""
        if not isinstance(self.measure, str):
            m = nodes.measured(self.measure, u)
        else:
            m = nodes.values(nodes.given_back(_MEASURES[self.measure](nodes, u)), "a monitor's measure")
        if self.measure == "values":
            _check_positive(nodes, m, "density of nodes must be positive", smallest=np.finfo(float).tiny)
            return nodes.smoothed(m, self.smoothing)
        _check_positive(nodes, m, "measure of features must not be negative", smallest=0.0)
        return nodes.smoothed(self._intensified(nodes, self._above_round_off(nodes, u, m)), self.smoothing)

    def _above_round_off(self, nodes: Nodes, u: Array, m: Array) -> Array:
        """Return a measure m of values u, or zero if it is no larger than that of what rounding may add to u."""
        if not isinstance(self.measure, str):
            return m
        signs = np.random.default_rng(0).choice((-1.0, 1.0), u.shape)
        noise = np.asarray(_MEASURES[self.measure](nodes, ROUNDING * float(np.abs(u).max()) * signs))
        return m if m.max() > noise.max() else np.zeros_like(m)

    def _intensified(self, nodes: Nodes, m: Array) -> Array:
        """Return the density whose excess over 1 is `feature_fraction` of its integral."""
        if not m.any():  # Nothing to adapt to.
            return np.ones_like(m)
        m = m / mean_of(nodes, m)
        if self.measure != "arc_length":
            return 1 + self.feature_fraction / (1 - self.feature_fraction) * m
        # For alpha -> infinity the mean is that of sqrt(alpha) m; it grows with alpha.
        wanted = 1 / (1 - self.feature_fraction)
        low, high = 0.0, wanted**2
        for _ in range(_BISECTIONS):
            middle = (low + high) / 2
            low, high = (middle, high) if mean_of(nodes, np.sqrt(1 + middle * m**2)) < wanted else (low, middle)
        return np.asarray(np.sqrt(1 + high * m**2))


def as_monitor(monitor: Monitor | str | Measure) -> Monitor:
    """Return a monitor given in any form as a `Monitor`."""
    return monitor if isinstance(monitor, Monitor) else Monitor(monitor)


def _check_positive(nodes: Nodes, m: Array, what: str, *, smallest: float) -> None:
    if m.min() < smallest:
        raise GridgenError(
            f"a monitor's {what}: it is {m.min():.6g} at {nodes.place(m)}. Take its absolute value, or add "
            f"{1 - m.min():.6g} to it"
        )
