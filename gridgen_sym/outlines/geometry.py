"""Geometries as GeoJSON writes them, which readers of other formats return, too, as outlines with islands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from .content import OutlineContent
from .loops import joined, outline_of_loops, outline_of_polygons

#: Collections may hold collections; deeper ones are no map.
_DEEPEST = 20


def outline_of_geometries(
    geometries: list[Mapping[str, Any]], path: Path, name: str = "", geographic: bool | None = None
) -> OutlineContent:
    """Return the outline of the polygons of geometries, or, where they have none, of their joined lines.

    Raises:
        GridgenError: for other geometries, or coordinates that are no pairs of numbers.
    """
    flat = [part for geometry in geometries for part in _parts(geometry, 0)]
    polygons = [part for kind, part in flat if kind == "Polygon"]
    if polygons:
        return outline_of_polygons([[_curve(ring) for ring in polygon] for polygon in polygons], path, name, geographic)
    lines = [_curve(line) for kind, line in flat if kind == "LineString"]
    if not lines:
        raise GridgenError("it has no polygon and no line; expected a Polygon, or lines that close")
    return outline_of_loops(joined(lines), path, name, geographic)


def _parts(geometry: object, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield the coordinates of all polygons and lines of a geometry, with their type; points are left out."""
    if not isinstance(geometry, Mapping) or depth > _DEEPEST:
        raise GridgenError(f"a geometry must be an object with a type and coordinates; came {quoted(geometry, 60)}")
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind == "GeometryCollection":
        for one in _listed(geometry.get("geometries")):
            yield from _parts(one, depth + 1)
    elif kind in ("MultiPolygon", "MultiLineString"):
        for part in _listed(coordinates):
            yield str(kind).removeprefix("Multi"), _listed(part)
    elif kind in ("Polygon", "LineString"):
        yield str(kind), _listed(coordinates)
    elif kind == "LinearRing":
        yield "LineString", _listed(coordinates)
    elif kind not in ("Point", "MultiPoint"):
        raise GridgenError(f"the type of a geometry is {quoted(kind, 60)}; expected Polygon or MultiPolygon")


def _listed(value: object) -> list[Any]:
    if not isinstance(value, (list, tuple)):
        raise GridgenError(f"coordinates must be lists of numbers; came {quoted(value, 60)}")
    return list(value)


def _curve(places: object) -> Array:
    """Return the vertices (n, 2) of a curve; heights, and points that repeat the one before, are left out."""
    try:
        points = np.array([(float(place[0]), float(place[1])) for place in _listed(places)])
    except (TypeError, ValueError, OverflowError, IndexError, KeyError) as error:
        raise GridgenError(f"coordinates must be pairs of numbers, but in {quoted(places, 60)} are others") from error
    points = points.reshape(-1, 2)
    repeated = np.zeros(len(points), dtype=bool)
    repeated[1:] = (points[1:] == points[:-1]).all(axis=1)
    return points[~repeated]
