"""The cells that walls ask for."""

from __future__ import annotations

import gridgen_sym as gg
from gridgen_sym.boundary.sides import Sides
from gridgen_sym.boundary.wall import walls_by_side
from gridgen_sym.fields.wall_cells import corrected_beside


def test_heights_stay_corrected_where_boundary_nodes_stay():
    asked = walls_by_side({"bottom": gg.Wall(0.01), "top": gg.Wall(0.02)})
    walls = walls_by_side({"bottom": gg.Wall(0.011), "top": gg.Wall(0.021)})
    assert corrected_beside(walls, asked, {"top"}) == Sides(walls.bottom, None, asked.top, None)
    assert corrected_beside(walls, asked, {"left"}) == asked
    assert corrected_beside(walls, asked, set()) == walls
