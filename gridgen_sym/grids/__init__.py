"""Grids on the ground: a block of nodes, its quality, and transfinite interpolation."""

from .change import Change as Change
from .change import Measures as Measures
from .grid import Grid as Grid
from .grid import boundary_indices as boundary_indices
from .grid import corner_jacobians as corner_jacobians
from .grid import folded_corners as folded_corners
from .orthogonality import Deviation as Deviation
from .orthogonality import SideQuality as SideQuality
from .quality import Quality as Quality
from .quality import quality as quality
from .transfinite import transfinite as transfinite
