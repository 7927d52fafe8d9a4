"""The discrete gradient against the Euler–Lagrange residual, to which it must tend at second order."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..arrays import Array
from ..functionals import Functional
from ..runtime import kernels
from .check import Check
from .derived import FIRST, SECOND, written_out

_COARSE, _FINE = 16, 32


def convergence(functional: Functional) -> Check:
    """Measure the order at which the discrete gradient tends to minus the Euler–Lagrange residual."""
    from ..symbolic import euler_lagrange

    residual = _residual_function(functional, euler_lagrange(functional).residual)
    coarse, fine = (_error(functional, residual, cells) for cells in (_COARSE, _FINE))
    name = "discrete gradient against the Euler–Lagrange residual"
    if fine < 1e-9:  # A null Lagrangian: both vanish.
        return Check(name, fine, 1e-9, True, f"{name}: equal to {fine:.1e}")
    order = math.log2(coarse / fine) if coarse > 0 else math.nan
    text = f"{name}: error {coarse:.1e} at {_COARSE} cells, {fine:.1e} at {_FINE}: order {order:.2f} (at least 1.8)"
    return Check(name, order, 1.8, order >= 1.8, text)


def _residual_function(functional: Functional, residual: tuple[Any, Any]) -> Callable[[Mapping[str, Array]], Array]:
    import sympy

    names = [*FIRST, *SECOND]
    values = {sympy.Symbol(name, real=True): value for name, value in functional.parameters.items()}
    parts = [written_out(part).subs(values) for part in residual]
    function = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], parts, "numpy", cse=True)
    shape = (_COARSE + 1, _COARSE + 1)
    return lambda jets: np.stack([np.broadcast_to(part, shape) for part in function(*(jets[n] for n in names))])


def _error(functional: Functional, residual: Callable[[Mapping[str, Array]], Array], cells: int) -> float:
    """Return the error at the nodes of the coarse grid, over the largest residual (or energy, if there is none).

    The median over the nodes counts, so that the few at a kink of abs() do not decide.
    """
    nodes, jets = _smooth_map(cells)
    every = cells // _COARSE
    energy, _, gradient = kernels(functional, backend="numpy").energy_gradient(nodes)
    found = gradient[:, ::every, ::every][:, 1:-1, 1:-1] / (4 * functional.corner_factor)
    expected = -residual({name: jet[::every, ::every] for name, jet in jets.items()})[:, 1:-1, 1:-1]
    scale = np.abs(expected).max()
    floor = 1e-9 * abs(energy) / nodes[0].size
    return float(np.median(np.abs(found - expected)) / max(scale, floor or 1.0))


def _smooth_map(cells: int) -> tuple[Array, dict[str, Array]]:
    """Return x = u + v/5 + sin(2u + v)/7, y = u/10 + 11v/10 + cos(u - 2v)/8 at the nodes, and its derivatives.

    They are taken in the coordinates in which cells are unit squares.
    """
    h = np.array([1.0, 0.8]) / cells
    u, v = np.meshgrid(h[0] * np.arange(cells + 1), h[1] * np.arange(cells + 1), indexing="ij")
    p, q = 2 * u + v, u - 2 * v
    jets = {
        "x_xi": 1 + 2 * np.cos(p) / 7, "x_eta": 0.2 + np.cos(p) / 7,
        "y_xi": 0.1 - np.sin(q) / 8, "y_eta": 1.1 + np.sin(q) / 4,
        "x_xixi": -4 * np.sin(p) / 7, "x_xieta": -2 * np.sin(p) / 7, "x_etaeta": -np.sin(p) / 7,
        "y_xixi": -np.cos(q) / 8, "y_xieta": np.cos(q) / 4, "y_etaeta": -np.cos(q) / 2,
    }  # fmt: skip
    for name in jets:
        jets[name] *= h[0] ** name.count("xi") * h[1] ** name.count("eta")
    nodes = np.stack([u + v / 5 + np.sin(p) / 7, u / 10 + 1.1 * v + np.cos(q) / 8])
    return nodes, jets
