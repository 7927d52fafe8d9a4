"""Layouts of several blocks on the command line: by name, by description, and walls on their boundaries."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import GridgenError, quoted
from ..parsing import number_in, whole_number_in

if TYPE_CHECKING:
    from ..boundary.wall import Wall
    from ..topology import MultiBlock

#: Suffixes of files that describe a layout, and have no nodes of blocks.
DESCRIPTIONS = (".toml", ".mesh", ".msh")
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
        source: a description (`.toml`), a mesh of quadrilaterals (`.mesh`, `.msh`), or the name of a shape with its
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


def file_walls(source: str) -> dict[str, Wall]:
    """Return the walls that the description of a layout asks for; none of another kind of start."""
    from ..layouts import read_walls

    return read_walls(source) if Path(source).suffix.lower() == ".toml" else {}


def walls_on(walls: dict[str, Wall]) -> dict[str, Any]:
    """Return the walls of `--wall` as solvers take them: those on `BLOCK/SIDE` by block, others as they are."""
    found: dict[str, Any] = {}
    for place, wall in walls.items():
        block, slash, side = place.rpartition("/")
        if slash:
            found.setdefault(block, {})[side] = wall
        else:
            found[place] = wall
    return found


def sliding(text: str) -> object:
    """Return what `--slide` says as solvers take it: `BLOCK/SIDE` as a pair, other names as they are."""
    if text == "all":
        return text
    return tuple(
        (block, side) if slash else side for block, slash, side in (s.rpartition("/") for s in text.split(","))
    )


@click.command()
def layouts() -> None:
    """List the layouts of several blocks that have names."""
    from ..topology.shapes import layout_description, layout_names

    for name in layout_names():
        click.echo(f"{name:<20}{layout_description(name)}")
