"""Meshes of Gmsh (.msh), version 4.1, text: a physical group for each block and each named boundary.

Source: https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...errors import GridgenError, quoted
from ..block_names import check_block_names
from ..format import Blocks, Format
from ..unstructured import Indices, Mesh, check_names, lines_of, mesh_of

_LONGEST_NAME = 127  # Of a physical group, in bytes.
#: Types of elements.
_LINE, _QUADRILATERAL = 1, 3
_NODE = "%.17g %.17g 0\n"


def encode(blocks: Blocks) -> Iterator[bytes]:
    """Return the pieces of a mesh: curve k and its physical group are the k-th boundary, surface k is the k-th block.

    Raises:
        GridgenError: for names of blocks and boundaries that no physical group can have.
    """
    mesh = mesh_of(blocks)
    check_names(mesh, "a Gmsh file", '"')
    check_block_names(mesh.names, "a Gmsh file")
    for name in (*mesh.names, *(patch.name for patch in mesh.patches)):
        if len(name.encode("utf-8")) > _LONGEST_NAME:
            raise GridgenError(f"a Gmsh file cannot hold the name {quoted(name)}: take one of {_LONGEST_NAME} bytes")
    return _pieces(mesh)


def _pieces(mesh: Mesh) -> Iterator[bytes]:
    groups = [(1, k, patch.name) for k, patch in enumerate(mesh.patches, start=1)]
    groups += [(2, k, name.replace('"', "'")) for k, name in enumerate(mesh.names, start=1)]
    names = "".join(f'{dimension} {tag} "{name}"\n' for dimension, tag, name in groups)
    yield b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    yield f"$PhysicalNames\n{len(groups)}\n{names}$EndPhysicalNames\n".encode()
    yield _entities(mesh)
    yield from _nodes(mesh)
    yield from _elements(mesh)


def _entities(mesh: Mesh) -> bytes:
    """Return the section of curves and surfaces, each with its box and its physical group."""
    lines = [f"0 {len(mesh.patches)} {len(mesh.names)} 0"]
    parts = [np.unique(patch.edges) for patch in mesh.patches]
    parts += [np.unique(mesh.cells[a:b]) for a, b in zip(mesh.starts[:-1], mesh.starts[1:], strict=True)]
    tags = [*range(1, 1 + len(mesh.patches)), *range(1, 1 + len(mesh.names))]
    for tag, nodes in zip(tags, parts, strict=True):
        (x0, y0), (x1, y1) = mesh.points[nodes].min(axis=0).tolist(), mesh.points[nodes].max(axis=0).tolist()
        lines.append(f"{tag} {x0:.17g} {y0:.17g} 0 {x1:.17g} {y1:.17g} 0 1 {tag} 0")
    return "\n".join(["$Entities", *lines, "$EndEntities", ""]).encode("ascii")


def _owners(mesh: Mesh) -> Iterator[tuple[int, int, Indices]]:
    """Yield (dimension, tag, nodes): every node belongs to the first curve that it lies on, or to a surface."""
    free = np.ones(len(mesh.points), dtype=bool)
    entities = [(1, k, patch.edges) for k, patch in enumerate(mesh.patches, start=1)]
    spans = zip(mesh.starts[:-1], mesh.starts[1:], strict=True)
    entities += [(2, k, mesh.cells[a:b]) for k, (a, b) in enumerate(spans, start=1)]
    for dimension, tag, corners in entities:
        nodes = np.unique(corners)
        nodes = nodes[free[nodes]]
        free[nodes] = False
        if len(nodes):
            yield dimension, tag, nodes


def _nodes(mesh: Mesh) -> Iterator[bytes]:
    owned = list(_owners(mesh))
    count = len(mesh.points)
    yield f"$Nodes\n{len(owned)} {count} 1 {count}\n".encode("ascii")
    for dimension, tag, nodes in owned:
        yield f"{dimension} {tag} 0 {len(nodes)}\n".encode("ascii")
        yield from lines_of("%d\n", nodes, add=1)
        yield from lines_of(_NODE, mesh.points[nodes])
    yield b"$EndNodes\n"


def _elements(mesh: Mesh) -> Iterator[bytes]:
    edges = sum(len(patch.edges) for patch in mesh.patches)
    count = edges + len(mesh.cells)
    yield f"$Elements\n{len(mesh.patches) + len(mesh.names)} {count} 1 {count}\n".encode("ascii")
    first = 1
    for tag, patch in enumerate(mesh.patches, start=1):
        yield f"1 {tag} {_LINE} {len(patch.edges)}\n".encode("ascii")
        yield from lines_of("%d %d %d\n", patch.edges, first=first, add=1)
        first += len(patch.edges)
    for tag, (begin, end) in enumerate(zip(mesh.starts[:-1], mesh.starts[1:], strict=True), start=1):
        yield f"2 {tag} {_QUADRILATERAL} {end - begin}\n".encode("ascii")
        yield from lines_of("%d %d %d %d %d\n", mesh.cells[begin:end], first=first, add=1)
        first += end - begin
    yield b"$EndElements\n"


FORMAT = Format(
    name="Gmsh mesh",
    suffixes=(".msh",),
    decode=None,
    encode=encode,
    several=True,
    names=True,
    writes="version 4.1, text, 17 digits: one list of nodes and quadrilaterals; groups of blocks and of boundaries",
    test="tests/io/test_unstructured.py::test_gmsh_reads_what_is_written",
)
