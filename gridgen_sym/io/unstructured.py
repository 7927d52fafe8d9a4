"""A grid of one or several blocks as one list of nodes, quadrilaterals and named boundary edges, for other programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..boundary.sides import Sides
from ..errors import GridgenError, quoted
from ..grids.grid import Grid, boundary_indices
from ..topology.components import component_numbers
from ..topology.connection import IDENTITY, SidePart
from ..topology.copies import Bond
from .format import Blocks

Indices = NDArray[np.integer[Any]]
#: Rows of text that are made at once.
_ROWS = 1 << 15


@dataclass(frozen=True, slots=True)
class Patch:
    """A part of the outer boundary, or one of two that are connected by a translation or a rotation.

    Attributes:
        name: of the boundary.
        edges: the two nodes of each edge, with the grid on the left; (n, 2).
        partner: the name of the patch that it is connected to, edge by edge; empty for the outer boundary.
        bond: the connection, from the first of the two patches to the second.
        shadow: whether it is the second of the two.
    """

    name: str
    edges: Indices
    partner: str = ""
    bond: Bond | None = None
    shadow: bool = False


@dataclass(frozen=True, slots=True)
class Mesh:
    """Nodes, each of them once, and what is made of them.

    Attributes:
        points: (nodes, 2), in the order of the blocks, eta running fastest.
        cells: the four corners of each, counter-clockwise; (cells, 4).
        starts: the first cell of each block, and the number of all cells.
        names: of the blocks.
        patches: the boundary: every edge that belongs to one cell alone is in one of them.
    """

    points: Array
    cells: Indices
    starts: tuple[int, ...]
    names: tuple[str, ...]
    patches: tuple[Patch, ...]


def mesh_of(blocks: Blocks) -> Mesh:
    """Return a grid as a mesh.

    Nodes that a connection makes one have one number; those that a translation or rotation connects do not: their edges
    are two patches, `periodic_1` and `periodic_1_shadow` and so on. Parts of the outer boundary without a name are
    named by their side, of several blocks by side and block: `left`, or `left_a`.

    Raises:
        GridgenError: for an edge that has two names.
    """
    shapes = [grid.shape for grid in blocks.grids]
    offsets = np.cumsum([0, *(ni * nj for ni, nj in shapes)])
    bonds = [bond for bond in blocks.bonds or () if bond.motion == IDENTITY]
    numbers, first = _numbered(bonds, shapes, offsets)
    points = np.empty((len(first), 2))
    for axis in range(2):
        points[:, axis] = np.concatenate([grid.planes[axis].ravel() for grid in blocks.grids])[first]
    clockwise = [_runs_clockwise(grid) for grid in blocks.grids]
    cells = [
        _cells(numbers[offsets[k] : offsets[k + 1]].reshape(shape), flip=clockwise[k]) for k, shape in enumerate(shapes)
    ]
    starts = np.cumsum([0, *map(len, cells)])
    names = tuple(name for name, _ in blocks.described)
    patches = _patches(blocks, _Edges(numbers, offsets, shapes, clockwise))
    every = cells[0] if len(cells) == 1 else np.concatenate(cells)
    return Mesh(points, every, tuple(starts.tolist()), names, tuple(patches))


def _numbered(bonds: Sequence[Bond], shapes: Sequence[tuple[int, int]], offsets: Indices) -> tuple[Indices, Indices]:
    """Return the number of every node of every block, and for each number the first node that has it."""
    count = int(offsets[-1])
    if not bonds:
        numbers = np.arange(count, dtype=_kind(count))
        return numbers, numbers
    pairs: list[list[Indices]] = [[], []]
    for bond in bonds:
        for part, (i, j), found in zip((bond.one, bond.other), bond.indices(shapes), pairs, strict=True):
            found.append(offsets[part.block] + i * shapes[part.block][1] + j)
    labels = component_numbers(np.concatenate(pairs[0]), np.concatenate(pairs[1]), count)
    _, first, numbers = np.unique(labels, return_index=True, return_inverse=True)
    order = np.argsort(first)  # Numbers in the order in which nodes come for the first time.
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return rank[numbers.ravel()].astype(_kind(count)), first[order]


def _kind(count: int) -> type[np.integer[Any]]:
    """Return the type of numbers below a count."""
    return np.int32 if count < 1 << 31 else np.int64


def _runs_clockwise(grid: Grid) -> bool:
    """Return whether the boundary, from the left over the bottom, has a negative area within it."""
    i, j = boundary_indices(*grid.shape).T
    x, y = grid.x[i, j] - grid.x[0, 0], grid.y[i, j] - grid.y[0, 0]
    return bool((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() < 0)


def _cells(numbers: Indices, *, flip: bool) -> Indices:
    """Return the corners of the cells of a block, counter-clockwise, with eta running fastest."""
    corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    cells = np.empty((corners[0].size, 4), dtype=numbers.dtype)
    for number, corner in enumerate(corners[::-1] if flip else corners):
        cells[:, number] = corner.ravel()
    return cells


@dataclass(frozen=True, slots=True)
class _Edges:
    """Where the edges of parts of sides are found: the numbers of all nodes, and which blocks run clockwise."""

    numbers: Indices
    offsets: Indices
    shapes: Sequence[tuple[int, int]]
    clockwise: Sequence[bool]

    def of(self, part: SidePart) -> Indices:
        """Return the edges of a part along its side, each with the grid on its left."""
        i, j = part.indices(self.shapes[part.block])
        nodes = self.numbers[self.offsets[part.block] + i * self.shapes[part.block][1] + j]
        ends = (nodes[:-1], nodes[1:])
        return np.stack(ends if part.counterclockwise is not self.clockwise[part.block] else ends[::-1], axis=1)


def _patches(blocks: Blocks, edges: _Edges) -> list[Patch]:
    """Return the patches: named parts, the rest of each side, and pairs of periodic parts."""
    free = {
        (block, side): np.ones(shape[0 if side in ("bottom", "top") else 1] - 1, dtype=bool)
        for block, shape in enumerate(edges.shapes)
        for side in Sides._fields
    }
    pairs: list[Patch] = []
    for bond in blocks.bonds or ():
        for part in (bond.one, bond.other):
            free[part.block, part.side][part.first : part.last] = False
        if bond.motion != IDENTITY:
            name = f"periodic_{1 + len(pairs) // 2}"
            shadow = f"{name}_shadow"
            other = edges.of(bond.other)
            pairs.append(Patch(name, edges.of(bond.one), shadow, bond))
            pairs.append(Patch(shadow, other[::-1] if bond.reversed else other, name, bond, True))
    found: dict[str, list[Indices]] = {}
    for name, parts in blocks.boundaries.items():
        for part in parts:
            here = free[part.block, part.side][part.first : part.last]
            if not here.all():
                raise GridgenError(
                    f"{part.described([name for name, _ in blocks.described])} have two names, the second of which is "
                    f"{name!r}: give each edge one"
                )
            here[:] = False
            found.setdefault(name, []).append(edges.of(part))
    taken = {*found}
    for (block, side), open_edges in free.items():
        for first, last in _runs(open_edges):
            name = _unnamed(side if len(blocks.grids) == 1 else f"{side}_{blocks.described[block][0]}", taken)
            found.setdefault(name, []).append(edges.of(SidePart(block, side, first, last)))
    return [*(Patch(name, np.concatenate(parts)) for name, parts in found.items() if parts), *pairs]


def _unnamed(name: str, taken: set[str]) -> str:
    """Return the name for parts that have none, which is no name of others."""
    while name in taken:
        name += "_rest"
    return name


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and last node of each run of edges whose flag is set."""
    steps = np.diff(np.concatenate(([0], flags.astype(np.int8), [0])))
    return list(zip(np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist(), strict=True))


def check_names(mesh: Mesh, what: str, forbidden: str) -> None:
    """Refuse names of boundaries with signs that a format cannot hold, and empty ones."""
    for patch in mesh.patches:
        if not patch.name or not patch.name.isprintable() or any(sign in patch.name for sign in forbidden):
            signs = " ".join("a blank" if sign == " " else sign for sign in forbidden)
            raise GridgenError(
                f"{what} cannot hold the boundary name {quoted(patch.name)}: take one that is not empty, and without "
                f"line breaks and {signs}"
            )


def lines_of(row: str, *columns: NDArray[Any], first: int | None = None, add: int = 0) -> Iterator[bytes]:
    """Yield text: for each row of numbers a line of a form such as `3 %d %d`, many at once.

    Args:
        row: the form.
        columns: arrays (n,) or (n, k), side by side.
        first: where rows are numbered, in a first column, the number of the first one.
        add: what is added to all numbers of the columns.
    """
    for begin in range(0, len(columns[0]), _ROWS):
        parts = [column[begin : begin + _ROWS] + add for column in columns]
        counted = [] if first is None else [np.arange(first + begin, first + begin + len(parts[0]))]
        rows = np.column_stack([*counted, *parts])
        yield ((row * len(rows)) % tuple(rows.ravel().tolist())).encode("utf-8")
