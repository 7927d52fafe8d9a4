"""GeoJSON (RFC 7946): longitude and latitude, polygons with holes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import GridgenError, quoted, shortened
from ..content import OutlineContent
from ..format import OutlineFormat
from ..geometry import outline_of_geometries

_EXPECTED = "expected a FeatureCollection, a Feature or a geometry of GeoJSON"


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the largest polygon with its holes, or the curve that lines make.

    The properties `name` and `corners`, four indices of points, of the only feature with a polygon are taken, too.

    Raises:
        GridgenError: for what is no GeoJSON, or has neither.
    """
    try:
        top = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise GridgenError(f"it is no JSON ({shortened(error)}); {_EXPECTED}") from error
    if not isinstance(top, Mapping):
        raise GridgenError(f"it holds {quoted(top, 60)}; {_EXPECTED}")
    features = _features(top)
    geometries = [geometry for geometry, _ in features if geometry is not None]
    named = features[0][1] if len(features) == 1 else {}
    found = outline_of_geometries(geometries, path, str(named.get("name") or ""), _is_geographic(top))
    corners = named.get("corners")
    if corners is None:
        return found
    if not isinstance(corners, list) or not all(isinstance(one, int) for one in corners):
        raise GridgenError(f"its property corners is {quoted(corners, 60)}; expected four whole numbers")
    return OutlineContent(found.points, found.name, corners, found.islands, found.geographic)


def _features(top: Mapping[str, Any]) -> list[tuple[Any, Mapping[str, Any]]]:
    """Return geometry and properties of each feature."""
    if top.get("type") == "FeatureCollection":
        features = top.get("features")
        if not isinstance(features, list) or not all(isinstance(one, Mapping) for one in features):
            raise GridgenError(f"its features are {quoted(features, 60)}; {_EXPECTED}")
    else:
        features = [top if top.get("type") == "Feature" else {"geometry": top}]
    return [(one.get("geometry"), one.get("properties") or {}) for one in features]


def _is_geographic(top: Mapping[str, Any]) -> bool:
    """Return whether coordinates are longitude and latitude, as they are unless the old member `crs` names others."""
    if "crs" not in top:
        return True
    named = str(top["crs"])
    return any(one in named for one in ("CRS84", "4326", "4269", "4258"))


def recognizes(data: bytes) -> bool:
    """Return whether a text begins as GeoJSON does."""
    return data[:1000].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") and b'"type"' in data


FORMAT = OutlineFormat(
    "GeoJSON file",
    (".geojson", ".json"),
    decode,
    "the largest polygon, with its holes as islands, or lines that close; longitude and latitude; the properties "
    "`name` and `corners`",
    recognizes=recognizes,
    test="tests/outlines/test_maps.py::test_geojson_with_holes_is_an_outline_with_islands",
)
