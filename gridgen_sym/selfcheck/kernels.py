"""The kernels against each other: C against NumPy, and the Hessian against differences of the gradient."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..arrays import Array
from ..functionals import Functional
from ..runtime import KernelSet, find_compiler, kernels
from .check import Check, difference

_SIZE = (9, 70)
#: Step of the differences of gradients.
_STEP = 1e-5


def _random_nodes() -> Array:
    """Return unit squares with noise in every node, (2, ni, nj)."""
    ni, nj = _SIZE
    nodes = np.stack(np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij")).astype(float)
    return nodes + 0.08 * np.random.default_rng(3).normal(size=nodes.shape)


def _apart(found: Any, expected: Any, floor: float) -> float:  # noqa: ANN401
    """Return the largest difference of two arrays over the largest expected value; nan where one is not finite.

    Expected values below `floor` are taken for it: what ought to vanish does so up to round-off only.
    """
    found, expected = np.asarray(found), np.asarray(expected)
    return float(np.abs(found - expected).max() / max(np.abs(expected).max(), floor))


def _floor(functional: Functional) -> float:
    """Return a thousandth of a cell's energy on the random grid, or of 1."""
    nodes = _random_nodes()
    return 1e-3 * abs(kernels(functional, backend="numpy").energy(nodes)[0]) / nodes[0].size or 1e-3


def hessian_kernel(functional: Functional) -> Check:
    """Compare Hessian times vector with a difference of gradients, at the free nodes."""
    from ..grids import Grid
    from ..solvers import gradient, hessian

    nodes = _random_nodes()
    move = np.random.default_rng(4).normal(size=nodes.shape)
    move[:, [0, -1]] = 0.0
    move[:, :, [0, -1]] = 0.0
    ahead, behind = (
        gradient(Grid.from_planes(*(nodes + sign * _STEP * move)), functional)[1:-1, 1:-1].ravel() for sign in (1, -1)
    )
    product = hessian(Grid.from_planes(*nodes), functional) @ np.moveaxis(move, 0, -1)[1:-1, 1:-1].ravel()
    return difference(
        "Hessian kernel against differences of the gradient kernel",
        _apart(product, (ahead - behind) / (2 * _STEP), _floor(functional)),
        1e-6,
    )


def backends(functional: Functional) -> Check:
    """Compare all compiled kernels with NumPy's."""
    name = f"C kernels against NumPy kernels on {_SIZE[0]} x {_SIZE[1]} nodes"
    if find_compiler() is None:
        return Check(name, 0.0, 0.0, True, f"{name}: not done, there is no C compiler")
    try:
        compiled, plain = (_outputs(kernels(functional, backend=backend)) for backend in ("c", "numpy"))
    except ArithmeticError as error:
        return Check(name, math.nan, 1e-10, False, f"{name}: {type(error).__name__}: {error}")
    floor = _floor(functional)
    return difference(name, float(np.max([_apart(a, b, floor) for a, b in zip(compiled, plain, strict=True)])), 1e-10)


def _outputs(kernel: KernelSet) -> list[Any]:
    """Return what every kernel makes of the same random grid."""
    nodes = _random_nodes()
    fixed = np.ones(_SIZE, dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    swept, relaxed = nodes.copy(), nodes.copy()
    kernel.sweep(swept, None, fixed, 3, floor=0.0)
    kernel.euler_lagrange_relaxation(relaxed, None, fixed, 3, 0.5)
    return [
        *kernel.energy_gradient(nodes),
        kernel.energy(nodes)[0],
        kernel.hessian(nodes),
        kernel.hessian(nodes, semidefinite=True),
        kernel.euler_lagrange_residual(nodes),
        kernel.euler_lagrange_jacobian(nodes),
        kernel.euler_lagrange_jacobian(nodes, frozen=True),
        swept,
        relaxed,
    ]
