"""A grid of an ocean model: nodes, places on Earth, land and depth."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, real_array
from ..atomic import write_bytes
from ..errors import GridgenError, quoted
from ..geography import Projection, land_at
from ..grids.grid import Grid, check_grid
from ..messages import report
from . import roms, ugrid
from .netcdf import Variable, encode
from .staggered import Staggered, staggered

#: A function of x and y in the plane of the grid, or values at the rho points.
Source = Callable[[Array, Array], ArrayLike] | ArrayLike


@dataclass(frozen=True, slots=True, eq=False)
class OceanGrid:
    """A grid of an ocean model; the nodes of the grid are ROMS' psi points.

    Attributes:
        grid: the nodes, in a plane, or in longitude and latitude.
        plane: the staggered points in a plane, in meters; None for a grid in longitude and latitude.
        places: the staggered points in longitude and latitude, in degrees; None for a plane without a projection.
        sea: 1 at sea, 0 on land, (ni+1, nj+1): at the rho points, whose outer ring has the values of its neighbors.
        depth: in meters, positive downwards, at the rho points; None if it is not known.
    """

    grid: Grid
    plane: Staggered | None
    places: Staggered | None
    sea: Array
    depth: Array | None

    @property
    def variables(self) -> Mapping[str, Variable]:
        """ROMS' variables by name, eta first: `lon_rho`, `pm`, `pn`, `angle`, `f`, `mask_rho`, `h`, ..."""
        return dict(roms.variables(self.plane, self.places, self.sea, self.depth))

    def __getitem__(self, name: str) -> Array:
        """Return the numbers of one of ROMS' variables, eta first.

        Raises:
            GridgenError: if there is no such variable.
        """
        found = self.variables
        if name not in found:
            raise GridgenError(f"the grid has no variable {quoted(name)}; it has {', '.join(found)}")
        return found[name].values

    def write(
        self, path: str | os.PathLike[str], convention: Literal["roms", "ugrid"] = "roms", *, title: str = ""
    ) -> None:
        """Write a netCDF file.

        Args:
            path: the file.
            convention: `roms`: ROMS' grid file, with SGRID's description of the staggering; or `ugrid`: a list of
                nodes and quadrilaterals.
            title: what the file calls itself.

        Raises:
            GridgenError: if no file can be written there.
            MissingExtraError: if netCDF4 is not installed.
        """
        write_bytes(path, self.encoded(convention, title=title))

    def encoded(self, convention: str = "roms", *, title: str = "") -> bytes:
        """Return the bytes of the file that `write` writes."""
        more = {"title": title} if title else {}
        if convention == "roms":
            made = roms.variables(self.plane, self.places, self.sea, self.depth)
            return encode(made, roms.ATTRIBUTES | more)
        if convention != "ugrid":
            raise GridgenError(f"the convention must be 'roms' or 'ugrid'; came {quoted(convention)}")
        points = self.plane if self.places is None else self.places
        assert points is not None  # One of them is there.
        made = ugrid.variables(points, self.sea, self.depth, geographic=self.places is not None)
        return encode(made, ugrid.ATTRIBUTES | more)


def ocean_grid(
    grid: Grid,
    *,
    projection: Projection | None = None,
    geographic: bool = False,
    islands: Sequence[ArrayLike] = (),
    coast: ArrayLike | None = None,
    land: Source | None = None,
    depth: Source | None = None,
    min_depth: float = 1.0,
) -> OceanGrid:
    """Return a grid with what an ocean model needs: metric, land and depth.

    Args:
        grid: the nodes, in the plane of the projection, or, if `geographic`, in longitude and latitude.
        projection: of longitude and latitude onto the plane, as `Outline.read(path, crs="auto").projection`.
        geographic: whether the grid is in longitude and latitude, in degrees.
        islands: closed curves (n, 2) where the grid is: cells whose centers lie within are land.
        coast: coast around the water, outside of which is land: a closed curve (n, 2), likewise.
        land: where there is land, too: a function of x and y, or values at the rho points (ni+1, nj+1), not
            0 on land.
        depth: depth in meters, positive downwards: a function, or values, likewise. Where it is not positive, or not a
            number, is land; so is where the nearest sample of a raster is missing.
        min_depth: least depth in meters, also on land.

    Raises:
        GridgenError: for values of another shape, or a grid that has a projection and is `geographic`.
    """
    check_grid(grid)
    if projection is not None and geographic:
        raise GridgenError("a grid in longitude and latitude is in no plane: give the projection or geographic=True")
    if not min_depth > 0:
        raise GridgenError(f"min_depth must be positive: ROMS divides by depths; came {quoted(min_depth)}")
    points = staggered(grid.xy)
    x, y = np.moveaxis(points.rho, -1, 0)
    curves = [real_array(island, "an island") for island in islands]
    on_land = land_at(curves, points.rho)
    _report_small(curves, points.rho[1:-1, 1:-1])
    if coast is not None:
        on_land |= ~land_at([real_array(coast, "the coast")], points.rho)
    if land is not None:
        on_land |= _values(land, x, y, "land") != 0
    deep = None
    if depth is not None:
        deep = _values(depth, x, y, "depth")
        missing = getattr(depth, "missing", None)
        on_land |= ~(deep > 0) | (missing(x, y) if missing else False)
    on_land = np.pad(on_land[1:-1, 1:-1], 1, mode="edge")
    if deep is not None:
        deep = np.where(on_land, min_depth, np.fmax(deep, min_depth))
    places = _mapped(points, projection) if projection is not None else None
    return OceanGrid(
        grid, None if geographic else points, points if geographic else places, np.where(on_land, 0.0, 1.0), deep
    )


def _values(source: Source, x: Array, y: Array, what: str) -> Array:
    given = source(x, y) if callable(source) else source
    values = real_array(given, what)
    _check_covered(source, x[1:-1, 1:-1], y[1:-1, 1:-1], what)
    if values.shape != x.shape:
        raise GridgenError(f"{what} must have a value at each rho point, shape {x.shape}; came {values.shape}")
    return values


def _check_covered(source: Source, x: Array, y: Array, what: str) -> None:
    """Refuse samples that do not reach all centers of cells, unless the nearest one counts there."""
    covers, missing = getattr(source, "covers", None), getattr(source, "missing", None)
    if covers is None or missing is None or getattr(source, "beyond", "") == "nearest":
        return
    outside = ~(covers(x, y) | missing(x, y))
    if outside.any():
        i, j = (int(index) for index in np.argwhere(outside)[0])
        raise GridgenError(
            f"{what} is known by samples that do not reach {int(outside.sum())} of {outside.size} cells, such as "
            f"({i}, {j}) at ({x[i, j]:.6g}, {y[i, j]:.6g}): sample the whole domain, or let the nearest sample count "
            "there, with outside='nearest' where the samples are given (--outside nearest)"
        )


def _report_small(islands: Sequence[Array], centers: Array) -> None:
    """Report islands in which no center of a cell lies."""
    lost = sum(not land_at([island], centers).any() for island in islands)
    if lost:
        report(f"{lost} of {len(islands)} islands hold no center of a cell, and are not in the mask: take more cells")


def _mapped(points: Staggered, projection: Projection) -> Staggered:
    """Return staggered points in longitude and latitude."""
    names = ("rho", "u", "v", "psi", "u_all", "v_all")
    return Staggered(*(projection.to_geographic(getattr(points, name)) for name in names))
