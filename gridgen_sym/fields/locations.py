"""Where the values of a plane belong: to the nodes, the cells or the corners of a grid."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from .sampled import nodal

#: The node of each corner of a cell (i, j), as offsets, in the order of `corner_jacobians`: counter-clockwise.
_OFFSETS = ((0, 0), (1, 0), (1, 1), (0, 1))


def location(plane: npt.NDArray[Any], shape: tuple[int, int]) -> str:
    """Return what an entry of a plane belongs to: `node`, `cell` or `corner` of a grid of this shape."""
    return "corner" if plane.ndim == 3 else "node" if plane.shape == shape else "cell"


def at_nodes(plane: Array, shape: tuple[int, ...]) -> Array:
    """Return a plane per node, cell or corner as values at the nodes: means over the cells around each."""
    if plane.shape == shape:
        return plane
    return nodal(plane.mean(axis=0) if plane.ndim == 3 else plane)


def at_one_location(planes: list[Array], shape: tuple[int, int]) -> list[Array]:
    """Return planes at one location: where they are, if that is one, else at the corners (4, ni-1, nj-1)."""
    if len({plane.shape for plane in planes}) == 1:
        return planes
    return [_at_corners(plane, shape) for plane in planes]


def first_place(
    where: npt.NDArray[np.bool_], shape: tuple[int, int], points: tuple[Array, Array], names: Iterable[str]
) -> str:
    """Return the place of the first true entry of a plane in words, such as `node (2, 3), x = 0.5, y = 0.25`.

    Args:
        where: a plane of truth values.
        shape: (ni, nj) of the grid.
        points: the coordinates of the nodes.
        names: of the coordinates.
    """
    index = first_index(where)
    kind = location(where, shape)
    node = index
    if kind == "corner":
        offset = _OFFSETS[index[0]]
        node = (index[1] + offset[0], index[2] + offset[1])
    if kind == "cell":
        return f"cell {index}"
    at = ", ".join(f"{name} = {part[node]:.6g}" for name, part in zip(names, points, strict=True))
    return f"{kind} {index}, {at}"


def first_index(where: npt.NDArray[np.bool_]) -> tuple[int, ...]:
    """Return the index of the first true entry."""
    return tuple(int(k) for k in np.argwhere(where)[0])


def _at_corners(plane: Array, shape: tuple[int, int]) -> Array:
    if plane.ndim == 3:
        return plane
    if plane.shape != shape:
        return np.stack([plane] * 4)
    ni, nj = shape
    return np.stack([plane[i : ni - 1 + i, j : nj - 1 + j] for i, j in _OFFSETS])
