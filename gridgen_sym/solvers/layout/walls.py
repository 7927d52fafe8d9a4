"""Walls in a grid of several blocks: the cells that they ask for, and a start that has them.

A block with walls is solved by itself first, with its sides as they are; then all blocks are one grid, and nodes on
connections move. Cells of blocks without a wall are asked to stay as long and wide as they are at the start, with right
angles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...arrays import Array
from ...boundary.sides import Sides
from ...boundary.wall import Wall, check_heights, walls_by_side
from ...errors import GridgenError, quoted
from ...fields.target import Target
from ...fields.wall_cells import WallCells, own_cells, wall_cells
from ...topology import MultiBlock
from ..multilevel.wall_continuation import WallContinuation
from ..run.progress import Progress
from ..run.status import Outcome
from .binding import blocks_of
from .problem import LayoutProblem
from .run import LayoutRun
from .wall_corrections import WallCorrections
from .wall_lengths import agreed

#: First heights are corrected so often at most, and not where they are wrong by no more than this part.
_CORRECTIONS, _RIGHT = 12, 3e-3
#: Walls as they are given: for each block by name and side; of the sides of the only block; or by boundary's name.
LayoutWalls = Mapping[str, Mapping[str, Wall]] | Mapping[str, Wall]


def walls_of_blocks(layout: MultiBlock, walls: LayoutWalls) -> dict[str, Sides[Wall | None]]:
    """Return the walls of every block that has some, checked.

    Raises:
        GridgenError: for an unknown block, side or boundary, walls on a connection, or heights that a block has no
            room for.
    """
    found = {}
    for name, of_block in _by_block(layout, walls).items():
        grid = layout[name]
        found[name] = walls_by_side(of_block)
        check_heights(found[name], grid)
        for side, wall in zip(Sides._fields, found[name], strict=True):
            if wall is not None:
                _check_outer(layout, name, side, wall)
    return found


def walls_or_target(
    layout: MultiBlock,
    walls: LayoutWalls | None,
    target: Any,  # noqa: ANN401 - what a solver takes as its target
) -> tuple[dict[str, Sides[Wall | None]] | None, Any]:
    """Return the walls of blocks, checked, and the target; that of a layout is a mapping from names to its blocks.

    Raises:
        GridgenError: if both are given, as for `walls_of_blocks`, or for a reference with blocks of other shapes.
    """
    asked = None if walls is None else walls_of_blocks(layout, walls)
    if asked is not None and target is not None:
        raise GridgenError("walls become a target: give walls or a target, not both")
    return asked, blocks_of(layout, target) if isinstance(target, MultiBlock) else target


def _by_block(layout: MultiBlock, walls: object) -> dict[str, dict[Any, Any]]:
    """Return the walls by block and side."""
    if not isinstance(walls, Mapping) or not all(isinstance(one, Mapping | Wall) for one in walls.values()):
        raise GridgenError(
            "walls of several blocks are given by block and side, such as {'a': {'bottom': gg.Wall(first=1e-3)}}, or "
            f"by the name of a boundary; came {quoted(walls)}"
        )
    found: dict[str, dict[Any, Any]] = {}
    for name, wall in walls.items():
        if isinstance(wall, Mapping):
            found.setdefault(name, {}).update(wall)
        elif name in layout.boundaries:
            for block, side, part in _on_boundary(layout, name, wall):
                if side in found.setdefault(block, {}):
                    raise GridgenError(
                        f"{side} of block {block} has two walls, of which one is {name}: give one, by block and side"
                    )
                found[block][side] = part
        elif len(layout) == 1:
            found.setdefault(layout.names[0], {})[name] = wall
        else:
            known = ", ".join(layout.boundaries) or "none has a name"
            raise GridgenError(f"unknown boundary {quoted(name)} in walls; the boundaries are: {known}")
    return found


def _on_boundary(layout: MultiBlock, name: str, wall: Wall) -> Iterator[tuple[str, str, Wall]]:
    """Yield block, side and wall for each part of a boundary."""
    if wall.nodes is not None:
        raise GridgenError(f"the wall {name} is a boundary, which has its own nodes: give no nodes, or block and side")
    for part in layout.boundaries[name]:
        whole = part.count == layout.blocks[part.block].shape[part.axis]
        nodes = None if whole else (part.first, part.last + 1)
        yield layout.names[part.block], part.side, replace(wall, nodes=nodes)


def _check_outer(layout: MultiBlock, name: str, side: str, wall: Wall) -> None:
    """Refuse a wall on a connection."""
    number = layout.names.index(name)
    count = layout.blocks[number].shape[0 if side in ("bottom", "top") else 1]
    first, last = (0, count - 1) if wall.nodes is None else (wall.nodes[0], wall.nodes[1] - 1)
    for bond in layout.bonds:
        for part in (bond.one, bond.other):
            if (part.block, part.side) == (number, side) and part.first < last and first < part.last:
                raise GridgenError(
                    f"the wall at {side} of block {name} lies on a connection, {part.described(layout.names)}: give "
                    "the nodes of the wall, Wall(..., nodes=(first, last + 1))"
                )


def walled_start(
    layout: MultiBlock, walls: Mapping[str, Sides[Wall | None]], backend: str | None, report: Progress
) -> MultiBlock:
    """Solve every block with walls by itself, and return the layout with what was found."""
    planes: list[Array] = []
    for name, grid in zip(layout.names, layout.blocks, strict=True):
        found = None
        if name in walls:
            way = WallContinuation(walls[name], backend, report)
            way.solve(grid.planes.copy(), nested=True)
            found = way.on_grid(grid.planes)
        planes.append(grid.planes if found is None else found)
    return layout.moved(planes)


def wall_targets(layout: MultiBlock, walls: Mapping[str, Sides[Wall | None]]) -> dict[str, Target]:
    """Return the targets of all blocks, by name: what walls ask for, or the lengths of the block's own cells.

    Args:
        layout: the start that was given.
        walls: of the blocks that have some.
    """
    cells = []
    for name, grid in zip(layout.names, layout.blocks, strict=True):
        if name in walls:
            cells.append(wall_cells(walls[name], grid.planes, grid.shape))
        else:
            along_xi, along_eta, angle = own_cells(grid.planes)
            cells.append(WallCells(along_xi, along_eta, np.full_like(angle, np.pi / 2), None, None))
    made = agreed(layout, walls, cells)
    return {name: Target.of_cells(one) for name, one in zip(layout.names, made, strict=True)}


def minimize_with_walls(
    run: LayoutRun,
    asked: Mapping[str, Sides[Wall | None]],
    make: Callable[[dict[str, Target]], LayoutProblem],
    minimized: Callable[[], Outcome],
) -> Outcome:
    """Minimize for the targets of walls, and for others that make up for first heights that came out wrong."""
    corrections, outcome = WallCorrections.of(asked), None
    for _ in range(1 + _CORRECTIONS):
        before, problem = run.coordinates.copy(), run.problem
        run.problem = make(wall_targets(run.layout, corrections.walls))
        run.problem.measure_locally(run.coordinates)
        found = minimized()
        if outcome is not None and not found.converged:
            run.coordinates, run.problem = before, problem
            break
        outcome = found
        places = dict(zip(run.layout.names, run.problem.exchange.views(run.coordinates), strict=True))
        fixed = dict(zip(run.layout.names, run.problem.fixed, strict=True))
        if not found.converged or corrections.correct(places, fixed) < _RIGHT:
            break
    assert outcome is not None
    return outcome
