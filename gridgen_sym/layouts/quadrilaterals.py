"""A mesh of quadrilaterals as a layout: one block for each, with any number of cells."""

from __future__ import annotations

import numpy as np

from ..errors import GridgenError
from ..grids import Grid
from ..topology import Connection, MultiBlock
from ..topology.connection import PartLike
from .lagrange import interpolation
from .mesh import QuadrilateralMesh

#: The sides of a block between the vertices of a quadrilateral, counter-clockwise.
_SIDES = ("bottom", "right", "top", "left")


def layout_of_mesh(mesh: QuadrilateralMesh, refine: int) -> MultiBlock:
    """Return a layout with a block of refine x refine cells for every quadrilateral.

    Nodes are the places of the map of each at equal steps. Edges of two quadrilaterals are connections; the others have
    the names of their attributes, where they have any, or else the numbers of these.

    Raises:
        GridgenError: for an edge of more than two quadrilaterals.
    """
    weights = interpolation(mesh.places, np.linspace(0, 1, refine + 1))
    nodes = np.einsum("ai,bj,nijc->nabc", weights, weights, mesh.nodes)
    sides: dict[frozenset[int], list[PartLike]] = {}
    for block, corners in enumerate(mesh.corners.tolist()):
        for k, side in enumerate(_SIDES):
            sides.setdefault(frozenset((corners[k], corners[(k + 1) % 4])), []).append((str(block), side))
    for ends, parts in sides.items():
        if len(parts) > 2:
            told = ", ".join(f"{part[1]} of {part[0]}" for part in parts)
            raise GridgenError(f"the edge between the vertices {sorted(ends)} belongs to {len(parts)} elements: {told}")
    boundaries: dict[str, list[PartLike]] = {}
    for one, other, attribute in mesh.boundary.tolist():
        parts = sides.get(frozenset((one, other)), [])
        if len(parts) == 1:  # Attributes of edges within the mesh name no boundary.
            boundaries.setdefault(mesh.names.get(attribute, str(attribute)), []).extend(parts)
    return MultiBlock(
        {str(block): Grid(one) for block, one in enumerate(nodes)},
        [Connection(*parts) for parts in sides.values() if len(parts) == 2],
        boundaries=boundaries,
    )
