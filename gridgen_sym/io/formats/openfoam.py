"""Meshes of OpenFOAM (the folder polyMesh): one layer of cells, whose front and back are a patch of the type `empty`.

Source: https://doc.cfd.direct/openfoam/user-guide/mesh-description
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from ...errors import GridgenError, quoted
from ..boundary_kinds import Kind, kind_of
from ..format import Blocks, Format, Storage
from ..polyhedra import Layer, layer_of
from ..unstructured import Indices, Mesh, Patch, lines_of, mesh_of

#: The patch of the faces in front and at the back.
_EMPTY = "frontAndBack"
_WORD = re.compile(r"(?![0-9+.-])[^\s\"'/;{}()\[\]$#]+")
_TYPES = {Kind.WALL: "wall"}


def encode(blocks: Blocks) -> dict[str, bytes | Iterator[bytes]]:
    """Return the files of the folder.

    Raises:
        GridgenError: for names of boundaries that are no words of OpenFOAM, or the name of the empty patch.
    """
    mesh = mesh_of(blocks)
    for patch in mesh.patches:
        if not _WORD.fullmatch(patch.name) or not patch.name.isprintable() or patch.name == _EMPTY:
            raise GridgenError(
                f"OpenFOAM cannot hold the boundary name {quoted(patch.name)}: take one that does not begin as "
                f"a number, without blanks, quotation marks, slashes, semicolons, brackets, $ and #, and not {_EMPTY}"
            )
    layer = layer_of(mesh)
    faces = sum(map(len, (layer.inner, *layer.outer, layer.back, layer.front)))
    note = f"nPoints: {len(layer.points)} nCells: {len(mesh.cells)} nFaces: {faces} nInternalFaces: {len(layer.inner)}"
    return {
        "points": _points(layer),
        "faces": _faces(layer, faces),
        "owner": _labels("owner", note, layer.owners),
        "neighbour": _labels("neighbour", note, layer.neighbors),
        "boundary": _boundary(mesh, layer),
    }


def _head(kind: str, name: str, note: str = "") -> bytes:
    said = f'    note        "{note}";\n' if note else ""
    return (
        f"FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {kind};\n{said}"
        f'    location    "constant/polyMesh";\n    object      {name};\n}}\n\n'
    ).encode("ascii")


def _points(layer: Layer) -> Iterator[bytes]:
    yield _head("vectorField", "points") + f"{len(layer.points)}\n(\n".encode("ascii")
    yield from lines_of("(%.17g %.17g %.17g)\n", layer.points)
    yield b")\n"


def _faces(layer: Layer, count: int) -> Iterator[bytes]:
    yield _head("faceList", "faces") + f"{count}\n(\n".encode("ascii")
    for faces in (layer.inner, *layer.outer, layer.back, layer.front):
        yield from lines_of("4(%d %d %d %d)\n", faces)
    yield b")\n"


def _labels(name: str, note: str, parts: Sequence[Indices]) -> Iterator[bytes]:
    yield _head("labelList", name, note) + f"{sum(map(len, parts))}\n(\n".encode("ascii")
    for part in parts:
        yield from lines_of("%d\n", part)
    yield b")\n"


def _boundary(mesh: Mesh, layer: Layer) -> bytes:
    lines, start = [], len(layer.inner)
    for patch, faces in zip(mesh.patches, layer.outer, strict=True):
        lines += _patch(patch.name, _TYPES.get(kind_of(patch.name), "patch"), len(faces), start, _partner(patch))
        start += len(faces)
    lines += _patch(_EMPTY, "empty", len(layer.back) + len(layer.front), start, [])
    text = "\n".join([str(len(mesh.patches) + 1), "(", *lines, ")", ""])
    return _head("polyBoundaryMesh", "boundary") + text.encode("utf-8")


def _patch(name: str, kind: str, faces: int, start: int, partner: Sequence[str]) -> list[str]:
    entries = [f"type            {'cyclic' if partner else kind};", f"nFaces          {faces};", *partner]
    entries.append(f"startFace       {start};")
    return [f"    {name}", "    {", *(f"        {entry}" for entry in entries), "    }"]


def _partner(patch: Patch) -> list[str]:
    """Return the entries of a patch that is connected to another one by a rotation or a translation."""
    if patch.bond is None:
        return []
    motion = patch.bond.motion
    entries = [f"neighbourPatch  {patch.partner};", "matchTolerance  0.0001;"]
    if motion.angle:
        # A rotation and a shift are a rotation about a point that stays where it is.
        x, y = np.linalg.solve(np.eye(2) - motion.matrix, motion.shift).tolist()
        return [
            *entries,
            "transform       rotational;",
            "rotationAxis    (0 0 1);",
            f"rotationCentre  ({x:.17g} {y:.17g} 0);",
        ]
    sign = -1 if patch.shadow else 1
    x, y = (sign * value for value in motion.shift)
    return [*entries, "transform       translational;", f"separationVector ({x:.17g} {y:.17g} 0);"]


FORMAT = Format(
    name="OpenFOAM mesh",
    suffixes=(".polymesh",),
    decode=None,
    encode=encode,
    several=True,
    names=True,
    storage=Storage.FOLDER,
    writes="the folder `constant/polyMesh`, text, 17 digits: one layer of cells between `empty` faces; a patch for "
    "each boundary, `cyclic` where it is periodic",
    test="tests/io/test_unstructured.py::test_the_folder_of_openfoam",
)
