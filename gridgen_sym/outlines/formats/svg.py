"""Drawings in SVG, with svgelements: paths and shapes, whose y runs downwards and is turned."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ...arrays import Array
from ...errors import GridgenError, MissingExtraError, shortened
from ..content import OutlineContent
from ..format import OutlineFormat, foreign
from ..loops import joined, outline_of_loops

_SHAPES = {
    "path": "Path",
    "rect": "Rect",
    "circle": "Circle",
    "ellipse": "Ellipse",
    "polygon": "Polygon",
    "polyline": "Polyline",
    "line": "SimpleLine",
}
#: What is drawn only where it is used, or not at all.
_HIDDEN = {"defs", "symbol", "clipPath", "mask", "marker", "pattern", "metadata"}
#: Chords for each curved segment.
_CHORDS = 32


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the closed curve with the largest area that paths and shapes make, and those inside it as islands.

    Raises:
        GridgenError: for a damaged file, or curves that do not close.
        MissingExtraError: if svgelements is not installed.
    """
    try:
        import svgelements
    except ImportError:
        raise MissingExtraError("reading an SVG file", "geo", "svgelements") from None
    if b"<!ENTITY" in data or b"\0" in data:  # Entities could expand without bound; UTF-16 would hide them.
        raise GridgenError("it declares entities, or is not UTF-8: save it as plain SVG in UTF-8")
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise GridgenError(f"it is no XML: {shortened(error)}") from error
    curves: Any = foreign(lambda: list(_curves(root, svgelements)), "SVG file")
    if not curves:
        raise GridgenError(f"it draws none of {', '.join(_SHAPES)}; what is only used elsewhere is not looked into")
    return outline_of_loops(joined(curves), path)


def _curves(root: ElementTree.Element, library: Any) -> Iterator[Array]:  # noqa: ANN401
    """Yield the curves (n, 2) of all shapes below an element, with the transformations of what they are in."""
    waiting = [(root, library.Matrix())]
    while waiting:
        element, outer = waiting.pop()
        kind = str(element.tag).rpartition("}")[2]
        if kind in _HIDDEN:
            continue
        matrix = library.Matrix(element.get("transform", "")) * outer
        waiting.extend((child, matrix) for child in reversed(element))
        if kind in _SHAPES:
            attributes = {key: value for key, value in element.attrib.items() if key not in ("transform", "style")}
            text = attributes.pop("d") if kind == "path" and "d" in attributes else None
            made = library.Path(text) if text is not None else getattr(library, _SHAPES[kind])(attributes)
            way = library.Path(made * matrix)
            way.reify()
            for part in way.as_subpaths():
                yield from _flattened(library.Path(part), library)


def _flattened(way: Any, library: Any) -> Iterator[Array]:  # noqa: ANN401
    """Yield the vertices of a path without gaps, with y upwards."""
    places: list[Any] = []
    for segment in way:
        if isinstance(segment, library.Move):
            places = [segment.end]
        elif isinstance(segment, (library.Line, library.Close)):
            places.append(segment.end)
        else:
            places.extend(segment.point(k / _CHORDS) for k in range(1, _CHORDS + 1))
    points = np.array([(place.x, -place.y) for place in places if place is not None], dtype=float).reshape(-1, 2)
    if len(points) > 1:
        different = np.concatenate(([True], (np.diff(points, axis=0) != 0).any(axis=1)))
        yield points[different]


def recognizes(data: bytes) -> bool:
    """Return whether an XML text has an element svg near its beginning."""
    return data[:1000].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<") and b"<svg" in data[:5000]


FORMAT = OutlineFormat(
    "SVG drawing",
    (".svg",),
    decode,
    "paths and shapes, joined at their ends, 32 chords for each curved segment; y is turned upwards; closed curves "
    "inside the largest one are islands",
    package="svgelements",
    recognizes=recognizes,
    test="tests/outlines/test_drawings.py::test_svg_shapes_are_curves_with_y_upwards",
)
