"""Projections: between longitude and latitude and a plane in which grids are made, with pyproj."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, real_array
from ..errors import GridgenError, MissingExtraError, quoted, shortened
from ..grids.grid import Grid
from ..messages import report
from .candidates import best_candidate

#: Angles on the Earth may differ by so many degrees from those in a plane without a remark.
_ANGLE = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """A plane for places around a center.

    Attributes:
        crs: the coordinate reference system of the plane, as PROJ names it: `EPSG:32616`, `+proj=stere ...`.
        name: what it is, for messages.
        middle: longitude in degrees; longitudes are returned within 180 degrees of it.
    """

    crs: str
    name: str
    middle: float
    _transformer: Any

    def to_plane(self, lonlat: ArrayLike) -> Array:
        """Return x and y of places (..., 2) in longitude and latitude, in degrees.

        Raises:
            GridgenError: for what are no places on Earth, or a place that the projection cannot show.
        """
        places = checked_places(lonlat)
        x, y = self._transformer.transform(places[..., 0], places[..., 1])
        plane = np.stack((x, y), axis=-1)
        lost = ~np.isfinite(plane).all(axis=-1)
        if lost.any():
            raise GridgenError(
                f"{self.name} ({self.crs}) does not show longitude, latitude {places[lost][0].tolist()}: take another "
                "crs, or 'auto'"
            )
        return plane

    def to_geographic(self, xy: ArrayLike) -> Array:
        """Return longitude and latitude in degrees of points (..., 2) of the plane; NaN where it shows no place."""
        points = real_array(xy, "points of a projection's plane")
        lon, lat = self._transformer.transform(points[..., 0], points[..., 1], direction="INVERSE", errcheck=False)
        places = np.stack((lon, lat), axis=-1)
        places[~np.isfinite(places).all(axis=-1)] = np.nan
        places[..., 0] = self.middle + (places[..., 0] - self.middle + 180) % 360 - 180
        return places

    def grid_to_plane(self, grid: Grid) -> Grid:
        """Return a grid in longitude and latitude as one in the plane."""
        return Grid(self.to_plane(grid.xy))

    def grid_to_geographic(self, grid: Grid) -> Grid:
        """Return a grid in the plane as one in longitude and latitude, in degrees.

        Raises:
            GridgenError: if a node has no place on Earth.
        """
        return Grid(self.to_geographic(grid.xy))

    def __repr__(self) -> str:
        """Say what it is."""
        return f"<projection {self.name}: {self.crs}>"


def project(lonlat: ArrayLike, crs: str = "auto") -> Projection:
    """Return a projection of places in longitude and latitude (WGS 84) onto a plane.

    Args:
        lonlat: (N, 2), in degrees: what the plane has to show, such as the points of an outline.
        crs: the system of the plane, as pyproj takes it (`EPSG:32616`, a PROJ string), or `auto`: of the conformal
            projections stereographic, transverse Mercator, Mercator, Lambert's cone and oblique Mercator that which
            changes lengths least. Conformal ones keep angles, so that what is orthogonal in the plane is so on Earth.

    Raises:
        GridgenError: for what are no places on Earth, or more than a hemisphere of it, or an unknown system or one that
            is no plane. A system that does not keep angles is reported.
        MissingExtraError: if pyproj is not installed.
    """
    try:
        import pyproj
    except ImportError:
        raise MissingExtraError("a projection of longitude and latitude", "geo", "pyproj") from None
    places = checked_places(lonlat).reshape(-1, 2)
    text, name = (crs, crs) if crs != "auto" else best_candidate(places)
    try:
        system = pyproj.CRS.from_user_input(text)
        transformer = pyproj.Transformer.from_crs("OGC:CRS84", system, always_xy=True)
    except (pyproj.exceptions.CRSError, pyproj.exceptions.ProjError, TypeError, AttributeError) as error:
        raise GridgenError(
            f"the crs {quoted(crs)} is unknown ({shortened(error)}): name a projected system such as EPSG:32616, or "
            "'auto'"
        ) from error
    if not system.is_projected:
        raise GridgenError(
            f"the crs {quoted(crs)} ({system.name}) is no plane: name a projected system such as EPSG:32616, or 'auto'"
        )
    if crs != "auto":
        name = system.name
        _report_angles(pyproj.Proj(system), places, crs)
    made = Projection(text, name, _middle(places[:, 0]), transformer)
    made.to_plane(places)
    return made


def checked_places(lonlat: ArrayLike) -> Array:
    """Return places (..., 2) in degrees, once they are on Earth.

    Raises:
        GridgenError: naming the first that is not.
    """
    places = real_array(lonlat, "longitude and latitude")
    if places.shape[-1:] != (2,) or not places.size:
        raise GridgenError(f"places need longitude and latitude, shape (..., 2); came {places.shape}")
    bad = ~((np.abs(places[..., 0]) <= 720) & (np.abs(places[..., 1]) <= 90))
    if bad.any():
        raise GridgenError(
            f"longitude, latitude {places[bad][0].tolist()} is no place on Earth: latitudes are from -90 to 90 "
            "degrees, longitudes from -720 to 720; are the columns in another order, or projected already?"
        )
    return places


def _middle(longitudes: Array) -> float:
    """Return the longitude around which those of results lie, in the turn of those that were given."""
    mean = float(np.degrees(np.angle(np.exp(1j * np.radians(longitudes)).mean())))
    return mean + 360 * round((float(np.median(longitudes)) - mean) / 360)


def _report_angles(proj: Any, places: Array, crs: str) -> None:  # noqa: ANN401
    """Report a system in whose plane angles are not those on Earth."""
    change = float(np.max(proj.get_factors(*places.T).angular_distortion))
    if change > _ANGLE:
        report(
            f"{crs} changes angles by up to {change:.2g} degrees, so that a grid that is orthogonal in its plane is "
            "not so on Earth; 'auto' takes a projection that keeps angles"
        )
