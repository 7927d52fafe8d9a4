"""The command `airfoil`: a C- or an O-grid around a section."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..options import AIRFOIL
from .options import option
from .output import certify_and_draw, check_outputs, report, under_of, under_option
from .types import SizedCommand

if TYPE_CHECKING:
    from ..grids.grid import Grid
    from ..topology import MultiBlock


@click.command(cls=SizedCommand)
@click.argument("section")
@option(AIRFOIL["kind"], "--type", "kind")
@option(AIRFOIL["first"], metavar="HEIGHT")
@option(AIRFOIL["growth"], metavar="FACTOR")
@option(AIRFOIL["far"], metavar="CHORDS")
@option(AIRFOIL["cells"], "--size", "cells", more="; also NIxNJ", nargs=2, metavar="NI NJ")
@option(AIRFOIL["wake"])
@option(AIRFOIL["leading"], metavar="CHORDS")
@option(AIRFOIL["trailing"], metavar="CHORDS")
@option(AIRFOIL["blunt"])
@click.option(
    "-o", "--output", metavar="OUT", help="Write the grid: .vts, .npz, .cgns, ...; see 'gridgen-sym formats'."
)
@click.option("--plot", metavar="PNG", help="Draw the grid: .png, .svg or .pdf.")
@under_option
@option(AIRFOIL["backend"], metavar="NAME")
@click.option("--quiet", is_flag=True, help="Report nothing but what is wrong.")
def airfoil(
    section: str,
    output: str | None,
    plot: str | None,
    under: str | None,
    quiet: bool,
    **options: Any,  # noqa: ANN401
) -> None:
    """Make a C- or an O-grid around SECTION: a NACA number such as naca2412 or naca23012, or a .dat file.

    A file has Selig's form, a name, then x and y from the trailing edge over the upper side to the leading edge and
    back, or Lednicer's. Its coordinates stay. Exits with 1 if the grid has folded cells.
    """
    from ..solvers import airfoil_grid

    if quiet:
        os.environ["GRIDGEN_SYM_QUIET"] = "1"
    check_outputs(output, plot)
    field = under_of(under, plot)
    given = {key: value for key, value in options.items() if value is not None}
    result = airfoil_grid(section, progress=False if quiet else None, **given)
    if result.converged:
        report(quiet, f"converged in {result.iterations} iterations: {result.message}")
    else:
        click.secho(f"not converged in {result.iterations} iterations: {result.message}", fg="yellow", err=True)
    report(quiet, result.quality.summary())
    if output:
        _with_names(result.grid, output).write(output)
        report(quiet, f"wrote {output}")
    kind = given.get("kind", AIRFOIL["kind"].default)
    certify_and_draw(result.grid, plot, f"{Path(section).stem}: {kind}-grid", quiet, result, field)
    if not result.quality.valid:
        raise click.exceptions.Exit(1)


def _with_names(grid: Grid, output: str) -> Grid | MultiBlock:
    """Return the grid as a format that holds names takes it: its cut connected, the section a wall, the rest far."""
    from ..io.registry import format_for
    from ..topology import Connection, MultiBlock

    if not format_for(output, "", written=True)[0].names:
        return grid
    last = grid.shape[0] - 1
    if (grid.xy[0] == grid.xy[-1]).all():
        seam = Connection((0, "left"), (0, "right"))
        return MultiBlock([grid], [seam], boundaries={"wall": [(0, "bottom")], "farfield": [(0, "top")]})
    # The nodes of the cut of a C-grid lie at both ends of the bottom; a blunt trailing edge parts them at the section.
    apart = (grid.xy[:, 0] != grid.xy[::-1, 0]).any(axis=1)
    cut = int(apart.argmax()) - 1
    seam = Connection((0, "bottom", (0, cut)), (0, "bottom", (last - cut, last)))
    names: dict[str, Sequence[Sequence[object]]] = {
        "wall": [(0, "bottom", (cut, last - cut))],
        "farfield": [(0, "left"), (0, "top"), (0, "right")],
    }
    return MultiBlock([grid], [seam], boundaries=names)
