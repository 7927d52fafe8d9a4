"""Polygons of maps: GeoJSON, WKT and shapefiles, with holes as islands, and whatever bytes."""

from __future__ import annotations

import contextlib
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gridgen_sym as gg
from gridgen_sym.outlines import outline_formats, read_content
from gridgen_sym.outlines.loops import contains, joined

LAKE = [[0, 0], [4, 0], [4, 3], [0, 3]]
ISLANDS = [[[1, 1], [1, 2], [2, 2]], [[3, 1], [3, 2], [3.5, 1.5]]]
POND = [[10, 10], [11, 10], [11, 11]]


def closed(curve):
    """Close a curve, and repeat a point, as maps do."""
    return [*curve, curve[-1], curve[0]]


POLYGON = {"type": "Polygon", "coordinates": [closed(LAKE), *map(closed, ISLANDS)]}
PONDS = {"type": "MultiPolygon", "coordinates": [[closed(POND)], POLYGON["coordinates"]]}


def is_the_lake(found):
    """Return whether a file held the lake with its islands, whatever the directions and starts of the curves are."""
    outline = gg.Outline(found.points, "auto", islands=found.islands)
    same = sorted(outline.points.tolist()) == sorted(LAKE)
    return same and sorted(sorted(one.tolist()) for one in outline.islands) == sorted(map(sorted, ISLANDS))


@pytest.mark.parametrize(
    "top",
    [
        POLYGON,
        PONDS,
        {"type": "Feature", "properties": None, "geometry": POLYGON},
        {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": one} for one in (PONDS, None)]},
        {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [0, 0]}, POLYGON]},
        {"type": "MultiLineString", "coordinates": [*map(closed, ISLANDS), LAKE[:3], [*LAKE[:1], *LAKE[:1:-1]]]},
    ],
)
def test_geojson_with_holes_is_an_outline_with_islands(tmp_path, top, capsys):
    path = tmp_path / "lake.geojson"
    path.write_text(json.dumps(top))
    found = read_content(path)
    assert is_the_lake(found)
    assert found.geographic is True
    assert ("largest of 2 polygons" in capsys.readouterr().err) == ("MultiPolygon" in path.read_text())
    path.rename(tmp_path / "lake.what")
    assert is_the_lake(read_content(tmp_path / "lake.what"))


def test_name_and_corners_are_properties(tmp_path):
    path = tmp_path / "lake.json"
    path.write_text(
        json.dumps({"type": "Feature", "properties": {"name": "L", "corners": [1, 2, 3, 0]}, "geometry": POLYGON})
    )
    outline = gg.Outline.read(path)
    assert (outline.name, outline.points.tolist()) == ("L", np.roll(LAKE, -1, axis=0).tolist())
    path.write_text(path.read_text().replace("[1, 2, 3, 0]", '"auto"'))
    with pytest.raises(gg.GridgenError, match="its property corners is 'auto'; expected four whole numbers"):
        gg.Outline.read(path)


def test_corners_are_the_points_nearest_to_four_places(tmp_path):
    """Whichever way the curve runs, and wherever it begins: from the first place counter-clockwise."""
    places = [[4.1, 2.9], [-0.2, 3.3], [0.3, 0.1], [4, -0.1]]
    for curve in (LAKE, LAKE[::-1]):
        path = tmp_path / "lake.geojson"
        path.write_text(json.dumps({"type": "Polygon", "coordinates": [closed(np.roll(curve, 1, axis=0).tolist())]}))
        outline = gg.Outline.read(path, corners=places)
        assert outline.points.tolist() == [[4, 3], [0, 3], [0, 0], [4, 0]]
        assert outline.corners == (0, 1, 2, 3)
        assert outline.choose_corners(5, 5, np.roll(places, -1, axis=0)).corners == (1, 2, 3, 0)
    with pytest.raises(gg.GridgenError, match=r"those nearest to the four places are \[0, 0, 2, 3\]"):
        gg.Outline(LAKE, [[0, 0], [0.1, 0.1], [4, 3], [0, 3]])
    with pytest.raises(gg.GridgenError, match="must be finite places"):
        gg.Outline(LAKE, [[0, 0], [np.nan, 0], [4, 3], [0, 3]])
    with pytest.raises(gg.GridgenError, match="runs clockwise"):
        gg.Outline(LAKE[::-1], places, reorient=False)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "it is no JSON"),
        ("[" * 100_000, "it is no JSON"),
        ("[1, 2]", r"it holds \[1, 2\]; expected a FeatureCollection"),
        ('{"type": "FeatureCollection"}', "its features are None"),
        ('{"type": "Topology"}', "the type of a geometry is 'Topology'"),
        ('{"type": "Polygon", "coordinates": [[[0], [1]]]}', "coordinates must be pairs of numbers"),
        ('{"type": "Polygon", "coordinates": {"a": 1}}', "coordinates must be lists of numbers"),
        ('{"type": "Polygon", "coordinates": [[[[0, 0]]]]}', "coordinates must be pairs of numbers"),
        (
            '{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1e200, 1]]]}',
            r"the point \[1e\+200, 1.0\] is not finite",
        ),
        ('{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [NaN, 1]]]}', r"the point \[nan, 1.0\] is not finite"),
        (f'{{"type": "Polygon", "coordinates": [[[0, 0], [1, {10**400}]]]}}', "coordinates must be pairs of numbers"),
        ('{"type": "Polygon", "coordinates": []}', "it has no polygon"),
        ('{"type": "Point", "coordinates": [0, 0]}', "it has no polygon and no line"),
        ('{"type": "LineString", "coordinates": [[0, 0], [1, 0], [1, 1]]}', r"a curve ends at \(1, 1\)"),
    ],
)
def test_bad_geojson_is_one_clear_error(tmp_path, text, message):
    path = tmp_path / "lake.geojson"
    path.write_text(text)
    with pytest.raises(gg.GridgenError, match=f"cannot read {path} as a GeoJSON file: .*{message}"):
        read_content(path)


def test_curves_are_joined_at_their_ends_but_not_where_three_meet():
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    sides = [square[[0, 1]], square[[2, 1]], square[[2, 3]] + 1e-9, square[[0, 3]]]
    (loop,) = joined(sides)
    assert sorted(np.round(loop).tolist()) == sorted(square.tolist())
    with pytest.raises(gg.GridgenError, match=r"3 curves meet at \(1, 0\); expected closed curves"):
        joined([*sides, np.array([[1.0, 0.0], [2.0, 0.0]])])
    assert contains(square, np.array([0.5, 0.5]))
    assert not contains(square, np.array([1.5, 0.5]))


@pytest.mark.extras
def test_wkt(tmp_path):
    import shapely

    geometry = shapely.geometry.shape(PONDS)
    path = tmp_path / "lake.wkt"
    path.write_text(geometry.wkt)
    assert is_the_lake(read_content(path))
    assert read_content(path).geographic is None
    path.write_text(f"SRID=4326;{geometry.wkt}")
    assert is_the_lake(read_content(path))
    assert read_content(path).geographic is True
    path.write_text("POLYGON ((0 0, 1 0")
    with pytest.raises(gg.GridgenError, match="as a geometry in WKT: it is no whole geometry in WKT"):
        read_content(path)


@pytest.mark.extras
def test_shapefiles(tmp_path):
    import shapefile

    path = tmp_path / "lake.shp"
    with shapefile.Writer(str(path)) as writer:
        writer.field("name", "C")
        for polygon in PONDS["coordinates"]:
            turned = [polygon[0][::-1], *(hole[::-1] for hole in polygon[1:])]  # Outer curves run clockwise there.
            writer.poly(turned)
            writer.record("a")
    found = read_content(path)
    assert is_the_lake(found)
    assert found.geographic is None
    path.with_suffix(".prj").write_text('GEOGCS["WGS 84",DATUM["WGS_1984"]]')
    assert read_content(path).geographic is True
    whole = path.read_bytes()
    for cut in (30, 99, 150, len(whole) - 20):
        path.write_bytes(whole[:cut])
        with pytest.raises(gg.GridgenError, match=r"lake\.shp as a shapefile: "):
            read_content(path)


@pytest.mark.extras
@settings(max_examples=60, deadline=None)
@given(st.data())
def test_whatever_bytes_come_are_an_outline_or_one_clear_error(tmp_path_factory, data):
    name = data.draw(st.sampled_from(sorted(outline_formats())))
    starts = [
        b"",
        b"{",
        b"POLYGON",
        b"\x00\x00\x27\x0a" + b"\0" * 96,
        b"0\nSECTION\n2\nENTITIES\n0\nLINE\n",
        b"<svg>",
        b"PK\x03\x04",
    ]
    path = tmp_path_factory.mktemp("bytes") / f"any{outline_formats()[name].suffixes[0]}"
    path.write_bytes(data.draw(st.sampled_from(starts)) + data.draw(st.binary(min_size=1, max_size=300)))
    with contextlib.suppress(gg.GridgenError):
        read_content(path)
