"""The choice of a projection: of the conformal ones, that which changes lengths least over the places."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import Array
from ..errors import GridgenError

#: Farther from the middle conformal planes enlarge lengths by a factor 2 and more.
_FARTHEST = 90.0
#: A cone needs a latitude of at least so many degrees.
_LOWEST = 5.0


def best_candidate(places: Array) -> tuple[str, str]:
    """Return the definition of a projection, as PROJ takes it, and its name with what it does to lengths.

    Args:
        places: (N, 2), longitude and latitude in degrees.

    Raises:
        GridgenError: for places on more than a hemisphere.
    """
    import pyproj

    lon, lat = _middle(places)
    farthest = float(_arc(places, lon, lat).max())
    if farthest > _FARTHEST:
        raise GridgenError(
            f"the places lie up to {farthest:.0f} degrees from their middle ({lon:.6g}, {lat:.6g}); a plane shows at "
            "most a hemisphere: take a part"
        )
    rated, shown = [], np.concatenate((places, _inwards(places, lon, lat)))
    for rank, (text, name) in enumerate(_candidates(places, lon, lat)):
        try:
            factors = pyproj.Proj(text).get_factors(shown[:, 0], shown[:, 1], errcheck=True)
        except pyproj.exceptions.ProjError:  # It does not show all places.
            continue
        scale = np.asarray(factors.meridional_scale)
        if np.isfinite(scale).all() and scale.min() > 0:
            rated.append((round(float(scale.max() / scale.min()), 6), rank, text, name))
    ratio, _, text, name = min(rated)
    return text, f"{name} at {_shown(lon, lat)}, where lengths vary by {100 * (ratio - 1):.2g} %"


def _candidates(places: Array, lon: float, lat: float) -> Iterator[tuple[str, str]]:
    ellipsoid = "+datum=WGS84 +units=m +no_defs"
    at = f"+lat_0={lat:.6f} +lon_0={lon:.6f} {ellipsoid}"
    yield f"+proj=stere {at}", "stereographic"
    yield f"+proj=tmerc {at}", "transverse Mercator"
    low, high = (float(place) for place in np.quantile(places[:, 1], (0.1, 0.9)))
    if low > _LOWEST or high < -_LOWEST:
        yield f"+proj=lcc +lat_1={low:.6f} +lat_2={high:.6f} {at}", "Lambert's conformal cone"
    yield f"+proj=merc +lat_ts={abs(lat):.6f} +lon_0={lon:.6f} {ellipsoid}", "Mercator"
    azimuth = _azimuth(places, lon, lat)
    yield (
        f"+proj=omerc +lat_0={lat:.6f} +lonc={lon:.6f} +alpha={azimuth:.6f} +gamma=0 {ellipsoid}",
        "oblique Mercator",
    )


def _unit(places: Array) -> Array:
    lon, lat = np.radians(places.T)
    return np.stack((np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)), axis=-1)


def _middle(places: Array) -> tuple[float, float]:
    """Return longitude and latitude of the middle of the smallest box, along the axes of space, around the places."""
    unit = _unit(places)
    x, y, z = (unit.min(axis=0) + unit.max(axis=0)) / 2
    return float(np.degrees(np.arctan2(y, x))), float(np.degrees(np.arctan2(z, np.hypot(x, y))))


def _inwards(places: Array, lon: float, lat: float) -> Array:
    """Return the middle, and the places halfway to it: what a curve encloses has other lengths than its points."""
    middle = _unit(np.array([lon, lat]))
    x, y, z = np.concatenate((middle[np.newaxis], _unit(places) + middle)).T
    return np.asarray(np.degrees(np.stack((np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))), axis=-1)))


def _arc(places: Array, lon: float, lat: float) -> Array:
    """Return the angle in degrees between places and one of them, on the sphere."""
    unit, middle = _unit(places), _unit(np.array([lon, lat]))
    return np.asarray(np.degrees(np.arctan2(np.linalg.norm(np.cross(unit, middle), axis=-1), unit @ middle)))


def _azimuth(places: Array, lon: float, lat: float) -> float:
    """Return the direction of the longest extent at the middle, in degrees from north to east."""
    a, b = np.radians((lon, lat))
    east = np.array([-np.sin(a), np.cos(a), 0.0])
    north = np.array([-np.sin(b) * np.cos(a), -np.sin(b) * np.sin(a), np.cos(b)])
    flat = _unit(places) @ np.stack((east, north), axis=-1)
    _, _, axes = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)
    return float(np.degrees(np.arctan2(axes[0, 0], axes[0, 1])) % 180)


def _shown(lon: float, lat: float) -> str:
    return f"{abs(lat):.2f} {'N' if lat >= 0 else 'S'}, {abs(lon):.2f} {'E' if lon >= 0 else 'W'}"
