"""A mesh of quadrilaterals as one layer of hexahedra: faces between cells, and faces on the boundary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .unstructured import Indices, Mesh


@dataclass(frozen=True, slots=True)
class Layer:
    """Hexahedra, one for each quadrilateral.

    Attributes:
        points: those of the plane z = 0, then those of the other plane; (2 nodes, 3).
        inner: the faces between two cells, ordered by the cell of the lower number, then by the other; (n, 4).
        outer: for each patch its faces, of which the first point of a periodic one is that of its partner.
        back: the faces of the plane z = 0.
        front: those of the other plane.
        owners: the cells of all faces, in parts: inner, outer, back, front; the normal of a face leads out of it.
        neighbors: the other cells of the inner faces.
    """

    points: Array
    inner: Indices
    outer: tuple[Indices, ...]
    back: Indices
    front: Indices
    owners: tuple[Indices, ...]
    neighbors: tuple[Indices, ...]


def layer_of(mesh: Mesh) -> Layer:
    """Return the layer of hexahedra on a mesh, as thick as a cell is long on the average."""
    count, cells = len(mesh.points), mesh.cells
    flat = np.column_stack((mesh.points, np.zeros(count)))
    raised = flat + np.array([0.0, 0.0, _thickness(mesh)])
    edges = _Edges.of(cells, count)
    inner = np.flatnonzero(edges.neighbor >= 0)
    inner = inner[np.lexsort((edges.neighbor[inner], edges.owner[inner]))]
    outer = [np.roll(_upright(patch.edges, count), -1 if patch.shadow else 0, axis=1) for patch in mesh.patches]
    every = np.arange(len(cells))
    return Layer(
        points=np.concatenate((flat, raised)),
        inner=_upright(edges.nodes[inner], count),
        outer=tuple(outer),
        back=cells[:, ::-1],
        front=cells + count,
        owners=(edges.owner[inner], *(edges.cells(patch.edges, count) for patch in mesh.patches), every, every),
        neighbors=(edges.neighbor[inner],),
    )


def _thickness(mesh: Mesh) -> float:
    """Return the square root of the mean area of the cells."""
    a, b, c, d = (mesh.points[mesh.cells[:, corner]].T for corner in range(4))
    one, other = c - a, d - b  # The diagonals.
    doubled = np.abs(one[0] * other[1] - one[1] * other[0])
    return float(np.sqrt(doubled.mean() / 2)) or 1.0


def _upright(edges: Indices, count: int) -> Indices:
    """Return the faces on edges; the normal points to the right of an edge, out of the cell on its left."""
    return np.stack((edges[:, 0], edges[:, 1], edges[:, 1] + count, edges[:, 0] + count), axis=1)


@dataclass(frozen=True, slots=True)
class _Edges:
    """The edges of all cells, each of them once, in the order of their keys.

    Attributes:
        keys: one number for the two nodes.
        nodes: of each, with its owner on the left; (edges, 2).
        owner: the cell on it, of two the one of the lower number.
        neighbor: the other one; -1 on the boundary.
    """

    keys: Indices
    nodes: Indices
    owner: Indices
    neighbor: Indices

    @classmethod
    def of(cls, cells: Indices, count: int) -> _Edges:
        """Find the edges of cells whose nodes are numbered below `count`."""
        directed = np.stack((cells, np.roll(cells, -1, axis=1)), axis=-1).reshape(-1, 2)
        every = _keys(directed, count)
        order = np.argsort(every, kind="stable")  # So that of two cells that of the lower number comes first.
        every = every[order]
        first = np.flatnonzero(np.diff(every, prepend=-1))
        shared = np.diff(np.append(first, len(every))) == 2
        neighbor = np.full(len(first), -1)
        neighbor[shared] = order[first[shared] + 1] // 4
        return cls(every[first], directed[order[first]], order[first] // 4, neighbor)

    def cells(self, edges: Indices, count: int) -> Indices:
        """Return the owners of edges."""
        return self.owner[np.searchsorted(self.keys, _keys(edges, count))]


def _keys(edges: Indices, count: int) -> Indices:
    """Return one number for each edge, whatever its direction."""
    keys: Indices = edges.min(axis=1).astype(np.int64) * count + edges.max(axis=1)
    return keys
