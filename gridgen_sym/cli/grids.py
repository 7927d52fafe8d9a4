"""Commands about grids: `grid`, `quality`, `domains`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gridgen_sym.errors import GridgenError, MissingExtraError

from .base import functionals_option

if TYPE_CHECKING:
    from gridgen_sym.grids import Grid
    from gridgen_sym.solvers import Result, Weight

_DEFAULT_CELLS = (40, 40)
_PICTURES = (".png", ".svg", ".pdf")
_SOLVERS = ("newton", "local", "euler-lagrange", "relaxation")


@click.command()
@click.argument("input")
@click.option("-f", "--functional", "name", required=True, metavar="NAME", help="See 'gridgen-sym functionals'.")
@click.option(
    "--solver",
    type=click.Choice(_SOLVERS),
    default="newton",
    show_default=True,
    help="newton and local minimise the discrete energy; euler-lagrange and relaxation solve its equations.",
)
@click.option("--size", type=int, nargs=2, metavar="NI NJ", help="Number of cells along xi and eta.  [default: 40 40]")
@click.option("-o", "--output", metavar="OUT", help="Write the grid: .vts, .xyz, .csv or .npz.")
@click.option("--plot", metavar="PNG", help="Draw the grid, folded cells in red: .png, .svg or .pdf.")
@click.option("--weight", metavar="FORMULA", help="Adaptive weight s(x, y), such as '1 + 5*exp(-20*(x**2 + y**2))'.")
@click.option(
    "--weight-mode",
    type=click.Choice(("frozen", "differentiated")),
    help="Hold the weight at the nodes, or differentiate through it.  [default: frozen]",
)
@click.option("--allow-negative-weight", is_flag=True, help="Accept a weight that is negative somewhere.")
@click.option(
    "--parameter", "parameters", multiple=True, metavar="NAME=VALUE", help="Set a parameter. May be repeated."
)
@click.option("--tolerance", type=float, help="Factor by which the gradient or the residual must fall.")
@click.option("--max-iterations", type=int, help="Newton steps, or sweeps.")
@click.option("--keep-valid/--no-keep-valid", default=None, help="Whether a valid grid may not fold on the way.")
@click.option("--interior-only", is_flag=True, help="Sum over corners at inner nodes only (newton and local).")
@click.option("--backend", type=click.Choice(("c", "numpy")), help="Compiled or not.  [default: c if possible]")
@click.option("--reorient", is_flag=True, help="Accept an outline that runs clockwise.")
@click.option("--quiet", is_flag=True, help="Say nothing but what is wrong.")
@functionals_option
def grid(input: str, name: str, output: str | None, plot: str | None, quiet: bool, **options: Any) -> None:  # noqa: ANN401
    """Make a grid from INPUT: a classical domain, an outline or a grid file.

    INPUT is the name of a domain (see 'gridgen-sym domains'; parameters as in horseshoe_map:R=4.5), a CSV file with
    an outline ('# corners: ...'), or a grid file, which is the start. Exits with 1 if the result has folded cells.
    """
    from gridgen_sym.functionals import functional

    if quiet:
        os.environ["GRIDGEN_SYM_QUIET"] = "1"
    functional(name)
    solve = _solver(name, quiet, **options)
    _check_outputs(output, plot)
    start = start_grid(input, options["size"], options["reorient"])
    _say(quiet, f"start: {input}, {_count(start)}, {_folds(start)}")
    result: Result = solve(start)
    _report(result, quiet)
    _write(result.grid, output, plot, name, input, quiet)
    if result.interrupted:
        raise click.exceptions.Exit(130)
    if not result.quality.valid:
        raise click.exceptions.Exit(1)


def start_grid(source: str, size: tuple[int, int] | None, reorient: bool = False) -> Grid:
    """Return the grid to start from.

    Args:
        source: a domain with its parameters, an outline's file or a grid file.
        size: number of cells; not for a grid file, which has its own.
        reorient: accept a clockwise outline.

    Raises:
        GridgenError: if it is none of these, or cannot be read.
    """
    from gridgen_sym.grids import Outline, domain, known_suffixes, read

    ni, nj = (cells + 1 for cells in size or _DEFAULT_CELLS)
    if min(ni, nj) < 3:
        raise GridgenError(f"--size is the number of cells along xi and eta, at least 2 2; came {ni - 1} {nj - 1}")
    suffix = Path(source).suffix.lower()
    if suffix not in known_suffixes() and not Path(source).is_file():
        key, _, rest = source.partition(":")
        return domain(key, ni, nj, **_assignments(rest.split(",") if rest else [], f"the domain {key!r}"))
    if suffix == ".csv" and _is_outline(source):
        return Outline.read(source, reorient=reorient).grid(ni, nj)
    if size is not None:
        raise GridgenError(f"{source} is a grid file and has its own number of cells: drop --size")
    return read(source)


def _is_outline(path: str) -> bool:
    from gridgen_sym.atomic import read_bytes

    lines = read_bytes(path).decode("utf-8-sig", errors="replace").splitlines()
    return any(line.startswith("#") and line[1:].strip().lower().startswith("corners") for line in lines)


def _assignments(texts: list[str] | tuple[str, ...], of: str) -> dict[str, float]:
    """Return the values of texts such as `R=4.5`."""
    values = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            if not (name and equals):
                raise ValueError
            values[name.strip()] = float(value)
        except ValueError:
            raise GridgenError(f"a parameter of {of} is written NAME=NUMBER, such as k=0.5; came {text!r}") from None
    return values


def _solver(name: str, quiet: bool, *, solver: str, interior_only: bool, **options: Any) -> Any:  # noqa: ANN401
    """Return the solver as a function of the start; what was not given is left to its own defaults."""
    from gridgen_sym.solvers import optimize, solve_euler_lagrange

    given = {key: options[key] for key in ("tolerance", "max_iterations", "keep_valid", "backend")}
    given = {key: value for key, value in given.items() if value is not None}
    given["parameters"] = _assignments(options["parameters"], f"the functional {name!r}")
    given["weight"] = _weight(options["weight"], options["weight_mode"], options["allow_negative_weight"])
    if quiet:
        given["progress"] = False
    if solver in ("newton", "local"):
        return lambda start: optimize(start, name, solver, interior_only=interior_only, **given)  # type: ignore[arg-type]
    if interior_only:
        raise GridgenError(f"--interior-only belongs to the discrete energy (newton, local), not to --solver {solver}")
    return lambda start: solve_euler_lagrange(
        start, name, "relaxation" if solver == "relaxation" else "newton", **given
    )


def _weight(formula: str | None, mode: str | None, allow_negative: bool) -> Weight | None:
    from gridgen_sym.solvers import Weight

    if formula is None:
        if mode or allow_negative:
            raise GridgenError("--weight-mode and --allow-negative-weight need a --weight FORMULA")
        return None
    return Weight(formula, mode or "frozen", allow_negative)  # type: ignore[arg-type]


def _check_outputs(output: str | None, plot: str | None) -> None:
    """Refuse files that cannot be written before any work is done."""
    from importlib.util import find_spec

    from gridgen_sym.grids import known_suffixes

    if output and Path(output).suffix.lower() not in known_suffixes():
        raise GridgenError(f"cannot write {output}: its suffix must be one of {', '.join(known_suffixes())}")
    for path in filter(None, (output, plot)):
        if not Path(path).absolute().parent.is_dir():
            raise GridgenError(f"cannot write {path}: the folder {Path(path).absolute().parent} does not exist")
    if plot and Path(plot).suffix.lower() not in _PICTURES:
        raise GridgenError(f"cannot write {plot}: a picture's suffix must be one of {', '.join(_PICTURES)}")
    if plot and find_spec("matplotlib") is None:
        raise MissingExtraError("--plot", "plot", "matplotlib")


def _report(result: Result, quiet: bool) -> None:
    """Print what came out; where it did not converge, or is folded, that is said on standard error as well."""
    if result.converged:
        _say(quiet, f"converged in {result.iterations} iterations: {result.message}")
    else:
        click.secho(f"not converged in {result.iterations} iterations: {result.message}", fg="yellow", err=True)
    _say(quiet, result.quality.summary())
    if quiet and not result.quality.valid:
        click.secho(result.quality.describe_folds(), fg="red", err=True)


def _write(made: Grid, output: str | None, plot: str | None, name: str, source: str, quiet: bool) -> None:
    if output:
        made.write(output)
        _say(quiet, f"wrote {output}")
    if plot:
        from gridgen_sym.grids import plot_grid

        plot_grid(made, plot, title=f"{Path(source).stem}: {name}")
        _say(quiet, f"wrote {plot}")


def _say(quiet: bool, text: str) -> None:
    if not quiet:
        click.echo(text)


def _count(grid: Grid) -> str:
    ni, nj = grid.shape
    return f"{ni - 1} x {nj - 1} cells"


def _folds(grid: Grid) -> str:
    from gridgen_sym.grids import quality

    count = quality(grid).folded_cells
    return f"{count} of them folded" if count else "none of them folded"


@click.command()
@click.argument("file")
def quality(file: str) -> None:
    """Measure the grid in FILE; exits with 1 if a cell is folded."""
    from gridgen_sym.grids import quality as measure
    from gridgen_sym.grids import read

    measured = measure(read(file))
    click.echo(measured.summary())
    if not measured.valid:
        raise click.exceptions.Exit(1)


@click.command()
def domains() -> None:
    """List the classical domains."""
    from gridgen_sym.grids import domain_description, domain_names

    for name in domain_names():
        click.echo(f"{name:<18}{domain_description(name)}")
