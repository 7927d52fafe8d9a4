"""Quadrilaterals with a polynomial map each: what meshes of all programs become."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from ..arrays import Array


@dataclass(frozen=True, slots=True)
class QuadrilateralMesh:
    """Quadrilaterals with a polynomial map each.

    Attributes:
        corners: the vertices of each, counter-clockwise; (n, 4).
        nodes: of each map, (n, p + 1, p + 1, 2): along the edge from its first to its second vertex, and across.
        places: of the nodes in [0, 1]; (p + 1,).
        boundary: the two vertices of each edge of the boundary, and its attribute; (m, 3).
        names: of attributes that have one; others have their number as a name.
    """

    corners: npt.NDArray[np.intp]
    nodes: Array
    places: Array
    boundary: npt.NDArray[np.intp]
    names: Mapping[int, str] = field(default_factory=dict)
