"""Layouts of several blocks on the command line: by name, by description, and walls on their boundaries."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import GridgenError, quoted
from ..parsing import number_in, whole_number_in

if TYPE_CHECKING:
    from ..boundary.wall import Wall
    from ..topology import MultiBlock

#: Suffixes of files that describe a layout, and have no nodes of blocks.
DESCRIPTIONS = (".toml", ".mesh")
LAYOUT_HELP = (
    "Connect the sides of a grid file of one block, too, so that the nodes on the cut of a C- or O-grid move; of a "
    "name that is a domain's and a layout's, the layout."
)
REFINE_HELP = (
    "Factor for the numbers of cells of a layout in TOML, by default 1; of a mesh the cells along each side of a "
    "quadrilateral, by default 4."
)


def layout_start(source: str, refine: int | None) -> MultiBlock:
    """Return the start of a layout.

    Args:
        source: a description (`.toml`), a mesh of quadrilaterals (`.mesh`), or the name of a shape with its
            parameters, such as `pipe:radius=2,across=16`.
        refine: see `read_layout`; not for a shape.

    Raises:
        GridgenError: for what cannot be read, or an unknown shape or parameter.
    """
    from ..layouts import read_layout
    from ..topology.shapes import layout

    if Path(source).suffix.lower() in DESCRIPTIONS:
        return read_layout(source, refine=refine)
    if refine is not None:
        raise GridgenError(f"--refine belongs to a layout in TOML or a mesh, which {source} is not")
    name, _, rest = source.partition(":")
    given: dict[str, Any] = {}
    for text in rest.split(",") if rest else []:
        key, equals, value = text.partition("=")
        if not (key.strip() and equals):
            raise GridgenError(f"a parameter of the layout {quoted(name)} is written NAME=VALUE; came {quoted(text)}")
        given[key.strip()] = _value(value.strip())
    return layout(name, **given)


def _value(text: str) -> int | float | str:
    """Return a whole number, a number, or the text, which names a section."""
    for read in (whole_number_in, number_in):
        try:
            return read(text)
        except ValueError:
            continue
    return text


def walls_on(layout: MultiBlock, walls: dict[str, Wall]) -> dict[str, dict[str, Wall]]:
    """Return the walls of `--wall` by block and side.

    Args:
        layout: the blocks.
        walls: by the name of a boundary, by `BLOCK/SIDE`, or of one block by the side.

    Raises:
        GridgenError: for another place, or a side with two walls.
    """
    found: dict[str, dict[str, Wall]] = {}
    for place, wall in walls.items():
        for block, side, own in _places(layout, place, wall):
            if side in found.setdefault(block, {}):
                raise GridgenError(f"two walls are given for the side {side} of block {block}: give one")
            found[block][side] = own
    return found


def _places(layout: MultiBlock, place: str, wall: Wall) -> list[tuple[str, str, Wall]]:
    """Return block, side and wall of each side that a wall is on."""
    from ..boundary.sides import Sides

    if place in layout.boundaries:
        return [
            (layout.names[part.block], part.side, replace(wall, nodes=wall.nodes or (part.first, part.last + 1)))
            for part in layout.boundaries[place]
        ]
    block, slash, side = place.rpartition("/")
    block = block if slash or len(layout) > 1 else layout.names[0]
    if block not in layout.names or side not in Sides._fields:
        named = ", ".join(layout.boundaries) or "there are none"
        raise GridgenError(
            f"a wall is on a boundary by its name ({named}), or on BLOCK/SIDE, blocks {', '.join(layout.names)}; came "
            f"{quoted(place)}"
        )
    return [(block, side, wall)]


@click.command()
def layouts() -> None:
    """List the layouts of several blocks that have names."""
    from ..topology.shapes import layout_description, layout_names

    for name in layout_names():
        click.echo(f"{name:<20}{layout_description(name)}")
