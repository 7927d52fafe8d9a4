"""Drawings in DXF, with ezdxf: lines, polylines, arcs, circles, ellipses and splines."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array
from ...errors import GridgenError, MissingExtraError
from ..content import OutlineContent
from ..format import OutlineFormat, foreign
from ..loops import joined, outline_of_loops

_KINDS = "LINE LWPOLYLINE POLYLINE ARC CIRCLE ELLIPSE SPLINE HATCH"
#: Chords leave curves by at most this part of the drawing's extent.
_SAGITTA = 1e-4


def decode(data: bytes, path: Path) -> OutlineContent:
    """Return the closed curve with the largest area that the drawing's curves make, and those inside it as islands.

    Raises:
        GridgenError: for a damaged file, or curves that do not close.
        MissingExtraError: if ezdxf is not installed.
    """
    try:
        from ezdxf import path as paths
        from ezdxf import recover
    except ImportError:
        raise MissingExtraError("reading a DXF file", "geo", "ezdxf") from None

    def curves() -> list[Array]:
        drawing, _ = recover.read(io.BytesIO(data))
        made: list[Any] = [paths.make_path(entity) for entity in drawing.modelspace().query(_KINDS)]
        made = [one for way in made for one in (way.sub_paths() if way.has_sub_paths else [way]) if len(one)]
        ends = np.array([(place.x, place.y) for way in made for place in way.control_vertices()]).reshape(-1, 2)
        reach = _SAGITTA * float(np.ptp(ends, axis=0).max()) if len(ends) else 0.0
        if made and not (np.isfinite(reach) and reach > 0):
            raise GridgenError("its curves have no extent, or are not finite")
        return [np.array([(place.x, place.y) for place in way.flattening(reach)]) for way in made]

    found: Any = foreign(curves, "DXF file")
    if not found:
        raise GridgenError(f"its model space has none of {_KINDS.replace(' ', ', ')}; blocks are not looked into")
    return outline_of_loops(joined(found), path)


def recognizes(data: bytes) -> bool:
    """Return whether bytes begin with a section of a drawing."""
    return data.startswith(b"AutoCAD Binary DXF") or data[:100].split()[:2] == [b"0", b"SECTION"]


FORMAT = OutlineFormat(
    "DXF drawing",
    (".dxf",),
    decode,
    "lines, polylines, arcs, circles, ellipses and splines of the model space, joined at their ends; closed curves "
    "inside the largest one are islands",
    package="ezdxf",
    recognizes=recognizes,
    test="tests/outlines/test_drawings.py::test_dxf_curves_are_joined_and_a_circle_inside_is_an_island",
)
