"""MFEM's meshes (.mesh), version 1.3: vertices, quadrilaterals, and boundary edges whose attributes have names.

Source: https://mfem.org/mesh-formats
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..block_names import check_block_names
from ..format import Blocks, Format
from ..unstructured import Mesh, check_names, lines_of, mesh_of

#: Numbers of geometries.
_SEGMENT, _SQUARE = 1, 3


def encode(blocks: Blocks) -> Iterator[bytes]:
    """Return the pieces of a mesh: attribute k is the k-th block, or boundary.

    Raises:
        GridgenError: for names of blocks and boundaries that no attribute set can have.
    """
    mesh = mesh_of(blocks)
    check_names(mesh, "an MFEM mesh", '"')
    check_block_names(mesh.names, "an MFEM mesh")
    return _pieces(mesh)


def _pieces(mesh: Mesh) -> Iterator[bytes]:
    yield f"MFEM mesh v1.3\n\ndimension\n2\n\nelements\n{len(mesh.cells)}\n".encode("ascii")
    attributes = np.repeat(np.arange(1, len(mesh.starts)), np.diff(mesh.starts))
    yield from lines_of(f"%d {_SQUARE} %d %d %d %d\n", attributes, mesh.cells)
    yield _sets("attribute_sets", [name.replace('"', "'") for name in mesh.names])
    yield f"\nboundary\n{sum(len(patch.edges) for patch in mesh.patches)}\n".encode("ascii")
    for attribute, patch in enumerate(mesh.patches, start=1):
        yield from lines_of(f"{attribute} {_SEGMENT} %d %d\n", patch.edges)
    yield _sets("bdr_attribute_sets", [patch.name for patch in mesh.patches])
    yield f"\nvertices\n{len(mesh.points)}\n2\n".encode("ascii")
    yield from lines_of("%.17g %.17g\n", mesh.points)
    yield b"\nmfem_mesh_end\n"


def _sets(title: str, names: Sequence[str]) -> bytes:
    """Return a section that gives each attribute a name."""
    lines = [f'"{name}" 1 {attribute}' for attribute, name in enumerate(names, start=1)]
    return "\n".join(["", title, str(len(names)), *lines, ""]).encode("utf-8")


FORMAT = Format(
    name="MFEM mesh",
    suffixes=(".mesh",),
    decode=None,
    encode=encode,
    several=True,
    names=True,
    writes="one list of nodes and quadrilaterals, text, 17 digits; named attributes of blocks and boundaries (v1.3)",
    test="tests/io/test_unstructured.py::test_a_mesh_of_mfem",
)
