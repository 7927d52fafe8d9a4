"""Shapefiles (.shp): polygons or lines, with pyshp; the .prj file beside says what the coordinates are."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from ...errors import GridgenError, MissingExtraError
from ..content import OutlineContent
from ..format import OutlineFormat, foreign
from ..geometry import outline_of_geometries

_MAGIC = b"\x00\x00\x27\x0a"


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the largest polygon with its holes, or the curve that lines make.

    Raises:
        GridgenError: for a damaged file, or one that has neither.
        MissingExtraError: if pyshp is not installed.
    """
    try:
        import shapefile
    except ImportError:
        raise MissingExtraError("reading a shapefile", "geo", "pyshp") from None
    if not data.startswith(_MAGIC):
        raise GridgenError("it does not begin as a shapefile does; name the .shp file")

    def geometries() -> list[Any]:
        with shapefile.Reader(shp=io.BytesIO(data)) as reader:
            return [shape.__geo_interface__ for shape in reader.iterShapes() if shape.shapeType]

    found: Any = foreign(geometries, "shapefile")
    return outline_of_geometries(found, path, "", _is_geographic(path.with_suffix(".prj")))


def _is_geographic(beside: Path) -> bool | None:
    """Return what the file of the projection says, if it is there."""
    try:
        with beside.open(encoding="latin-1") as stream:
            start = stream.read(100).lstrip().upper()
    except OSError:
        return None
    return True if start.startswith(("GEOGCS", "GEOGCRS")) else False if start.startswith("PROJC") else None


def recognizes(data: bytes) -> bool:
    """Return whether bytes begin as a shapefile does."""
    return data.startswith(_MAGIC)


FORMAT = OutlineFormat(
    "shapefile",
    (".shp",),
    decode,
    "the largest polygon, with its holes as islands, or lines that close; the `.prj` file beside says whether they are "
    "longitude and latitude",
    package="pyshp",
    recognizes=recognizes,
    test="tests/outlines/test_maps.py::test_shapefiles",
)
