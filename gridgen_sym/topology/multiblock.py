"""A grid of several blocks: which parts of their sides are the same nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Mask
from ..errors import GridgenError, quoted
from ..grids import Grid
from ..grids.grid import check_grid, grid_to_html, write_to_file
from .coincidence import coinciding_parts
from .connection import IDENTITY, Connection, PartLike, SidePart, side_part
from .copies import Bond, Copies
from .identify import identify
from .lines import Coarsening

#: What a user may say of connections.
Connections = Literal["auto"] | Sequence[Connection | Literal["auto"]]


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class MultiBlock:
    """Blocks that are one grid: an immutable value.

    Connected nodes are one node with a copy in each block; they move like inner nodes. All other boundary nodes are the
    outer boundary.

    Attributes:
        blocks: the grids, with equal copies of connected nodes.
        names: of the blocks.
        bonds: what is connected, part by part.
        boundaries: parts of the outer boundary by name, such as `wall` or `farfield`.
        copies: the nodes with several copies.
        outer: for each block an array (ni, nj) that is true at nodes on the outer boundary.
    """

    blocks: tuple[Grid, ...]
    names: tuple[str, ...]
    bonds: tuple[Bond, ...]
    boundaries: Mapping[str, tuple[SidePart, ...]]
    copies: Copies
    outer: tuple[NDArray[np.bool_], ...]

    def __init__(
        self,
        blocks: Sequence[Grid] | Mapping[str, Grid],
        connections: Connections = "auto",
        *,
        boundaries: Mapping[str, Sequence[PartLike]] | None = None,
    ) -> None:
        """Connect blocks.

        Args:
            blocks: the grids, all with positive Jacobians or to be untangled to such; with names, or named by their
                numbers.
            connections: `auto` for all parts of sides whose nodes coincide; or connections, among which `auto` may be,
                too.
            boundaries: names of parts of the outer boundary, each a sequence of parts such as
                `("a", "bottom", (24, 88))`.

        Raises:
            GridgenError: for blocks that are no grids, parts of sides with different numbers of nodes or more than one
                connection, connected nodes that lie apart, and boundaries that are no parts of the outer boundary.
        """
        named = _named(blocks)
        for grid in named.values():
            check_grid(grid)
        grids, names = tuple(named.values()), tuple(named)
        numbers, shapes = {name: k for k, name in enumerate(names)}, [grid.shape for grid in grids]
        bonds = _bonds(connections, grids, names)
        taken = _check_disjoint(bonds, shapes, names)
        copies, planes, outer = identify(grids, bonds, names)
        parts = _boundaries(boundaries or {}, numbers, shapes)
        _check_outer(parts, taken, names)
        for name, value in (
            ("blocks", tuple(Grid.from_planes(*plane) for plane in planes)),
            ("names", names),
            ("bonds", bonds),
            ("boundaries", parts),
            ("copies", copies),
            ("outer", tuple(mask.astype(bool) for mask in outer)),
        ):
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        """The number of blocks."""
        return len(self.blocks)

    def __getitem__(self, block: int | str) -> Grid:
        """Return a block by its number or name."""
        if isinstance(block, str) and block not in self.names:
            raise GridgenError(f"unknown block {quoted(block)}: the blocks are {', '.join(self.names)}")
        return self.blocks[self.names.index(block) if isinstance(block, str) else block]

    def __eq__(self, other: object) -> bool:
        """Whether `other` is a layout with the same blocks, names, connections and boundaries."""
        if not isinstance(other, MultiBlock):
            return NotImplemented
        return (self.blocks, self.names, self.bonds, self.boundaries) == (
            other.blocks,
            other.names,
            other.bonds,
            other.boundaries,
        )

    def __hash__(self) -> int:
        """Agree with `==`."""
        return hash((self.blocks, self.names, self.bonds))

    def __repr__(self) -> str:
        """Report the sizes, not the numbers."""
        sizes = ", ".join(
            f"{name}: {grid.shape[0]} x {grid.shape[1]}" for name, grid in zip(self.names, self.blocks, strict=True)
        )
        return f"MultiBlock({sizes}; {len(self.bonds)} connection{'' if len(self.bonds) == 1 else 's'})"

    def _repr_html_(self) -> str:
        """Show the layout in a notebook: to zoom, and to point at cells."""
        return grid_to_html(self)

    @property
    def node_count(self) -> int:
        """The number of different nodes."""
        every = sum(grid.shape[0] * grid.shape[1] for grid in self.blocks)
        return every - len(self.copies.block) + len(self.copies.starts)

    def write(self, path: str | PathLike[str]) -> None:
        """Write the layout to a file of the kind that the suffix names; see `gridgen_sym.write`."""
        write_to_file(self, path)

    def moved(self, planes: Sequence[Array]) -> MultiBlock:
        """Return the same layout with other coordinates, (2, ni, nj) for each block, whose copies are equal."""
        return self._with(blocks=tuple(Grid.from_planes(*plane) for plane in planes))

    def coarsened(self, coarsening: Coarsening) -> MultiBlock:
        """Return the layout with fewer nodes, whose named boundaries are left out."""
        kept = [np.ix_(*of_block) for of_block in coarsening.kept]
        return self._with(
            blocks=tuple(Grid.from_planes(grid.x[at], grid.y[at]) for grid, at in zip(self.blocks, kept, strict=True)),
            bonds=tuple(coarsening.bonds(self.bonds)),
            boundaries={},
            copies=coarsening.copies(self.copies),
            outer=tuple(np.ascontiguousarray(mask[at]) for mask, at in zip(self.outer, kept, strict=True)),
        )

    def _with(self, **changed: object) -> MultiBlock:
        made = object.__new__(MultiBlock)
        for name in ("blocks", "names", "bonds", "boundaries", "copies", "outer"):
            object.__setattr__(made, name, changed.get(name, getattr(self, name)))
        return made


def _named(blocks: Sequence[Grid] | Mapping[str, Grid]) -> dict[str, Grid]:
    """Return the blocks by their names."""
    if not isinstance(blocks, Mapping | Sequence):
        raise GridgenError(f"blocks are a sequence of grids, or grids by their names; came {quoted(blocks)}")
    if not blocks:
        raise GridgenError("a layout needs at least one block")
    named = blocks if isinstance(blocks, Mapping) else dict(enumerate(blocks))
    if len({str(name) for name in named}) < len(named):
        raise GridgenError(f"blocks have different names, as text; came {quoted(list(named))}")
    return {str(name): grid for name, grid in named.items()}


def _boundaries(
    boundaries: Mapping[str, Sequence[PartLike]], numbers: Mapping[str, int], shapes: Sequence[tuple[int, int]]
) -> dict[str, tuple[SidePart, ...]]:
    """Return the named parts of sides, checked each for itself."""
    if not isinstance(boundaries, Mapping):
        raise GridgenError(
            f"boundaries map names to parts of sides, such as {{'wall': [('a', 'bottom')]}}; came {quoted(boundaries)}"
        )
    for name, given in boundaries.items():
        if not isinstance(given, Sequence):
            raise GridgenError(
                f"the boundary {quoted(name)} is a list of parts of sides, such as [('a', 'bottom', (0, 24))]; came "
                f"{quoted(given)}"
            )
    return {str(name): tuple(side_part(part, numbers, shapes) for part in given) for name, given in boundaries.items()}


def _bonds(connections: Connections, grids: Sequence[Grid], names: Sequence[str]) -> tuple[Bond, ...]:
    """Return what is connected, with parts that are checked."""
    if not isinstance(connections, Sequence) or (isinstance(connections, str) and connections != "auto"):
        raise GridgenError(f"connections are 'auto', or a sequence of Connection; came {quoted(connections)}")
    given = ("auto",) if isinstance(connections, str) else tuple(connections)
    numbers, shapes = {name: k for k, name in enumerate(names)}, [grid.shape for grid in grids]
    bonds = []
    for one in given:
        if isinstance(one, Connection):
            bonds.append(Bond(side_part(one.one, numbers, shapes), side_part(one.other, numbers, shapes), one.motion))
        elif one != "auto":
            raise GridgenError(f"a connection is a Connection or 'auto'; came {quoted(one)}")
    if "auto" in given:
        said = {(part.block, part.side) for bond in bonds for part in (bond.one, bond.other)}
        for part, other in coinciding_parts(grids, names):
            if not {(part.block, part.side), (other.block, other.side)} & said:
                bonds.append(Bond(part, other, IDENTITY))
    for bond in bonds:
        if bond.one.count != bond.other.count:
            raise GridgenError(
                f"connected parts must have as many nodes, but {bond.one.described(names)} have {bond.one.count} and "
                f"{bond.other.described(names)} have {bond.other.count}"
            )
    return tuple(bonds)


def _check_disjoint(
    bonds: Sequence[Bond], shapes: Sequence[tuple[int, int]], names: Sequence[str]
) -> dict[tuple[int, str], Mask]:
    """Refuse an edge that belongs to two connections; return for each side which edges are connected."""
    taken: dict[tuple[int, str], Mask] = {}
    for part in (part for bond in bonds for part in (bond.one, bond.other)):
        shape = shapes[part.block]
        edges = taken.setdefault((part.block, part.side), np.zeros(shape[part.axis] - 1, dtype=np.uint8))
        if edges[part.first : part.last].any():
            raise GridgenError(
                f"{part.described(names)} are connected twice: give each edge of a side one connection at most"
            )
        edges[part.first : part.last] = 1
    return taken


def _check_outer(
    parts: Mapping[str, Sequence[SidePart]], taken: Mapping[tuple[int, str], Mask], names: Sequence[str]
) -> None:
    """Refuse a named part of the outer boundary that is connected."""
    for name, part in ((name, part) for name, given in parts.items() for part in given):
        edges = taken.get((part.block, part.side))
        if edges is not None and edges[part.first : part.last].any():
            raise GridgenError(f"{part.described(names)} cannot be the boundary {name!r}: they are connected")
