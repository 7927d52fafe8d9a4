"""Meshes of Gmsh as quadrilaterals with a polynomial map each."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import GridgenError
from ..io.gmsh_mesh import GmshMesh, Group, decode_mesh
from .mesh import QuadrilateralMesh

#: The orders of lines and of quadrilaterals, by their types.
_LINES = {1: 1, 8: 2, 26: 3, 27: 4, 28: 5}
_QUADRILATERALS = {3: 1, 10: 2, 36: 3, 37: 4, 38: 5}
_CURVE = 1


def decode(data: bytes) -> QuadrilateralMesh:
    """Return the mesh of a file; boundaries have the names, or else the tags, of physical groups of curves.

    Raises:
        GridgenError: for what is no mesh of Gmsh, elements of several orders or none, and nodes that are missing or not
            in one plane z = constant.
    """
    mesh = decode_mesh(data)
    chosen = [group for group in mesh.groups if group.type in _QUADRILATERALS and len(group.nodes)]
    orders = {_QUADRILATERALS[group.type] for group in chosen}
    if len(orders) != 1:
        told = f"quadrilaterals of the orders {', '.join(map(str, sorted(orders)))}" if orders else "no quadrilaterals"
        raise GridgenError(f"it has {told}; a layout needs quadrilaterals of one order")
    (order,) = orders
    lattice = np.concatenate([_counterclockwise(_places(mesh, group)[:, _lattice(order)], mesh) for group in chosen])
    corners = lattice[:, [0, -1, -1, 0], [0, 0, -1, -1]]
    # In version 2.2 an element of several physical groups stands there as often.
    once = np.sort(np.unique(np.sort(corners, axis=1), axis=0, return_index=True)[1])
    corners, lattice = corners[once], lattice[once]
    points = mesh.points[lattice.ravel()]
    if not np.isfinite(points).all() or np.ptp(points[:, 2]) > 1e-9 * np.ptp(points[:, :2]):
        raise GridgenError("its nodes must be finite, and in one plane z = constant")
    nodes = mesh.points[lattice][..., :2]
    return QuadrilateralMesh(corners, nodes, np.linspace(0, 1, order + 1), *_boundary(mesh))


def _places(mesh: GmshMesh, group: Group) -> NDArray[np.intp]:
    """Return the numbers of the nodes of elements, counted from 0."""
    order = np.argsort(mesh.tags, kind="stable")
    at = np.minimum(np.searchsorted(mesh.tags[order], group.nodes), len(order) - 1)
    found = order[at] if len(order) else np.zeros_like(group.nodes)
    if not len(order) or not np.array_equal(mesh.tags[found], group.nodes):
        raise GridgenError("its elements name nodes that it does not have")
    return found


def _lattice(order: int) -> NDArray[np.intp]:
    """Return where the nodes of an element are in its list, (order + 1, order + 1).

    The list has the corners, the inner nodes of the four edges, all counter-clockwise, and then the same of what is
    left inside.
    """
    found = np.zeros((order + 1, order + 1), dtype=np.intp)
    first = 0
    for low, high in zip(range(order // 2 + 1), range(order, -1, -1), strict=False):
        if low == high:
            found[low, low] = first
            break
        ring = [(low, low), (high, low), (high, high), (low, high)]
        inner = np.arange(1, high - low)
        for one, other in pairwise([*ring, ring[0]]):
            step = np.sign(np.subtract(other, one))
            found[one] = first + ring.index(one)
            begin = first + 4 + ring.index(one) * len(inner)
            for k in inner.tolist():
                found[tuple(np.add(one, k * step))] = begin + k - 1
        first += 4 * (high - low)
    return found


def _counterclockwise(lattice: NDArray[np.intp], mesh: GmshMesh) -> NDArray[np.intp]:
    """Return the elements of a surface, all of them mirrored if the surface is seen from below."""
    x, y = _around(lattice, mesh.points)
    area = float(np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)))
    return lattice if area >= 0 else lattice.transpose(0, 2, 1)


def _around(lattice: NDArray[np.intp], points: Array) -> tuple[Array, Array]:
    corners = points[lattice[:, [0, -1, -1, 0], [0, 0, -1, -1]]]
    return corners[..., 0], corners[..., 1]


def _boundary(mesh: GmshMesh) -> tuple[NDArray[np.intp], dict[int, str]]:
    """Return the ends of edges in physical groups of curves with the tags of these, (m, 3), and the names of groups."""
    rows = [np.empty((0, 3), dtype=np.intp)]
    for group in mesh.groups:
        if group.type in _LINES and len(group.nodes):
            ends = _places(mesh, group)[:, :2]
            rows += [np.column_stack((ends, np.full(len(ends), tag))) for tag in group.physical]
    return np.concatenate(rows), {tag: name for (kind, tag), name in mesh.names.items() if kind == _CURVE}
