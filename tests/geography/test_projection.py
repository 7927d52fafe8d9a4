"""Projections: places come back, angles and lengths are those on Earth, what is no place is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.geography import land_at, project

pytestmark = pytest.mark.extras

#: Boxes (west, south, east, north): one for each projection that should be chosen, across 180 degrees, at a pole.
BOXES = {
    "stereographic": (10, 50, 14, 52.5),
    "transverse Mercator": (10, 40, 12, 52),
    "Lambert's conformal cone": (-10, 45, 15, 50),
    "Mercator": (100, -2, 140, 2),
    "across": (175, -20, 185, -14),
    "turned": (355, 50, 365, 53),
}


def box(west, south, east, north, count=9):
    s = np.linspace(0, 1, count)[:-1]
    x, y = (np.concatenate((a, b, c, d)) for a, b, c, d in ((s, s * 0 + 1, 1 - s, s * 0), (s * 0, s, s * 0 + 1, 1 - s)))
    return np.stack((west + (east - west) * x, south + (north - south) * y), axis=-1)


@pytest.mark.parametrize("name", BOXES)
def test_places_come_back_and_angles_and_lengths_are_those_on_earth(name):
    from pyproj import Geod

    places = box(*BOXES[name])
    projection = project(places)
    if name in ("transverse Mercator", "Lambert's conformal cone", "Mercator"):
        assert name in projection.name
    plane = projection.to_plane(places)
    np.testing.assert_allclose(projection.to_geographic(plane), places, atol=1e-9)
    # A small cross, turned: its arms have one length and are orthogonal on Earth, where lengths hardly vary.
    arms = 100 * np.array([[1, 2], [-2, 1], [-1, -2], [2, -1]])
    geod, ratios = Geod(ellps="WGS84"), []
    for at in plane:
        (lon, lat), ends = projection.to_geographic(at), projection.to_geographic(at + arms)
        azimuth, _, length = geod.inv(*np.broadcast_arrays(lon, lat, *ends.T)[:4])
        np.testing.assert_allclose(np.diff(azimuth) % 360, 270, atol=0.01)
        np.testing.assert_allclose(length, length[0], rtol=1e-4)
        ratios.append(length[0])
    assert max(ratios) / min(ratios) < 1.02


def test_a_strip_that_lies_across_takes_an_oblique_projection():
    s = np.linspace(0, 30, 20)
    strip = np.concatenate((np.stack((s, 20 + s), -1), np.stack((s + 1, 20 + s), -1)[::-1]))
    assert "oblique Mercator" in project(strip).name


def test_a_pole_is_a_place():
    around = np.stack((np.arange(0, 360, 10.0), np.full(36, 80.0)), axis=-1)
    projection = project(around)
    assert "stereographic at 90.00 N" in projection.name
    np.testing.assert_allclose(np.hypot(*projection.to_plane(around).T), np.hypot(*projection.to_plane(around)[0]))


@pytest.mark.parametrize(
    ("places", "crs", "message"),
    [
        ([[0, 0], [1, 91]], "auto", r"longitude, latitude \[1.0, 91.0\] is no place on Earth"),
        ([[500000, 4e6]], "auto", "are the columns in another order, or projected already"),
        ([[0, np.nan]], "auto", "is no place on Earth"),
        ([[0, 0], [90, 0], [180, 0], [270, 0]], "auto", "a plane shows at most a hemisphere"),
        ([[0, 50]], "EPSG:4326", r"the crs 'EPSG:4326' \(WGS 84\) is no plane"),
        ([[0, 50]], "EPSG:999999", "the crs 'EPSG:999999' is unknown"),
        ([[0, 50]], "no such", "the crs 'no such' is unknown"),
        ([[0, 50], [179, 0]], "+proj=ortho +lat_0=50", "does not show longitude, latitude"),
        ([0.0], "auto", r"shape \(..., 2\)"),
    ],
)
def test_what_is_no_place_or_no_plane_is_refused(places, crs, message):
    with pytest.raises(gg.GridgenError, match=message):
        project(places, crs)


def test_a_system_that_changes_angles_is_reported(capsys):
    project(box(10, 50, 14, 52), "EPSG:32632")
    assert not capsys.readouterr().err
    project(box(10, 50, 14, 52), "EPSG:6933")
    assert "EPSG:6933 changes angles by up to" in capsys.readouterr().err


def test_an_outline_is_projected_with_its_islands(tmp_path, capsys):
    places, island = box(10, 50, 14, 52), [[11, 51], [12, 51], [12, 51.2], [11, 51]]
    path = tmp_path / "sea.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [[*places.tolist(), places[0].tolist()], island]}))
    outline = gg.Outline.read(path, corners=(0, 8, 16, 24), crs="auto")
    said = capsys.readouterr().err
    assert "the plane is that of the projection" in said
    assert "where lengths vary by" in said
    np.testing.assert_allclose(outline.projection.to_geographic(outline.points), places, atol=1e-9)
    np.testing.assert_allclose(outline.projection.to_geographic(outline.islands[0]), island[:3], atol=1e-9)
    assert np.ptp(outline.points, axis=0) == pytest.approx([285e3, 226e3], rel=0.02)  # Meters.
    same = gg.Outline.read(path, corners=(0, 8, 16, 24))
    assert "taken for x and y of a plane" in capsys.readouterr().err
    assert same.projection is None
    np.testing.assert_array_equal(same.points, places)
    path.write_text(path.read_text().replace("{", '{"crs": {"properties": {"name": "EPSG:32632"}}, ', 1))
    with pytest.raises(gg.GridgenError, match="its coordinates are those of a plane already: drop crs='auto'"):
        gg.Outline.read(path, corners="auto", crs="auto")


def test_land_is_what_curves_enclose():
    shapely = __import__("shapely")
    angle = np.linspace(0, 2 * np.pi, 41)[:-1]
    star = np.stack(((2 + np.cos(5 * angle)) * np.cos(angle), (2 + np.cos(5 * angle)) * np.sin(angle)), axis=-1)
    points = np.random.default_rng(1).uniform(-4, 4, (40, 50, 2))
    expected = shapely.contains_xy(shapely.Polygon(star), points[..., 0], points[..., 1])
    np.testing.assert_array_equal(land_at([star, star + 100], points), expected)
    assert 0 < expected.sum() < expected.size
