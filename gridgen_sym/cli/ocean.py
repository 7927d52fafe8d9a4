"""Grids in longitude and latitude on the command line: depth and land, and the files of ocean models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ..errors import GridgenError
from ..options import OCEAN
from ..outlines import read_content
from .options import option
from .samples import depth_of, source_of

if TYPE_CHECKING:
    from ..arrays import Array
    from ..fields.outside import Outside
    from ..geography import Projection
    from ..grids import Grid
    from ..topology import MultiBlock

_Command = TypeVar("_Command", bound=Callable[..., Any])
_OPTIONS = (
    option(
        OCEAN["depth"],
        more=", for the file of an ocean model: FILE.nc:VARIABLE, or a .npz or .csv file as for a field; heights in a "
        "netCDF file (elevation, or 'positive' up) are turned. Land is where it is not positive, or missing",
        metavar="FILE",
    ),
    option(OCEAN["min_depth"], metavar="METERS"),
    option(
        OCEAN["coast"],
        more=": the file of an outline, whose islands are land, too; in longitude and latitude with --crs",
        metavar="FILE",
    ),
    option(OCEAN["land"], more=": a file as for --depth, not 0 on land", metavar="FILE"),
)


def ocean_options(command: _Command) -> _Command:
    """Add to a command the options that `Ocean` takes."""
    for add in reversed(_OPTIONS):
        command = add(command)
    return command


class Ocean:
    """What the options say of depth and land, read before any work is done."""

    def __init__(
        self,
        output: str | None,
        projection: Projection | None,
        islands: Sequence[Array],
        outside: Outside,
        *,
        depth: str | None,
        min_depth: float | None,
        coast: str | None,
        land: str | None,
    ) -> None:
        """Read the files.

        Raises:
            GridgenError: for a file that cannot be read, or an output that has no place for depth and land.
        """
        self.projection, self._path = projection, output
        self._given: dict[str, Any] = {}
        self._islands = tuple(islands)
        if coast is not None:
            found = read_content(coast)
            curves = [found.points, *found.islands]
            if projection is not None:
                curves = [projection.to_plane(curve) for curve in curves]
            self._given["coast"], self._islands = curves[0], (*self._islands, *curves[1:])
        if depth is not None:
            self._given["depth"] = depth_of(depth, outside, projection)
        if min_depth is not None:
            self._given["min_depth"] = min_depth
        if land is not None:
            self._given["land"] = source_of(land, smooth=False, outside=outside, projection=projection)
            if not callable(self._given["land"]):
                raise GridgenError(f"--land takes a file with samples, such as mask.nc:land; came {land!r}")
        self._model = output is not None and Path(output).suffix.lower() == ".nc"
        if self._given and not self._model:
            raise GridgenError(
                "--depth, --min-depth, --coast and --land belong to the file of an ocean model: -o FILE.nc"
            )

    def write(self, grid: Grid | MultiBlock) -> None:
        """Write a result, in longitude and latitude where it has a projection."""
        from ..grids import Grid
        from ..io import write
        from ..ocean import ocean_grid

        assert self._path
        if not isinstance(grid, Grid):
            write(grid, self._path)
        elif self._model:
            ocean_grid(grid, projection=self.projection, islands=self._islands, **self._given).write(self._path)
        else:
            write(grid if self.projection is None else self.projection.grid_to_geographic(grid), self._path)
