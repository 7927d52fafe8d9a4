"""Grids within differentiable programs of JAX (the extra `jax`): `optimize` as a function with derivatives.

JAX must work in double precision: `jax.config.update("jax_enable_x64", True)`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from .errors import GridgenError, MissingExtraError
from .functionals import Functional
from .sensitivities.functions import GridFunction, grid_function, split_data


def optimize(
    nodes: Any,  # noqa: ANN401 - arrays of JAX have no types here
    functional: str | Functional,
    *,
    parameters: Any = None,  # noqa: ANN401
    weight: Any = None,  # noqa: ANN401
    fields: Any = None,  # noqa: ANN401
    target: Any = None,  # noqa: ANN401
    walls: Any = None,  # noqa: ANN401
    slide: Any = None,  # noqa: ANN401
    **options: Any,  # noqa: ANN401
) -> Any:  # noqa: ANN401
    """Return the nodes of the grid that minimizes a functional, differentiable in reverse mode.

    It may stand within `jit`, whose second call compiles nothing, and within `vmap`, which solves one grid after the
    other. A result that has not converged is an error where it is differentiated.

    Args:
        nodes: of the start, (ni, nj, 2); those that do not move are differentiated.
        functional: what is minimized.
        parameters: its values, by name.
        weight: an array per node, cell or corner.
        fields: the same of declared fields, by name.
        target: the nodes of a reference grid, (ni, nj, 2).
        walls: by side, mappings of what a `Wall` takes; `first` and `growth` are differentiated.
        slide: as in `gridgen_sym.optimize`; points (n, 2) of curves are differentiated.
        options: what else `gridgen_sym.optimize` takes, not differentiated.

    Returns:
        (ni, nj, 2).

    Raises:
        GridgenError: where JAX works in single precision.
        MissingExtraError: without JAX.
    """
    try:
        import jax
        import jax.numpy as jnp
    except ImportError:
        raise MissingExtraError("a grid within a program of JAX", "jax", "jax") from None
    if jnp.zeros(0, dtype=float).dtype != np.float64:
        raise GridgenError(
            'grids need double precision: call jax.config.update("jax_enable_x64", True) before the first array is made'
        )
    given = {"nodes": nodes, "parameters": parameters, "weight": weight, "fields": fields, "target": target}
    data, static = split_data({**given, "walls": walls, "slide": slide})
    arrays = jax.tree_util.tree_map(lambda one: jnp.asarray(one, dtype=jnp.float64), data)
    return _differentiable(grid_function(functional, {**static, **options}))(arrays)


@lru_cache(maxsize=32)
def _differentiable(function: GridFunction) -> Any:  # noqa: ANN401
    """Return a function of data as JAX differentiates it, once for every function."""
    import jax

    shape_of: Any = jax.ShapeDtypeStruct

    def shapes(data: Any) -> Any:  # noqa: ANN401
        return jax.tree_util.tree_map(lambda one: shape_of(one.shape, one.dtype), data)

    def numbers(data: Any) -> Any:  # noqa: ANN401
        return jax.tree_util.tree_map(np.asarray, data)

    def on_host(data: Any) -> Any:  # noqa: ANN401
        return function.nodes(numbers(data))

    def pulled_back(data: Any, cotangent: Any) -> Any:  # noqa: ANN401
        return function.pullback(numbers(data), np.asarray(cotangent))

    @jax.custom_vjp
    def solve(data: Any) -> Any:  # noqa: ANN401
        return jax.pure_callback(on_host, shapes(data["nodes"]), data, vmap_method="sequential")

    def forward(data: Any) -> Any:  # noqa: ANN401
        return solve(data), data

    def backward(data: Any, cotangent: Any) -> Any:  # noqa: ANN401
        return (jax.pure_callback(pulled_back, shapes(data), data, cotangent, vmap_method="sequential"),)

    solve.defvjp(forward, backward)
    return solve
