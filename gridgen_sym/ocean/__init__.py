"""Grids of ocean models: staggered points, metric, masks, and the names that ROMS, SGRID and UGRID give them."""

from .grid import OceanGrid as OceanGrid
from .grid import ocean_grid as ocean_grid
