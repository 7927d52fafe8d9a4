"""The grid that the commands `grid` and `adapt` start from: a classical domain, an outline or a grid file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..errors import GridgenError, quoted
from ..options import OUTLINE
from ..parsing import number_in, whole_number_in
from .layouts import DESCRIPTIONS, layout_start
from .options import option
from .types import integer

if TYPE_CHECKING:
    from ..arrays import Array
    from ..geography import Projection
    from ..grids import Grid
    from ..topology import MultiBlock

_Command = TypeVar("_Command", bound=Callable[..., Any])
_DEFAULT_CELLS = (40, 40)
_OPTIONS = (
    click.option(
        "--size",
        type=integer,
        nargs=2,
        metavar="NI NJ",
        help="Number of cells along xi and eta; also NIxNJ.  [default: 40 40]",
    ),
    option(
        OUTLINE["corners"],
        more=": auto; four indices of points such as '0,10,20,30'; or four places, to which the nearest points are "
        "taken, such as '0,0 4,0 4,1 0,1', in longitude and latitude with --crs",
        metavar="CORNERS",
    ),
    option(OUTLINE["sampling"]),
    option(
        OUTLINE["spacing"],
        *("--side", "sides"),
        more=" of an outline: left=tanh:first=1e-3,last=1e-2 (or geometric, sinh), bottom=tanh:at=0.4,size=1e-3, or "
        "top=equal",
        multiple=True,
        metavar="SIDE=LAW",
    ),
    option(OUTLINE["reorient"], more=": an outline, or the boundary of a grid file"),
    option(
        OUTLINE["crs"],
        more=", of an outline or a grid file: auto, which keeps angles, or a system such as EPSG:32616; x and y of "
        "formulas are in this plane, in meters, files of fields and OUT are in longitude and latitude",
        metavar="CRS",
    ),
)


@dataclass(frozen=True, slots=True)
class Start:
    """What the commands `grid` and `adapt` begin with.

    Attributes:
        grid: of one block or several.
        projection: of longitude and latitude onto the plane of the grid; None without `--crs`.
        islands: closed curves (n, 2) in this plane.
    """

    grid: Grid | MultiBlock
    projection: Projection | None = None
    islands: tuple[Array, ...] = ()


def start_options(command: _Command) -> _Command:
    """Add to a command the options that `start_grid` takes."""
    for add in reversed(_OPTIONS):
        command = add(command)
    return command


def start_grid(
    source: str,
    size: tuple[int, int] | None = None,
    *,
    corners: str | None = None,
    sampling: str | None = None,
    sides: tuple[str, ...] = (),
    reorient: bool = True,
    layout: bool = False,
    refine: int | None = None,
    crs: str | None = None,
) -> Start:
    """Return what to start from: a grid of several blocks, if a file has or describes these, or a name is a layout's.

    Args:
        source: a domain or a layout with its parameters, the file of an outline, a grid, or a layout's description.
        size: number of cells; not for a grid file or a layout, which have their own.
        corners: of an outline: 'auto', or four indices of its points with commas or blanks between.
        sampling: of an outline: 'features' or 'equal'.
        sides: of an outline: `SIDE=LAW` for each side whose boundary nodes are spaced by a law.
        reorient: reverse a clockwise outline or grid file, and report it.
        layout: connect the sides of a grid file of one block, too; of a name that both have, take the layout.
        refine: of the description of a layout.
        crs: plane onto which an outline or the grid of a file, in longitude and latitude, is projected.

    Raises:
        GridgenError: if it is none of these, or cannot be read.
    """
    from ..boundary import domain, domain_names
    from ..io import holds_grid, known_suffixes
    from ..outlines import is_outline, outline_suffixes
    from ..topology.shapes import layout_names

    ni, nj = (cells + 1 for cells in size or _DEFAULT_CELLS)
    if min(ni, nj) < 3:
        raise GridgenError(f"--size is the number of cells along xi and eta, at least 2 2; came {ni - 1} {nj - 1}")
    suffix = Path(source).suffix.lower()
    key, _, rest = source.partition(":")
    if suffix in DESCRIPTIONS or (key in layout_names() and (layout or key not in domain_names())):
        if size or corners or sampling or sides:
            raise GridgenError(f"{source} has its own numbers of cells and sides: drop --size, --corners and --side")
        _refuse_crs(crs, source)
        return Start(layout_start(source, refine))
    if refine is not None:
        raise GridgenError(f"--refine belongs to a layout in TOML or a mesh, which {source} is not")
    is_file = suffix in known_suffixes() or suffix in outline_suffixes() or Path(source).is_file()
    if is_file and not layout and (not holds_grid(source) or is_outline(source)):
        return _outline_start(source, (ni, nj), corners, sampling, sides, reorient, crs)
    for flag, value in (("--corners", corners), ("--sampling", sampling), ("--side", sides or None)):
        if value is not None:
            raise GridgenError(
                f"{flag} belongs to an outline (a file of points, a map or a drawing), which {source} is not"
            )
    if is_file:
        return on_plane(_grid_file(source, size, reorient, layout), crs, source)
    _refuse_crs(crs, source)
    if layout:
        raise GridgenError(f"--layout belongs to a grid file or a layout's name, which {source} is not")
    return Start(domain(key, ni, nj, **assignments(rest.split(",") if rest else [], f"the domain {quoted(key)}")))


def assignments(texts: list[str] | tuple[str, ...], of: str) -> dict[str, float]:
    """Return the values of texts such as `R=4.5`."""
    values = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            if not (name and equals):
                raise ValueError
            values[name.strip()] = number_in(value)
        except ValueError:
            raise GridgenError(
                f"a parameter of {of} is written NAME=NUMBER, such as k=0.5; came {quoted(text)}"
            ) from None
    return values


def continuation_of(text: str) -> tuple[str, list[float]]:
    """Return the parameter and its values of a text such as `omega=1,0.1,0.01`."""
    name, equals, values = text.partition("=")
    try:
        if not (name.strip() and equals):
            raise ValueError
        return name.strip(), [number_in(value) for value in values.split(",")]
    except ValueError:
        raise GridgenError(
            f"--continuation is written NAME=NUMBER,NUMBER,..., such as omega=1,0.1,0.01; came {quoted(text)}"
        ) from None


def parameters_of(name: str, texts: tuple[str, ...]) -> dict[str, float]:
    """Return the values of a functional's parameters from texts such as `k=0.5`, once it has accepted them."""
    from ..functionals import functional

    definition = functional(name)
    given = assignments(texts, f"the functional {name!r}")
    definition.values(given)
    return given


def _refuse_crs(crs: str | None, source: str) -> None:
    if crs is not None:
        raise GridgenError(
            f"--crs belongs to an outline or a grid file of one block, in longitude and latitude, which {source} is not"
        )


def on_plane(grid: Grid | MultiBlock, crs: str | None, source: str) -> Start:
    """Return the grid of a file, in the plane of a projection if its nodes are places."""
    from ..geography import project
    from ..grids import Grid
    from ..messages import report

    if crs is None or not isinstance(grid, Grid):
        _refuse_crs(crs, source)
        return Start(grid)
    projection = project(grid.xy.reshape(-1, 2), crs)
    report(f"the plane is that of the projection {projection.name}")
    return Start(projection.grid_to_plane(grid), projection)


def _outline_start(
    path: str,
    shape: tuple[int, int],
    corners: str | None,
    sampling: str | None,
    sides: tuple[str, ...],
    reorient: bool,
    crs: str | None,
) -> Start:
    """Return the grid of an outline's file, and its islands."""
    from ..boundary import Outline

    chosen: Any = corners if corners in (None, "auto") else _corners_of(str(corners))
    outline = Outline.read(path, corners=chosen, reorient=reorient, crs=crs)
    # Corners that were chosen by number are kept, others may be moved.
    wanted: Any = chosen if chosen in (None, "auto") else outline.corners
    laws = dict(_law_of(text) for text in sides)
    grid = outline.grid(*shape, wanted, sampling or "features", laws)  # type: ignore[arg-type]
    return Start(grid, outline.projection, outline.islands)


def _corners_of(text: str) -> list[Any]:
    """Return the four indices of points, or places, that `--corners` gives.

    Raises:
        GridgenError: for anything else.
    """
    places = [word.split(",") for word in text.replace(";", " ").split()]
    try:
        if len(places) == 4 and all(len(place) == 2 and all(place) for place in places):
            return [[number_in(word) for word in place] for place in places]
        indices = [whole_number_in(word) for word in text.replace(",", " ").split()]
        if len(indices) == 4:
            return indices
    except ValueError:
        pass
    raise GridgenError(
        "--corners is auto, four whole numbers such as '0,10,20,30', or four places such as '0,0 4,0 4,1 0,1'; came "
        f"{quoted(text)}"
    )


def _law_of(text: str) -> tuple[str, str]:
    """Return the side and the law of `SIDE=LAW`."""
    side, equals, law = text.partition("=")
    if not equals:
        raise GridgenError(f"--side {quoted(text)} has no law: write for example left=tanh:first=1e-3")
    return side, law


def _grid_file(path: str, size: tuple[int, int] | None, reorient: bool, layout: bool) -> Grid | MultiBlock:
    """Return the grid of a file; one block that runs clockwise is mirrored and reported, or refused."""
    from ..certificates import certificates
    from ..grids import Grid
    from ..io import read
    from ..messages import report
    from ..topology import MultiBlock

    if size is not None:
        raise GridgenError(f"{path} is a grid file, which has its own number of cells: drop --size")
    grid = read(path, layout=layout)
    if isinstance(grid, MultiBlock):
        _check_orientation(grid, path)
        return grid
    if reorient and any(found.kind == "clockwise" for found in certificates(grid)):
        report(f"{path} runs clockwise: its sides left and right are exchanged")
        return Grid(grid.xy[::-1])
    return grid


def _check_orientation(layout: MultiBlock, path: str) -> None:
    """Refuse blocks that run clockwise: of several each has neighbors, so that none is mirrored by itself."""
    from ..grids import corner_jacobians

    for name, block in zip(layout.names, layout.blocks, strict=True):
        if corner_jacobians(block.x, block.y).sum() < 0:
            raise GridgenError(
                f"block {name} of {path} runs clockwise, its Jacobians are negative: exchange its sides left and right "
                "(xy[::-1]) in the file, and in the map beside it"
            )
