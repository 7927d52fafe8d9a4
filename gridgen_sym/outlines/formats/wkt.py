"""Well-known text (WKT): POLYGON ((x y, ...), (hole)), with shapely."""

from __future__ import annotations

from pathlib import Path

from ...errors import MissingExtraError
from ..content import OutlineContent
from ..format import OutlineFormat, foreign
from ..geometry import outline_of_geometries

_WORDS = ("POLYGON", "MULTIPOLYGON", "LINESTRING", "MULTILINESTRING", "GEOMETRYCOLLECTION", "LINEARRING", "SRID=")


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the largest polygon of a geometry with its holes, or the curve that lines make.

    Raises:
        GridgenError: for what is no geometry, or has neither.
        MissingExtraError: if shapely is not installed.
    """
    try:
        import shapely
    except ImportError:
        raise MissingExtraError("reading WKT", "geo", "shapely") from None
    text = data.decode("utf-8-sig", errors="replace").strip()
    number = None
    if text[:5].upper() == "SRID=":  # PostGIS writes the system of the coordinates in front.
        number, _, text = text[5:].partition(";")
    geometry = foreign(lambda: shapely.from_wkt(text).__geo_interface__, "geometry in WKT")
    return outline_of_geometries([geometry], path, "", True if number == "4326" else None)  # type: ignore[list-item]


def recognizes(data: bytes) -> bool:
    """Return whether a text begins with the name of a geometry."""
    return data[:100].decode("latin-1").lstrip("\ufeffï»¿ \t\r\n").upper().startswith(_WORDS)


FORMAT = OutlineFormat(
    "geometry in WKT",
    (".wkt",),
    decode,
    "one geometry: the largest polygon, with its holes as islands, or lines that close",
    package="shapely",
    recognizes=recognizes,
    test="tests/outlines/test_maps.py::test_wkt",
)
