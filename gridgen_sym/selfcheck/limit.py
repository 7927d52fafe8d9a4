"""The discrete gradient against the Euler–Lagrange residual, to which it must tend at second order.

On a smooth map the grid is refined until two orders of convergence in a row are right: a density with a steep part
comes to its order late. Where both sides vanish, as those of a null Lagrangian do, round-off is all that may be left.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ..arrays import Array
from ..functionals import Functional
from ..functionals.variant import Variant
from ..runtime import kernels
from .check import Check, both_zero, failure
from .derived import written_out
from .samples import active_size, mean_slope
from .setting import Setting

_NAME = "discrete gradient against the Euler–Lagrange residual"
#: Cells of the refinements; what is compared are the nodes of the first.
_CELLS = (16, 32, 64, 128, 256, 512)
_ORDER = 1.8
#: Round-off of both sides over the slope of a corner, at most; errors within so many times its measure are round-off.
_ROUND_OFF, _SAFETY = 1e-10, 10.0

Residual = Callable[[Mapping[str, Any]], Array]


@dataclass(frozen=True, slots=True)
class _Level:
    """What one refinement shows: medians over the nodes, so that the few at a kink do not decide.

    Attributes:
        cells: number of cells along a side.
        error: of the discrete gradient.
        round_off: what of it is round-off: how much the gradient changes where the grid is only moved.
        size: the largest expected residual.
        found: the gradient.
    """

    cells: int
    error: float
    round_off: float
    size: float
    found: float

    @property
    def relative(self) -> float:
        """The error over the residual."""
        return self.error / self.size


def convergence(functional: Functional, variant: Variant = "plain") -> Check:
    """Measure the order at which the discrete gradient tends to minus the Euler–Lagrange residual."""
    setting = Setting(functional, variant)
    found = _convergence(setting)
    return replace(found, name=found.name + setting.words, text=found.text.replace(_NAME, _NAME + setting.words))


def _convergence(setting: Setting) -> Check:
    from ..symbolic import euler_lagrange

    functional = setting.functional
    residual = _residual_function(setting, euler_lagrange(functional, setting.variant).residual)
    size = active_size(functional)
    slope = mean_slope(functional, size)
    levels: list[_Level] = []
    for cells in _CELLS:
        with np.errstate(all="ignore"):
            levels.append(_level(setting, residual, cells, size))
        last = levels[-1]
        if not math.isfinite(last.error + last.size):
            return failure(_NAME, _ORDER, f"not finite at {cells} cells")
        if last.size <= _ROUND_OFF * slope:
            return _both_vanish(last, slope)
        if last.error <= _SAFETY * last.round_off:
            text = f"{_NAME}: equal to {last.relative:.1e} at {cells} cells, which is round-off"
            return Check(_NAME, last.relative, _SAFETY * last.round_off / last.size, True, text)
        if len(levels) > 2 and min(_orders(levels)[-2:]) >= _ORDER:
            break
    return _judged(levels)


def _orders(levels: list[_Level]) -> list[float]:
    return [math.log2(a.relative / b.relative) for a, b in pairwise(levels)]


def _judged(levels: list[_Level]) -> Check:
    """Return the check by the last order of convergence."""
    *_, before, last = levels
    order = _orders(levels)[-1]
    text = (
        f"{_NAME}: error {before.relative:.1e} at {before.cells} cells, {last.relative:.1e} at {last.cells}: "
        f"order {order:.2f} (at least {_ORDER})"
    )
    return Check(_NAME, order, _ORDER, order >= _ORDER, text)


def _both_vanish(level: _Level, slope: float) -> Check:
    """Return the check where the residual vanishes: the gradient must vanish beside the slope of a corner."""
    if level.size == level.found == slope == 0:
        return both_zero(_NAME, _ROUND_OFF)
    found = level.found / slope if slope else math.inf
    text = f"{_NAME}: both vanish, the gradient to {found:.1e} of a corner's slope (at most {_ROUND_OFF:.0e})"
    return Check(_NAME, found, _ROUND_OFF, found <= _ROUND_OFF, text)


def _residual_function(setting: Setting, residual: tuple[Any, Any]) -> Residual:
    import sympy

    values = {sympy.Symbol(name, real=True): value for name, value in setting.functional.parameters.items()}
    parts = [written_out(part).subs(values) for part in residual]
    names = sorted({str(name) for part in parts for name in part.free_symbols})
    function = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], parts, "numpy", cse=True)
    shape = (_CELLS[0] + 1, _CELLS[0] + 1)

    def at(jets: Mapping[str, Any]) -> Array:
        known = {**jets, **setting.given(jets)}
        return np.stack([np.broadcast_to(part, shape) for part in function(*(known[name] for name in names))])

    return at


def _level(setting: Setting, residual: Residual, cells: int, size: float) -> _Level:
    """Compare gradient and residual on a grid of `cells` x `cells` cells, of a map that stretches by about `size`."""
    spacing = 1.0 / cells, 0.8 / cells
    nodes, jets = _smooth_map(cells, spacing, size)
    every = cells // _CELLS[0]
    inner = (slice(None), *(slice(every, -every, every),) * 2)
    kernel = kernels(setting.functional, setting.variant, backend="numpy")
    scale = 4 * setting.functional.corner_factor * spacing[0] * spacing[1]
    values = setting.planes(kernel.planes, jets, (cells + 1, cells + 1)) if kernel.planes else None
    found, moved = (
        kernel.energy_gradient(place, values, spacing)[2][inner] / scale for place in (nodes, nodes + 0.37 * size)
    )
    coarse = {name: jet[::every, ::every] if isinstance(jet, np.ndarray) else jet for name, jet in jets.items()}
    expected = -residual(coarse)[:, 1:-1, 1:-1]
    return _Level(
        cells=cells,
        error=float(np.median(np.abs(found - expected))),
        round_off=float(np.median(np.abs(found - moved))),
        size=float(np.abs(expected).max()),
        found=float(np.median(np.abs(found))),
    )


def _smooth_map(cells: int, h: tuple[float, float], scale: float) -> tuple[Array, dict[str, Any]]:
    """Return x = u + v/5 + sin(2u + v)/7, y = u/10 + 11v/10 + cos(u - 2v)/8 at nodes with steps h, and its derivatives.

    Both are multiplied by `scale`. With the derivatives come the places, and `size`.
    """
    u, v = np.meshgrid(h[0] * np.arange(cells + 1), h[1] * np.arange(cells + 1), indexing="ij")
    p, q = 2 * u + v, u - 2 * v
    jets = {
        "x_xi": 1 + 2 * np.cos(p) / 7, "x_eta": 0.2 + np.cos(p) / 7,
        "y_xi": 0.1 - np.sin(q) / 8, "y_eta": 1.1 + np.sin(q) / 4,
        "x_xixi": -4 * np.sin(p) / 7, "x_xieta": -2 * np.sin(p) / 7, "x_etaeta": -np.sin(p) / 7,
        "y_xixi": -np.cos(q) / 8, "y_xieta": np.cos(q) / 4, "y_etaeta": -np.cos(q) / 2,
    }  # fmt: skip
    jets = {name: scale * jet for name, jet in jets.items()}
    nodes = scale * np.stack([u + v / 5 + np.sin(p) / 7, u / 10 + 1.1 * v + np.cos(q) / 8])
    return nodes, jets | {"x": nodes[0], "y": nodes[1], "xi": u, "eta": v, "size": scale}
