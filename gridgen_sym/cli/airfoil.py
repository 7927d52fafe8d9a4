"""The command `airfoil`: a C- or an O-grid around a section."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import click

from ..options import AIRFOIL
from .options import option
from .output import certify_and_draw, check_outputs, report, under_of, under_option
from .types import SizedCommand


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

    A file has Selig's form: a name, then x and y from the trailing edge over the upper side to the leading edge and
    back. Its coordinates stay. Exits with 1 if the grid has folded cells.
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
        result.grid.write(output)
        report(quiet, f"wrote {output}")
    kind = given.get("kind", AIRFOIL["kind"].default)
    certify_and_draw(result.grid, plot, f"{Path(section).stem}: {kind}-grid", quiet, result, field)
    if not result.quality.valid:
        raise click.exceptions.Exit(1)
