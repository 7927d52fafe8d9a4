"""Commands about grids: `grid`, `quality`, `domains`."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import click

from ..errors import GridgenError
from ..options import OUTLINE, SOLVERS, WEIGHT
from .base import functionals_option
from .field import control_of, field_of, fields_of, outside_option, target_of
from .layouts import LAYOUT_HELP, REFINE_HELP, file_walls, sliding, walls_on
from .ocean import Ocean, ocean_options
from .options import option
from .output import Announcement, certify_and_draw, check_outputs, report, under_of, under_option
from .start import continuation_of, on_plane, parameters_of, start_grid, start_options
from .types import SizedCommand, integer
from .walls import WALLS, walls_of

if TYPE_CHECKING:
    from ..boundary.wall import Wall
    from ..fields import Weight
    from ..fields.outside import Outside
    from ..geography import Projection
    from ..solvers import LayoutResult, Result

_SOLVERS = ("newton", "local", "euler-lagrange", "relaxation")


@click.command(cls=SizedCommand)
@click.argument("input")
@option(
    SOLVERS["functional"],
    *("-f", "--functional", "name"),
    more="; see 'gridgen-sym functionals'",
    required=True,
    metavar="NAME",
)
@click.option(
    "--solver",
    type=click.Choice(_SOLVERS),
    default="newton",
    show_default=True,
    help="newton and local minimize the discrete energy; euler-lagrange and relaxation solve its equations.",
)
@start_options
@click.option("--layout", is_flag=True, help=LAYOUT_HELP)
@click.option("--refine", type=integer, metavar="N", help=REFINE_HELP)
@click.option(
    "-o", "--output", metavar="OUT", help="Write the grid: .vts, .npz, .cgns, ...; see 'gridgen-sym formats'."
)
@ocean_options
@click.option("--plot", metavar="PNG", help="Draw the grid, folded cells in red: .png, .svg or .pdf.")
@under_option
@option(
    SOLVERS["weight"],
    more=": a formula such as '1 + 5*exp(-20*(x**2 + y**2))', or a .npz, .csv or netCDF file as for 'adapt --to'",
    metavar="FIELD",
)
@option(WEIGHT["mode"], "--weight-mode")
@option(WEIGHT["allow_negative"], "--allow-negative-weight")
@option(
    SOLVERS["fields"],
    *("--field", "fields"),
    more=": a formula in x and y, several in parentheses, or a file as for --weight (with the components along the "
    "first axis of 'values', or in columns after x,y): M='(1 + x**2, 0, 1)'. NAME:logical=VALUE is a formula in xi and "
    "eta; NAME:differentiated=VALUE belongs to the energy",
    multiple=True,
    metavar="NAME=VALUE",
)
@outside_option
@option(
    SOLVERS["target"],
    more=": a grid file of the same size (its cells, or with 'FILE, 90' their lengths at right angles), or two edge "
    "lengths and an angle in degrees, formulas in xi and eta: '0.01*(1 + xi), 0.02, 90'",
    metavar="TARGET",
)
@option(SOLVERS["walls"], "--wall", "walls", more=WALLS, multiple=True, metavar="SIDE:first=HEIGHT,...")
@option(
    SOLVERS["slide"],
    more=": all, or bottom,top; of several blocks all, boundaries or BLOCK/SIDE (newton, local)",
    metavar="SIDES",
)
@option(
    SOLVERS["control"],
    more=" of winslow's equations: formulas in xi and eta, such as '-2*xi, 0'; thomas-middlecoff, from the spacing of "
    "the boundary nodes (euler-lagrange and relaxation); or hilgenstock-white, from --wall (euler-lagrange)",
    metavar="P,Q",
)
@option(SOLVERS["parameters"], "--parameter", "parameters", multiple=True, metavar="NAME=VALUE")
@click.option(
    "--continuation",
    metavar="NAME=V1,V2,...",
    help="Minimize for one value of a parameter after the other, each time from the last grid: omega=1,0.1,0.01 "
    "(newton and local).",
)
@option(SOLVERS["tolerance"])
@option(SOLVERS["max_iterations"])
@option(SOLVERS["time_limit"], metavar="SECONDS")
@option(SOLVERS["keep_valid"])
@option(SOLVERS["interior_only"], more=" (newton and local)")
@option(SOLVERS["spacing"], more=": of the unit square, or of the index (the paper's literal sums)")
@option(SOLVERS["backend"], metavar="NAME")
@click.option("--quiet", is_flag=True, help="Report nothing but what is wrong.")
@functionals_option
def grid(
    input: str,
    name: str,
    output: str | None,
    plot: str | None,
    under: str | None,
    quiet: bool,
    **options: Any,  # noqa: ANN401
) -> None:
    """Make a grid from INPUT: a classical domain, an outline, a layout or a grid file.

    INPUT is the name of a domain (see 'gridgen-sym domains'; parameters as in horseshoe_map:R=4.5), the file of an
    outline (points x,y and '# corners: ...', a map or a drawing; see 'gridgen-sym formats'), the name of a layout of
    several blocks (see 'gridgen-sym layouts'; parameters as in pipe:across=16), a layout in TOML (.toml) or a mesh of
    quadrilaterals (.mesh, .msh), or a grid file, which is the start. A file of several blocks is one grid, connected
    as the map (.nmf) beside it says, or where nodes coincide. Exits with 1 if the result has folded cells or the
    functional has no derivative there, and after Ctrl-C, which writes the best grid so far, with 130.
    """
    from ..io import check_layout_written
    from ..solvers.run.status import Status, StopReason
    from ..topology import MultiBlock

    if quiet:
        os.environ["GRIDGEN_SYM_QUIET"] = "1"
    boundary = {
        key: options.pop(key) for key in ("size", "corners", "sampling", "sides", "reorient", "layout", "refine", "crs")
    }
    deep = {key: options.pop(key) for key in ("depth", "min_depth", "coast", "land")}
    check_outputs(output, plot)
    begun = start_grid(input, **boundary)
    field = under_of(under, plot, begun.projection)
    start = begun.grid
    solve = _solver(name, quiet, begun.projection, file_walls(input), **options)
    ocean = Ocean(output, begun.projection, begun.islands, options["outside"], **deep)
    if output and isinstance(start, MultiBlock):
        check_layout_written(start, output)
    begin = Announcement(quiet, input, start)
    result: Result | LayoutResult = solve(start, callback=begin)
    begin()
    _report(result, quiet)
    if output:
        ocean.write(result.grid)
        report(quiet, f"wrote {output}")
    certify_and_draw(result.grid, plot, f"{Path(input).stem}: {name}", quiet, result, field)
    if result.stopped_by is StopReason.USER:
        raise click.exceptions.Exit(130)
    if not result.quality.valid or result.status is Status.NOT_DIFFERENTIABLE:
        raise click.exceptions.Exit(1)


def _solver(
    name: str,
    quiet: bool,
    projection: Projection | None,
    described: dict[str, Wall],
    *,
    solver: str,
    interior_only: bool,
    **options: Any,  # noqa: ANN401
) -> Any:  # noqa: ANN401
    """Return the solver as a function of the start; what was not given is left to its own defaults.

    The walls that the start's file describes are those of boundaries that `--wall` does not name; a target replaces
    them.
    """
    from ..solvers import continuation, optimize, solve_euler_lagrange

    passed = "tolerance", "max_iterations", "time_limit", "keep_valid", "spacing", "backend"
    given = {key: options[key] for key in passed if options[key] is not None}
    given["parameters"] = parameters_of(name, options["parameters"])
    weight = options["weight"], options["weight_mode"], options["allow_negative_weight"]
    given["weight"] = _weight(*weight, options["outside"], projection)
    given["fields"] = fields_of(options["fields"], options["outside"], projection)
    given["target"] = target_of(options["target"], projection)
    given["walls"] = {**(described if given["target"] is None else {}), **walls_on(walls_of(options["walls"]))} or None
    if quiet:
        given["progress"] = False
    if options["slide"]:
        if solver not in ("newton", "local"):
            raise GridgenError(f"--slide belongs to the discrete energy (newton, local), not to --solver {solver}")
        given["slide"] = sliding(options["slide"])
    if solver in ("newton", "local"):
        if options["control"] is not None:
            raise GridgenError(f"--control belongs to the equations (euler-lagrange, relaxation), not to {solver}")
        method = cast("Literal['newton', 'local']", solver)
        given |= {"functional": name, "method": method, "interior_only": interior_only}
        if options["continuation"] is None:
            return partial(optimize, **given)
        parameter, values = continuation_of(options["continuation"])
        return partial(continuation, parameter=parameter, values=values, **given)
    if options["continuation"] is not None:
        raise GridgenError(f"--continuation belongs to the discrete energy (newton, local), not to --solver {solver}")
    if interior_only:
        raise GridgenError(f"--interior-only belongs to the discrete energy (newton, local), not to --solver {solver}")
    if options["control"] is not None:
        given["control"] = control_of(options["control"])
    way: Literal["newton", "relaxation"] = "relaxation" if solver == "relaxation" else "newton"
    return partial(solve_euler_lagrange, functional=name, method=way, **given)


def _weight(
    text: str | None, mode: str | None, allow_negative: bool, outside: Outside, projection: Projection | None
) -> Weight | None:
    """Return the weight that the options give."""
    from ..fields import Weight

    if text is None:
        if mode or allow_negative:
            raise GridgenError("--weight-mode and --allow-negative-weight need a --weight FIELD")
        return None
    source = field_of(text, smooth=mode == "differentiated", outside=outside, projection=projection)
    return Weight(source, mode or "frozen", allow_negative)  # type: ignore[arg-type]


def _report(result: Result | LayoutResult, quiet: bool) -> None:
    """Print what came out; where it did not converge, or is folded, that is reported on standard error as well."""
    from ..solvers import Result

    if result.converged:
        report(quiet, f"converged in {result.iterations} iterations: {result.message}")
    else:
        click.secho(f"not converged in {result.iterations} iterations: {result.message}", fg="yellow", err=True)
    report(quiet, result.quality.summary())
    if isinstance(result, Result) and result.change is not None and result.change.before.valid:
        report(quiet, result.change.summary())
    if quiet and not result.quality.valid:
        click.secho(result.quality.describe_folds(), fg="red", err=True)


@click.command()
@click.argument("file")
@click.option(
    "--layout", is_flag=True, help="Measure and draw a file of one block as a layout: with its boundaries' names."
)
@click.option("--plot", metavar="PNG", help="Draw the grid, and why no valid one exists: .png, .svg or .pdf.")
@under_option
@option(
    OUTLINE["crs"],
    more=" before it is measured, for lengths and angles on Earth: auto, or a system such as EPSG:32616",
    metavar="CRS",
)
@click.option("--json", "as_json", is_flag=True, help="Print the measures as JSON, by the names of `gg.Quality`.")
def quality(file: str, layout: bool, plot: str | None, under: str | None, crs: str | None, as_json: bool) -> None:
    """Measure the grid in FILE; exits with 1 if a cell is folded."""
    import json

    from ..io import read
    from ..topology import quality as measure

    check_outputs(None, plot)
    begun = on_plane(read(file, layout=layout), crs, file)
    given, field = begun.grid, under_of(under, plot, begun.projection)
    measured = measure(given)
    click.echo(json.dumps(measured.as_dict(), indent=2) if as_json else measured.summary())
    if plot or not as_json:
        certify_and_draw(given, plot, Path(file).stem, quiet=as_json, under=field)
    if not measured.valid:
        raise click.exceptions.Exit(1)


@click.command()
def domains() -> None:
    """List the classical domains."""
    from ..boundary import domain_description, domain_names

    for name in domain_names():
        click.echo(f"{name:<18}{domain_description(name)}")
