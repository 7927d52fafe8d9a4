"""The kernels against each other: C against NumPy, and the Hessian against differences of the gradient."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..functionals import Functional
from ..functionals.variant import Variant
from ..runtime import KernelSet, find_compiler, kernels
from .check import Check, both_zero, difference, failure
from .samples import active_size, mean_slope
from .setting import Setting

_SIZE = (9, 70)
#: Steps of the logical coordinates.
_SPACING = (0.5, 0.8)
#: Steps of the differences of gradients, over the size of a cell: near a kink the long ones cross it.
_STEPS = (1e-4, 1e-5, 1e-6, 1e-7)
_HESSIAN_LIMIT, _BACKEND_LIMIT = 1e-6, 1e-10


def _random_nodes(functional: Functional) -> Array:
    """Return nodes (2, ni, nj) of a map that stretches by the active size, with noise in every node."""
    ni, nj = _SIZE
    nodes = np.stack(np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij")).astype(float)
    noisy = nodes + 0.08 * np.random.default_rng(3).normal(size=nodes.shape)
    return np.asarray(active_size(functional) * noisy * np.array(_SPACING)[:, None, None])


def _apart(found: Any, expected: Any, floor: float) -> float:  # noqa: ANN401
    """Return the largest difference of two arrays over the largest expected value; nan where one is not finite.

    Expected values below `floor` are taken for it: what ought to vanish does so up to round-off only.
    """
    found, expected = np.asarray(found), np.asarray(expected)
    return float(np.abs(found - expected).max() / max(np.abs(expected).max(), floor))


def _values(setting: Setting, nodes: Array, size: float) -> Array | None:
    """Return the planes of a grid's values; None where there are none."""
    names = kernels(setting.functional, setting.variant, backend="numpy").planes
    xi, eta = np.meshgrid(*(np.linspace(0, 1, count) for count in _SIZE), indexing="ij")
    values = {"x": nodes[0], "y": nodes[1], "xi": xi, "eta": eta, "size": size}
    return setting.planes(names, values, _SIZE) if names else None


def _floor(setting: Setting, nodes: Array, values: Array | None) -> float:
    """Return a thousandth of a cell's energy on the random grid, or of 1."""
    kernel = kernels(setting.functional, setting.variant, backend="numpy")
    return 1e-3 * abs(kernel.energy(nodes, values, _SPACING)[0]) / nodes[0].size or 1e-3


def hessian_kernel(functional: Functional, variant: Variant = "plain") -> Check:
    """Compare Hessian times vector with differences of gradients, at the free nodes.

    At every node the step counts with which the difference comes nearest: a long one may cross a kink, and a short
    one has few digits. A wrong Hessian is wrong with all of them.
    """
    from ..grids import Grid
    from ..solvers import gradient, hessian

    setting = Setting(functional, variant)
    name = f"Hessian kernel{setting.words} against differences of the gradient kernel"
    size, nodes = active_size(functional), _random_nodes(functional)
    move = size * np.random.default_rng(4).normal(size=nodes.shape)
    move[:, [0, -1]] = 0.0
    move[:, :, [0, -1]] = 0.0

    given: dict[str, Any] = {"spacing": _SPACING}
    if setting.words:
        given |= {"fields": setting.fields(size), "target": setting.target()}

    def slope(step: float) -> Array:
        ahead, behind = (
            gradient(Grid.from_planes(*(nodes + sign * step * move)), functional, **given)[1:-1, 1:-1].ravel()
            for sign in (1, -1)
        )
        return np.asarray((ahead - behind) / (2 * step))

    with np.errstate(all="ignore"):
        matrix = hessian(Grid.from_planes(*nodes), functional, **given)
        product = matrix @ np.moveaxis(move, 0, -1)[1:-1, 1:-1].ravel()
        differences = np.stack([slope(step) for step in _STEPS])
    if not differences.any() and not product.any():
        return both_zero(name, _HESSIAN_LIMIT)
    nearest = np.abs(differences - product).argmin(axis=0)
    expected = np.take_along_axis(differences, nearest[None], axis=0)[0]
    return difference(name, _apart(product, expected, 1e-3 * mean_slope(functional, size) or 1e-3), _HESSIAN_LIMIT)


def backends(functional: Functional, variant: Variant = "plain") -> Check:
    """Compare all compiled kernels with NumPy's."""
    setting = Setting(functional, variant)
    name = f"C kernels{setting.words} against NumPy kernels on {_SIZE[0]} x {_SIZE[1]} nodes"
    if find_compiler() is None:
        return Check(name, 0.0, 0.0, True, f"{name}: not done, there is no C compiler")
    nodes = _random_nodes(functional)
    try:
        with np.errstate(all="ignore"):
            values = _values(setting, nodes, active_size(functional))
            compiled, plain = (
                _outputs(kernels(functional, variant, backend=backend), nodes, values) for backend in ("c", "numpy")
            )
    except ArithmeticError as error:
        return failure(name, _BACKEND_LIMIT, f"{type(error).__name__}: {error}")
    if not any(np.any(outputs[k]) for outputs in (compiled, plain) for k in _DERIVATIVES):
        return both_zero(name, _BACKEND_LIMIT)
    floor = _floor(setting, nodes, values)
    apart = [_apart(a, b, floor) for a, b in zip(compiled, plain, strict=True)]
    return difference(name, float(np.max(apart)), _BACKEND_LIMIT)


#: Positions of gradient and Hessian among the outputs.
_DERIVATIVES = (2, 4)


def _outputs(kernel: KernelSet, nodes: Array, values: Array | None) -> list[Any]:
    """Return what every kernel makes of the same grid."""
    fixed = np.ones(_SIZE, dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    swept, relaxed = nodes.copy(), nodes.copy()
    kernel.sweep(swept, values, fixed, 3, _SPACING, floor=0.0)
    kernel.euler_lagrange_relaxation(relaxed, values, fixed, 3, 0.5, _SPACING)
    return [
        *kernel.energy_gradient(nodes, values, _SPACING),
        kernel.energy(nodes, values, _SPACING)[0],
        kernel.hessian(nodes, values, _SPACING),
        kernel.hessian(nodes, values, _SPACING, semidefinite=True),
        kernel.euler_lagrange_residual(nodes, values, _SPACING),
        kernel.euler_lagrange_jacobian(nodes, values, _SPACING),
        kernel.euler_lagrange_jacobian(nodes, values, _SPACING, frozen=True),
        swept,
        relaxed,
    ]
