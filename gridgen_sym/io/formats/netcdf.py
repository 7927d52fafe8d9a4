"""netCDF: ROMS' grid files, which are SGRID files, too; the nodes are its psi points."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ...arrays import Array
from ...errors import GridgenError
from ...grids.grid import Grid
from ...ocean import ocean_grid
from ...ocean.netcdf import NetcdfFile, opened
from ..format import Format

#: Coordinates of nodes by ROMS' names, and by those of pyroms, whose nodes have a layer more.
_GEOGRAPHIC, _PLANE = (("lon_psi", "lat_psi"), ("lon_vert", "lat_vert")), (("x_psi", "y_psi"), ("x_vert", "y_vert"))


def encode(grid: Grid, words: Collection[str] = ()) -> bytes:
    """Return the grid as a file of ROMS: staggered points, metric, and a mask that is sea everywhere.

    Raises:
        MissingExtraError: if netCDF4 is not installed, or, with the word `lonlat`, pyproj.
    """
    made = ocean_grid(grid, geographic="lonlat" in words)
    return made.encoded("ugrid" if "ugrid" in words else "roms")


def decode(data: bytes, words: Collection[str] = ()) -> Grid:
    """Return the nodes of a file: those that SGRID's description names, else ROMS' psi points.

    Raises:
        GridgenError: for a damaged file, or one without such nodes.
        MissingExtraError: if netCDF4 is not installed.
    """
    with opened(data) as file:
        x, y = _named(file, plane="plane" in words)
        return Grid.from_planes(*(_nodes(file, name, len(data)) for name in (x, y)))


def _named(file: NetcdfFile, *, plane: bool) -> tuple[str, str]:
    """Return the names of the variables with the coordinates of the nodes."""
    for name in file.variables if not plane else ():
        role = file.attribute(name, "cf_role")
        if role == "grid_topology":
            pair = file.attribute(name, "node_coordinates").split()
            if len(pair) == 2:
                return pair[0], pair[1]
        if role == "mesh_topology":
            raise GridgenError("its faces are a list, by UGRID's conventions, which has no rows and columns")
    for x, y in _PLANE if plane else (*_GEOGRAPHIC, *_PLANE):
        if x in file.variables and y in file.variables:
            return x, y
    known = " or ".join(f"{x}, {y}" for x, y in (_PLANE if plane else (*_GEOGRAPHIC, *_PLANE)))
    raise GridgenError(f"it has no coordinates of nodes: {known}, or those that SGRID's grid_topology names")


def _nodes(file: NetcdfFile, name: str, packed: int) -> Array:
    """Return a coordinate of the nodes, xi first."""
    values = file.numbers(name, packed)
    if values.ndim != 2:
        raise GridgenError(f"its variable {name} has {values.ndim} dimensions; expected eta and xi")
    return np.ascontiguousarray(values.T)


def recognizes(start: bytes) -> bool:
    """Return whether the first bytes may be those of a netCDF file."""
    return start.startswith((b"CDF", b"\x89HDF"))


FORMAT = Format(
    name="netCDF grid of ROMS",
    suffixes=(".nc",),
    decode=decode,
    encode=encode,
    binary=True,
    forms={
        "plane": "read the nodes in the plane, x and y, instead of longitude and latitude",
        "lonlat": "write x and y as longitude and latitude, with lengths on the Earth",
        "ugrid": "write a list of nodes and quadrilaterals, by UGRID's conventions",
    },
    extra=("ocean", "netCDF4"),
    writes="ROMS' grid file, with SGRID's description: points rho, u, v, psi (the nodes), `pm`, `pn`, `angle`, masks",
    reads="the psi points, or the nodes that SGRID's description names",
    test="tests/ocean/test_files.py::test_xgcm_and_xarray_open_what_is_written",
)
