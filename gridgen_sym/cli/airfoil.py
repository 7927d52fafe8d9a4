"""The command `airfoil`: a C- or an O-grid around a section."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .output import certify_and_draw, check_outputs, report
from .types import SizedCommand, integer, number

if TYPE_CHECKING:
    from ..boundary.airfoil_sides import Kind


@click.command(cls=SizedCommand)
@click.argument("section")
@click.option("--type", "kind", type=click.Choice(("C", "O")), default="C", show_default=True, help="C- or O-grid.")
@click.option(
    "--first",
    type=number,
    default="1e-5",
    show_default=True,
    metavar="HEIGHT",
    help="Height of the first cells, in the unit of the section.",
)
@click.option(
    "--growth",
    type=number,
    metavar="FACTOR",
    help="From one height to the next.  [default: what reaches the outer boundary]",
)
@click.option(
    "--far", type=number, default="20", show_default=True, metavar="CHORDS", help="Distance of the outer boundary."
)
@click.option(
    "--size",
    type=integer,
    nargs=2,
    default=("96", "64"),
    show_default=True,
    metavar="NI NJ",
    help="Cells on the airfoil and outwards; also NIxNJ.",
)
@click.option("--wake", type=integer, default="40", show_default=True, help="Cells along the wake of a C-grid.")
@click.option("--leading", type=number, metavar="CHORDS", help="Cells at the leading edge.  [default: 1/8 of the mean]")
@click.option(
    "--trailing", type=number, metavar="CHORDS", help="Cells at the trailing edge.  [default: 1/6 of the mean]"
)
@click.option("--blunt", is_flag=True, help="The trailing edge of a NACA number has its published thickness.")
@click.option("-o", "--output", metavar="OUT", help="Write the grid: .vts, .xyz, .p2dfmt, .csv, .npz or .cgns.")
@click.option("--plot", metavar="PNG", help="Draw the grid: .png, .svg or .pdf.")
@click.option("--backend", metavar="NAME", help="c, numpy, or one that is installed.  [default: c if possible]")
@click.option("--quiet", is_flag=True, help="Report nothing but what is wrong.")
def airfoil(
    section: str,
    kind: Kind,
    first: float,
    growth: float | None,
    far: float,
    size: tuple[int, int],
    wake: int,
    leading: float | None,
    trailing: float | None,
    blunt: bool,
    output: str | None,
    plot: str | None,
    backend: str | None,
    quiet: bool,
) -> None:
    """Make a C- or an O-grid around SECTION: a NACA number such as naca2412 or naca23012, or a .dat file.

    A file has Selig's form: a name, then x and y from the trailing edge over the upper side to the leading edge and
    back. Its coordinates stay. Exits with 1 if the grid has folded cells.
    """
    from ..solvers import airfoil_grid

    if quiet:
        os.environ["GRIDGEN_SYM_QUIET"] = "1"
    check_outputs(output, plot)
    result = airfoil_grid(
        section,
        kind,
        first=first,
        growth=growth,
        far=far,
        cells=size,
        wake=wake,
        leading=leading,
        trailing=trailing,
        blunt=blunt,
        progress=False if quiet else None,
        backend=backend,
    )
    if result.converged:
        report(quiet, f"converged in {result.iterations} iterations: {result.message}")
    else:
        click.secho(f"not converged in {result.iterations} iterations: {result.message}", fg="yellow", err=True)
    report(quiet, result.quality.summary())
    if output:
        result.grid.write(output)
        report(quiet, f"wrote {output}")
    certify_and_draw(result.grid, plot, f"{Path(section).stem}: {kind}-grid", quiet, result)
    if not result.quality.valid:
        raise click.exceptions.Exit(1)
