"""SU2's native meshes (.su2): points, quadrilaterals, and a marker for each named boundary.

Source: https://su2code.github.io/docs_v7/Mesh-File
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..format import Blocks, Format
from ..unstructured import Mesh, check_names, lines_of, mesh_of

#: Numbers that VTK, too, has for a line and a quadrilateral.
_LINE, _QUADRILATERAL = 3, 9


def encode(blocks: Blocks) -> Iterator[bytes]:
    """Return the pieces of a mesh.

    Raises:
        GridgenError: for names of boundaries that no marker can have.
    """
    mesh = mesh_of(blocks)
    # Configuration files list markers in parentheses, between commas.
    check_names(mesh, "an SU2 file", " ,()%=")
    return _pieces(mesh)


def _pieces(mesh: Mesh) -> Iterator[bytes]:
    yield f"NDIME= 2\nNELEM= {len(mesh.cells)}\n".encode("ascii")
    yield from lines_of(f"{_QUADRILATERAL} %d %d %d %d %d\n", mesh.cells, np.arange(len(mesh.cells)))
    yield f"NPOIN= {len(mesh.points)}\n".encode("ascii")
    yield from lines_of("%.17g %.17g\n", mesh.points)
    yield f"NMARK= {len(mesh.patches)}\n".encode("ascii")
    for patch in mesh.patches:
        yield f"MARKER_TAG= {patch.name}\nMARKER_ELEMS= {len(patch.edges)}\n".encode()
        yield from lines_of(f"{_LINE} %d %d\n", patch.edges)


FORMAT = Format(
    name="SU2 mesh",
    suffixes=(".su2",),
    decode=None,
    encode=encode,
    several=True,
    names=True,
    writes="one list of nodes and quadrilaterals, text, 17 digits; a marker for each boundary",
    test="tests/io/test_unstructured.py::test_a_mesh_of_su2",
)
