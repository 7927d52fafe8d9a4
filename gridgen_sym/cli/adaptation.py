"""The command `adapt`: move the nodes of a grid to where a function or data need them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..options import ADAPTATION
from .base import functionals_option
from .field import field_of, outside_option
from .ocean import Ocean, ocean_options
from .options import option
from .output import Announcement, certify_and_draw, check_outputs, report, under_of, under_option
from .start import parameters_of, start_grid, start_options
from .types import SizedCommand, number

if TYPE_CHECKING:
    from ..adaptation import AdaptResult, LayoutAdaptResult
    from ..fields.outside import Outside


@click.command(cls=SizedCommand)
@click.argument("input")
@click.option("--to", required=True, metavar="FIELD", help="A formula in x and y, or a file; see above.")
@outside_option
@option(ADAPTATION["monitor"], more="; 'values' takes FIELD itself")
@option(ADAPTATION["feature_fraction"])
@click.option("--share", type=number, hidden=True, help="The old name of --feature-fraction.")
@option(ADAPTATION["smoothing"])
@option(ADAPTATION["max_iterations"], "--max-iterations", "--steps")
@option(ADAPTATION["boundary"])
@option(ADAPTATION["functional"], "-f", "--functional", metavar="NAME")
@option(ADAPTATION["parameters"], "--parameter", "parameters", multiple=True, metavar="NAME=VALUE")
@start_options
@option(ADAPTATION["time_limit"], metavar="SECONDS")
@click.option(
    "-o", "--output", metavar="OUT", help="Write the grid: .vts, .npz, .cgns, ...; see 'gridgen-sym formats'."
)
@ocean_options
@click.option("--plot", metavar="PNG", help="Draw the grid: .png, .svg or .pdf.")
@under_option
@click.option("--quiet", is_flag=True, help="Print errors only.")
@functionals_option
def adapt(
    input: str,
    to: str,
    outside: Outside,
    monitor: str | None,
    feature_fraction: float | None,
    share: float | None,
    smoothing: int | None,
    parameters: tuple[str, ...],
    output: str | None,
    plot: str | None,
    under: str | None,
    quiet: bool,
    **options: Any,  # noqa: ANN401
) -> None:
    """Adapt the grid INPUT to FIELD: a classical domain, an outline or a grid file.

    FIELD is a formula such as 'tanh(50*(x + y - 1))'; a .npz file with arrays x, y and values (nx, ny), or with values
    (ni, nj) at the nodes of INPUT; a variable of a netCDF file, bathy.nc:depth; or a .csv file with the header
    x,y,value. No cell folds on the way.
    """
    from ..adaptation import Monitor
    from ..adaptation import adapt as run
    from ..io import check_layout_written
    from ..solvers.run.status import StopReason
    from ..topology import MultiBlock

    if quiet:
        os.environ["GRIDGEN_SYM_QUIET"] = "1"
        options["progress"] = False
    check_outputs(output, plot)
    fraction = share if feature_fraction is None else feature_fraction
    of_monitor = {"measure": monitor, "feature_fraction": fraction, "smoothing": smoothing}
    chosen = Monitor(**{name: value for name, value in of_monitor.items() if value is not None})  # type: ignore[arg-type]
    boundary = {key: options.pop(key) for key in ("size", "corners", "sampling", "sides", "reorient", "crs")}
    deep = {key: options.pop(key) for key in ("depth", "min_depth", "coast", "land")}
    given = {key: value for key, value in options.items() if value is not None}
    given["parameters"] = parameters_of(given.get("functional", ADAPTATION["functional"].default), parameters)
    begun = start_grid(input, **boundary)
    drawn = under_of(under, plot, begun.projection)
    start = begun.grid
    if output and isinstance(start, MultiBlock):
        check_layout_written(start, output)
    field = field_of(to, smooth=monitor != "values", outside=outside, projection=begun.projection)
    ocean = Ocean(output, begun.projection, begun.islands, outside, **deep)
    begin = Announcement(quiet, input, start)
    result = run(start, field, monitor=chosen, callback=begin, **given)
    begin()
    _report(result, quiet)
    if output:
        ocean.write(result.grid)
        report(quiet, f"wrote {output}")
    certify_and_draw(result.grid, plot, f"{Path(input).stem}, adapted", quiet, under=drawn)
    if result.stopped_by is StopReason.USER:
        raise click.exceptions.Exit(130)


def _report(result: AdaptResult | LayoutAdaptResult, quiet: bool) -> None:
    """Print what came out; a grid that has not settled is reported on standard error as well."""
    from ..adaptation import AdaptResult

    if result.converged:
        report(quiet, str(result))
    else:
        click.secho(str(result), fg="yellow", err=True)
    if isinstance(result, AdaptResult):
        report(quiet, f"density times area, at the start: {result.before.weight}")
        report(quiet, f"density times area, now:          {result.after.weight}")
    else:
        first, last = result.history[0].spread, result.history[-1].spread
        report(quiet, f"density times area, variation at the start: {first:.3f}, now: {last:.3f}")
    report(quiet, result.quality.summary())
    if isinstance(result, AdaptResult) and result.change.before.valid:
        report(quiet, result.change.summary())
