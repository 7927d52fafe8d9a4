"""Grids within differentiable programs of PyTorch (the extra `torch`): `optimize` as a function with derivatives."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from .errors import GridgenError, MissingExtraError
from .functionals import Functional
from .sensitivities.functions import grid_function, leaves, nested, split_data


def optimize(
    nodes: Any,  # noqa: ANN401 - tensors have no types here
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
    """Return the nodes of the grid that minimizes a functional, a tensor that can be differentiated once.

    A result that has not converged is an error where it is differentiated.

    Args:
        nodes: of the start, (ni, nj, 2), in double precision; those that do not move are differentiated.
        functional: what is minimized.
        parameters: its values, by name.
        weight: a tensor per node, cell or corner.
        fields: the same of declared fields, by name.
        target: the nodes of a reference grid, (ni, nj, 2).
        walls: by side, mappings of what a `Wall` takes; `first` and `growth` are differentiated.
        slide: as in `gridgen_sym.optimize`; points (n, 2) of curves are differentiated.
        options: what else `gridgen_sym.optimize` takes, not differentiated.

    Returns:
        (ni, nj, 2).

    Raises:
        GridgenError: for tensors in single precision.
        MissingExtraError: without PyTorch.
    """
    try:
        import torch
    except ImportError:
        raise MissingExtraError("a grid within a program of PyTorch", "torch", "torch") from None
    given = {"nodes": nodes, "parameters": parameters, "weight": weight, "fields": fields, "target": target}
    data, static = split_data({**given, "walls": walls, "slide": slide})
    paths, values = zip(*leaves(data), strict=True)
    for path, value in zip(paths, values, strict=True):
        if isinstance(value, torch.Tensor) and value.dtype != torch.float64:
            raise GridgenError(
                f"grids need double precision; {'.'.join(path)} is a tensor of {value.dtype}: use .double()"
            )
    tensors = [torch.as_tensor(value, dtype=torch.float64) for value in values]
    return _function().apply(grid_function(functional, {**static, **options}), paths, *tensors)


@lru_cache(maxsize=1)
def _function() -> Any:  # noqa: ANN401
    """Return the function of tensors."""
    import torch

    class Minimum(torch.autograd.Function):
        """The nodes of a minimum."""

        @staticmethod
        def forward(context: Any, function: Any, paths: Any, *tensors: Any) -> Any:  # noqa: ANN401
            """Solve."""
            context.save_for_backward(*tensors)
            context.function, context.paths = function, paths
            arrays = [tensor.detach().cpu().numpy() for tensor in tensors]
            return torch.from_numpy(np.array(function.nodes(nested(list(paths), arrays))))

        @staticmethod
        @torch.autograd.function.once_differentiable
        def backward(context: Any, cotangent: Any) -> Any:  # noqa: ANN401
            """Solve the adjoint system."""
            arrays = [tensor.detach().cpu().numpy() for tensor in context.saved_tensors]
            data = nested(list(context.paths), arrays)
            found = context.function.pullback(data, cotangent.detach().cpu().numpy())
            gradients = [torch.from_numpy(np.array(one)) for _, one in leaves(found)]
            return None, None, *gradients

    return Minimum
